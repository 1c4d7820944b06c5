"""Panels of a scene: whether it is ready to render, its media in winning order, and what they know of each other."""

from __future__ import annotations

import textwrap

import bpy

from ...analysis.surroundings import last_found
from ...checking.version_checks import version_problems
from ...cutting.cut_scene import last_cut
from ...nodes.compatibility import blender_note, blender_problem
from ...nodes.lookups import caching_nodes
from ...preparation.versions import outdated_materials
from ...scene.materials import medium_material
from ..drawing import ObjectProperties, Sidebar, draw_alert, draw_text
from ..media_list import listed_media
from ..operators.preparation_operators import ClearAnalysis
from ..operators.update_operators import UpdateMaterials
from ..presets.preset_menus import draw_presets
from .media_list_panel import draw_media, draw_priority
from .notices import draw_debug_notice, draw_fault_button, render_problem
from .preparation_panel import draw_preparation
from .rendering_panel import draw_backend, draw_cut


@caching_nodes()
def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw everything that a panel shows, for the Object properties and the 3D view alike."""
    draw_problem(layout, context)
    draw_debug_notice(layout, context)
    draw_preparation(layout, context)
    draw_backend(layout, context)
    draw_cut(layout, context)
    draw_media(layout, context)
    draw_active(layout, context)


def draw_problem(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw why nothing would render as it should; in a scene without media, what they would need."""
    problem = render_problem(context.scene)
    note = blender_note()
    if problem:
        draw_alert(layout, context, problem)
        draw_fault_button(layout)
    elif not listed_media(context.scene).rows:
        wrong = blender_problem()
        text = (
            f"They would not render here: {wrong}"
            if wrong
            else "Select an object and assign a preset; Prepare Scene then sets what they need, such as Cycles and enough "
            "bounces"
        )
        draw_text(layout, context, f"No media yet. {text}", "INFO")
    if note:
        draw_text(layout, context, note, "INFO")
    draw_versions(layout, context)


def draw_versions(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw materials of another version and copies, the button that updates them, and what cannot be updated here."""
    outdated = outdated_materials()
    if outdated:
        text = f"From another version, or a copy: {', '.join(outdated)}"
        draw_text(layout, context, textwrap.shorten(text, 200, placeholder=" ..."), "FILE_REFRESH")
        layout.operator(UpdateMaterials.bl_idname, icon="FILE_REFRESH")
    shown = render_problem(context.scene)
    for problem in version_problems() if listed_media(context.scene).rows else ():
        if str(problem) != shown:
            draw_alert(layout, context, str(problem))


def draw_active(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the active object's material and priority, and the presets to give it another."""
    obj = context.object
    material = medium_material(obj) if obj is not None else None
    if material is not None:
        column = layout.column(align=True)
        column.label(text=f"{obj.name}: {material.name}", icon="MATERIAL")
        draw_priority(column.row(align=True), obj, text="Priority")
    draw_presets(layout)


def draw_analysis(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw which media spare rays, which do not, and why."""
    found = last_found(context.scene)
    if found is None:
        draw_text(
            layout, context, "All media ask the scene what surrounds them; Prepare Scene looks at it beforehand", "INFO"
        )
    else:
        cut = last_cut(context.scene)
        for line in str(found.without(cut.media) if cut else found).splitlines():
            draw_text(layout, context, line, "INFO")
    layout.operator(ClearAnalysis.bl_idname, icon="X")


class _MediaPanel:
    """What both panels show."""

    bl_label = "Nested Dielectric"

    def draw(self, context: bpy.types.Context) -> None:
        draw(self.layout, context)


class ObjectPanel(_MediaPanel, ObjectProperties, bpy.types.Panel):
    """Media of the scene, in the Object properties."""

    bl_idname = "NESTED_DIELECTRIC_PT_object"


class SidebarPanel(_MediaPanel, Sidebar, bpy.types.Panel):
    """Media of the scene, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar"


class SidebarAnalysisPanel(Sidebar, bpy.types.Panel):
    """What the media know of each other, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar_analysis"
    bl_parent_id = SidebarPanel.bl_idname
    bl_label = "Scene Analysis"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        draw_analysis(self.layout, context)


CLASSES = (ObjectPanel, SidebarPanel)

LAST_CLASSES = (SidebarAnalysisPanel,)
"""Panels below those of the active medium."""
