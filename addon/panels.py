"""Panels: a scene's media in winning order, and what keeps them from rendering."""

from __future__ import annotations

import textwrap

import bpy

from .compatibility import blender_problem, settings_problem
from .materials import dielectric_node, medium_material
from .media import get_priority, media, own_priority, winning_order
from .operators import AssignPreset, Prepare, PriorityMove, PriorityOwn
from .parameters import PRIORITY_PROPERTY


class MediaList(bpy.types.UIList):
    """The scene's media, the one that wins over all others on top."""

    bl_idname = "NESTED_DIELECTRIC_UL_media"

    def filter_items(self, context: bpy.types.Context, data: bpy.types.Scene, property: str) -> tuple[list, list]:
        objects = list(getattr(data, property))
        ordered = winning_order(objects)
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
        value.label(text=f"{text} {get_priority(obj)}", icon="MATERIAL")
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
    if problem:
        lines = layout.column(align=True)
        lines.alert = True
        characters = int(context.region.width / context.preferences.system.ui_scale / 8.0)
        for index, line in enumerate(textwrap.wrap(problem[0].upper() + problem[1:], max(characters, 20))):
            lines.label(text=line, icon="BLANK1" if index else "ERROR")
    layout.operator(Prepare.bl_idname, icon="CHECKMARK")


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

    objects = set(scene.objects)
    instanced = [obj for obj in media(scene) if obj not in objects]
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
        column.prop(dielectric_node(material).inputs["Priority"], "default_value", text="Priority of Material")
        draw_priority(column.row(align=True), obj, text="Priority")
    layout.operator_menu_enum(AssignPreset.bl_idname, "preset", text="Assign Preset", icon="MATERIAL")


class _MediaPanel:
    """What both panels show."""

    bl_label = "Nested Dielectric"

    def draw(self, context: bpy.types.Context) -> None:
        draw(self.layout, context)


class ObjectPanel(_MediaPanel, bpy.types.Panel):
    """Media of the scene, in the Object properties."""

    bl_idname = "NESTED_DIELECTRIC_PT_object"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}


class SidebarPanel(_MediaPanel, bpy.types.Panel):
    """Media of the scene, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Nested Dielectric"


CLASSES = (MediaList, ObjectPanel, SidebarPanel)
