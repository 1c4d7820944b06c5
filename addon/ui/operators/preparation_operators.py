"""Operators: preparing a scene, and taking that back."""

from __future__ import annotations

import bpy

from ...analysis.surroundings import clear_analysis
from ...analysis.validity import is_analysed
from ...cutting.backends import choose
from ...cutting.baked_cut import delete_bake
from ...cutting.cut_scene import is_cut, is_set_to_cut, set_cut
from ...nodes.compatibility import UnsupportedError
from ...nodes.render_with import BACKENDS, is_native, set_backend
from ...preparation.live import bake_cut, update_cut
from ...preparation.prepare_scene import prepare, put_back
from ...preparation.report import last_report
from ..polls import has_media, supported

MOST_REPORTS = 20
"""Problems that are reported; the panel and Python have all."""


class Prepare(bpy.types.Operator):
    """Prepare the scene."""

    bl_idname = "nested_dielectric.prepare"
    bl_label = "Prepare Scene"
    bl_description = "Set what this scene needs to render nested dielectrics, and look for problems with its media"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            preparation = prepare(context.scene)
        except UnsupportedError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for change in preparation.changes or ("Nothing to change",):
            self.report({"INFO"}, change)
        for line in (
            *str(preparation.chosen).splitlines(),
            *str(preparation.cut).splitlines(),
            *str(preparation.found).splitlines(),
        ):
            self.report({"INFO"}, line)
        for problem in preparation.problems[:MOST_REPORTS]:
            self.report({"WARNING"}, str(problem))
        # Last, because that is what the status bar shows.
        self.report({"WARNING" if preparation.problems else "INFO"}, preparation.headline)
        return {"FINISHED"}


class PutBack(bpy.types.Operator):
    """Put back what preparations have changed."""

    bl_idname = "nested_dielectric.put_back"
    bl_label = "Put Back"
    bl_description = (
        "Take back what Prepare Scene has changed, as far as it still is as it was set: render settings, moved "
        "faces and what media know of each other"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if last_report(context.scene) is None:
            cls.poll_message_set("The scene is not prepared")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        for change in put_back(context.scene) or ("Nothing to put back",):
            self.report({"INFO"}, change)
        return {"FINISHED"}


class CutSurfaces(bpy.types.Operator):
    """Switch the cutting of surfaces on or off."""

    bl_idname = "nested_dielectric.cut_surfaces"
    bl_label = "Cut Surfaces"
    bl_description = (
        "Let renders show the surfaces of media cut where they cross, each face between two known media: as fast "
        "as meshes that are split by hand. Objects, modifiers and the viewport stay as they are; each frame takes "
        "the time to cut it. Again to switch it off"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if is_native(context.scene):
            cls.poll_message_set(
                "Always on where Cycles' own nodes render all media, which cannot ask; see Render With"
            )
            return False
        return supported(cls) and (is_cut(context.scene) or has_media(cls, context))

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene = context.scene
        set_cut(scene, not is_set_to_cut(scene))
        found = update_cut(scene)
        choose(scene)
        if not is_cut(scene):
            self.report({"INFO"}, "Renders show the objects as they are")
            return {"FINISHED"}
        for line in str(found).splitlines() or ["Nothing crosses, so nothing is cut"]:
            self.report({"INFO"}, line)
        return {"FINISHED"}


class RenderWith(bpy.types.Operator):
    """Choose what renders the media of the scene."""

    bl_idname = "nested_dielectric.render_with"
    bl_label = "Render With"
    bl_description = (
        "What renders the media: the shader in Open Shading Language, which does everything and needs the CPU, or "
        "Cycles' own nodes, which are faster and render on every device, and do nearly everything"
    )
    bl_options = {"REGISTER", "UNDO"}

    backend: bpy.props.EnumProperty(
        name="Render With",
        items=[(choice.keyword, choice.name, choice.description) for choice in BACKENDS],
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return supported(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene = context.scene
        set_backend(scene, self.backend)
        update_cut(scene)
        chosen = choose(scene)
        for line in (*str(chosen).splitlines(), chosen.headline or "No media: assign a preset first"):
            self.report({"INFO"}, line)
        return {"FINISHED"}


class KeepCut(bpy.types.Operator):
    """Keep the cut of a frame in the file, or take it out."""

    bl_idname = "nested_dielectric.keep_cut"
    bl_label = "Keep in File"
    bl_description = (
        "Keep the cut of this frame in the file, so that whoever renders this frame has nothing to cut; other "
        "frames are cut as ever. Moving or changing a medium, or this again, takes it back"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not is_cut(context.scene):
            cls.poll_message_set("Switch Cut Surfaces on first")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        scene = context.scene
        if delete_bake(scene):
            self.report({"INFO"}, "Every frame is cut as it is rendered")
            return {"FINISHED"}
        reason = bake_cut(scene)
        if reason:
            self.report({"WARNING"}, f"Every frame is cut as it is rendered: {reason}")
            return {"CANCELLED"}
        self.report({"INFO"}, f"The cut of frame {scene.frame_current} is in the file")
        return {"FINISHED"}


class ClearAnalysis(bpy.types.Operator):
    """Clear the analysis of the scene."""

    bl_idname = "nested_dielectric.clear_analysis"
    bl_label = "Clear Analysis"
    bl_description = "Let all media ask the scene what surrounds them while it renders, until it is prepared again"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not is_analysed(context.scene):
            cls.poll_message_set("The scene has no analysis; Prepare Scene makes one")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        clear_analysis(context.scene)
        update_cut(context.scene)
        choose(context.scene)
        return {"FINISHED"}


CLASSES = (Prepare, PutBack, RenderWith, CutSurfaces, KeepCut, ClearAnalysis)
