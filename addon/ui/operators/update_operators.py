"""Operators that concern the extension itself: bringing materials to its version, and reporting its errors."""

import bpy

from ...nodes.compatibility import UnsupportedError
from ...nodes.material_version import MATERIAL_VERSION
from ...preparation.guard import faults
from ...preparation.versions import outdated_materials, update_materials
from ..polls import supported


class UpdateMaterials(bpy.types.Operator):
    """Update the materials of other versions."""

    bl_idname = "nested_dielectric.update_materials"
    bl_label = "Update Materials"
    bl_description = (
        "Bring materials that another version of the extension made, and copies that an append made, to this "
        "version. Values, links, drivers and keyframes stay"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not outdated_materials():
            cls.poll_message_set("All materials are of this version")
            return False
        return supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            changes = update_materials()
        except UnsupportedError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for change in changes:
            self.report({"INFO"}, change)
        return {"FINISHED"}


class CopyFaults(bpy.types.Operator):
    """Copy what a report of an error needs."""

    bl_idname = "nested_dielectric.copy_faults"
    bl_label = "Copy Details"
    bl_description = "Copy the details of the error to the clipboard, for a report"
    bl_options = {"INTERNAL"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not faults():
            cls.poll_message_set("There was no error since the file was opened or the scene was prepared")
        return bool(faults())

    def execute(self, context: bpy.types.Context) -> set[str]:
        versions = f"Blender {bpy.app.version_string}, materials of version {MATERIAL_VERSION}"
        context.window_manager.clipboard = "\n\n".join((versions, *(fault.details for fault in faults())))
        self.report({"INFO"}, "The details are in the clipboard")
        return {"FINISHED"}


CLASSES = (UpdateMaterials, CopyFaults)
