"""Panels: a scene's media in winning order, and what keeps them from rendering."""

from __future__ import annotations

import textwrap

import bpy

from .analysis import last_found
from .compatibility import blender_note, blender_problem, settings_problem
from .drawing import draw_alert, draw_text
from .materials import medium_material, parameter_socket
from .media import get_priority, own_priority
from .media_list import listed_media
from .operators import ClearAnalysis, Prepare, PriorityMove, PriorityOwn, UpdateMaterials
from .parameters import PRIORITY_PROPERTY
from .preset_menus import draw_presets
from .versions import outdated_materials, version_problems


class MediaList(bpy.types.UIList):
    """The scene's media, the one that wins over all others on top."""

    bl_idname = "NESTED_DIELECTRIC_UL_media"

    def filter_items(self, context: bpy.types.Context, data: bpy.types.Scene, property: str) -> tuple[list, list]:
        objects = list(getattr(data, property))
        ordered = list(listed_media(data).own)
        found = set(ordered)
        ordered += [obj for obj in objects if obj not in found]
        place = {obj: index for index, obj in enumerate(ordered)}
        shown = bpy.types.UI_UL_list.filter_items_by_name(self.filter_name, self.bitflag_filter_item, objects)
        shown = shown or [self.bitflag_filter_item] * len(objects)
        flags = [flag if obj in found else 0 for flag, obj in zip(shown, objects)]
        return flags, [place[obj] for obj in objects]

    def draw_filter(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "filter_name", text="", icon="VIEWZOOM")

    def draw_item(self, context, layout, data, item, icon, active_data, active_property) -> None:
        draw_medium(layout, item, icon)


def get_active(scene: bpy.types.Scene) -> int:
    """The row of the active object, so that the list follows every selection."""
    active = bpy.context.view_layer.objects.active
    return -1 if active is None else scene.objects.find(active.name)


def set_active(scene: bpy.types.Scene, index: int) -> None:
    """Make the object of a row the active and only selected one; as in the Outliner, no other than in Object Mode."""
    layer = bpy.context.view_layer
    obj = scene.objects[index]
    active = layer.objects.active
    if layer.objects.get(obj.name) != obj or (active is not None and active.mode != "OBJECT"):
        return
    for other in layer.objects.selected:
        other.select_set(False, view_layer=layer)
    obj.select_set(True, view_layer=layer)
    layer.objects.active = obj


def draw_medium(layout: bpy.types.UILayout, obj: bpy.types.Object, icon: int) -> None:
    """One row: the object, its priority and whose priority that is."""
    columns = layout.split(factor=0.55, align=True)
    columns.enabled = obj.is_editable
    columns.prop(obj, "name", text="", emboss=False, icon_value=icon)
    draw_priority(columns.row(align=True), obj)


def draw_priority(layout: bpy.types.UILayout, obj: bpy.types.Object, text: str = "") -> None:
    """An object's own priority to edit, or its material's to read, marked as such, and the button between the two."""
    own = own_priority(obj) is not None
    if own:
        layout.prop(obj, f'["{PRIORITY_PROPERTY}"]', text=text)
    else:
        value = layout.row(align=True)
        value.active = False
        odd = PRIORITY_PROPERTY in obj
        value.alert = odd
        value.label(text=f"{text} {get_priority(obj)}", icon="ERROR" if odd else "MATERIAL")
    toggle = layout.operator(PriorityOwn.bl_idname, text="", icon="PINNED" if own else "UNPINNED", depress=own)
    toggle.name = obj.name


def draw(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Everything a panel shows, for the Object properties and the 3D view alike."""
    draw_problem(layout, context)
    draw_media(layout, context)
    draw_active(layout, context)


def draw_problem(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Why nothing would render as it should, in as many lines as it takes, and the button that mends the scene."""
    problem = blender_problem() or settings_problem(context.scene)
    note = blender_note()
    if problem:
        draw_alert(layout, context, problem)
    elif note:
        draw_text(layout, context, note, "INFO")
    draw_versions(layout, context)
    layout.operator(Prepare.bl_idname, icon="CHECKMARK")


def draw_versions(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Materials of another version and copies, and the button that updates them; what cannot be updated here."""
    outdated = outdated_materials()
    if outdated:
        text = f"From another version, or a copy: {', '.join(outdated)}"
        draw_text(layout, context, textwrap.shorten(text, 200, placeholder=" ..."), "FILE_REFRESH")
        layout.operator(UpdateMaterials.bl_idname, icon="FILE_REFRESH")
    for problem in version_problems():
        draw_alert(layout, context, str(problem))


def draw_media(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The scene's own objects as a list to select and move in, then those that instances bring in."""
    scene = context.scene
    row = layout.row()
    row.template_list(
        MediaList.bl_idname, "", scene, "objects", scene, "nested_dielectric_active", rows=4, sort_lock=True
    )
    buttons = row.column(align=True)
    buttons.enabled = context.object is not None and medium_material(context.object) is not None
    for direction, icon in (("UP", "TRIA_UP"), ("DOWN", "TRIA_DOWN")):
        buttons.operator(PriorityMove.bl_idname, text="", icon=icon).direction = direction

    instanced = listed_media(scene).instanced
    if instanced:
        rows = layout.box().column(align=True)
        rows.label(text="In Instanced Collections", icon="OUTLINER_OB_GROUP_INSTANCE")
        for obj in instanced:
            draw_medium(rows, obj, layout.icon(obj))


def draw_active(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """The active object's material and priority, and the presets to give it another."""
    obj = context.object
    material = medium_material(obj) if obj is not None else None
    if material is not None:
        column = layout.column(align=True)
        column.label(text=f"{obj.name}: {material.name}", icon="MATERIAL")
        socket = parameter_socket(material, "Priority")
        if socket is not None:
            column.prop(socket, "default_value", text="Priority of Material")
        draw_priority(column.row(align=True), obj, text="Priority")
    draw_presets(layout)


def draw_analysis(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Which media spare rays, which do not, and why."""
    found = last_found(context.scene)
    if found is None:
        draw_text(
            layout, context, "All media ask the scene what surrounds them; Prepare Scene looks at it beforehand", "INFO"
        )
    else:
        for line in str(found).splitlines():
            draw_text(layout, context, line, "INFO")
    layout.operator(ClearAnalysis.bl_idname, icon="X")


class _ObjectProperties:
    """Where a panel of the Object properties stands."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}


class _Sidebar:
    """Where a panel of the 3D view's sidebar stands."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Nested Dielectric"


class _MediaPanel:
    """What both panels show."""

    bl_label = "Nested Dielectric"

    def draw(self, context: bpy.types.Context) -> None:
        draw(self.layout, context)


class ObjectPanel(_MediaPanel, _ObjectProperties, bpy.types.Panel):
    """Media of the scene, in the Object properties."""

    bl_idname = "NESTED_DIELECTRIC_PT_object"


class SidebarPanel(_MediaPanel, _Sidebar, bpy.types.Panel):
    """Media of the scene, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar"


class SidebarAnalysisPanel(_Sidebar, bpy.types.Panel):
    """What the media know of each other, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar_analysis"
    bl_parent_id = SidebarPanel.bl_idname
    bl_label = "Scene Analysis"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        draw_analysis(self.layout, context)


CLASSES = (
    MediaList,
    ObjectPanel,
    SidebarPanel,
    SidebarAnalysisPanel,
)
