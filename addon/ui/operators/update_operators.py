"""The operator that brings materials to this version of the extension."""

import bpy

from ...nodes.compatibility import UnsupportedError
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


CLASSES = (UpdateMaterials,)
