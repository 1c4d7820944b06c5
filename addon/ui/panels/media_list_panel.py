"""The list of a scene's media in winning order, with the buttons that choose and move them."""

from __future__ import annotations

import bpy

from ...model.parameter import GROUP_NAME, PRIORITY_PROPERTY
from ...nodes.places import is_plugged
from ...scene.materials import parameter_socket
from ...scene.media import get_priority, own_priority
from ...scene.priorities import in_words
from ..drawing import draw_text
from ..media_list import Line, is_open, listed_lines, listed_media
from ..media_rows import active_line, make_places
from ..operators.priority_operators import OpenMaterial, PriorityMove, PriorityOwn, SelectObjects, SpaceOut
from ..operators.suggestion_operators import SuggestPriorities

NAME_WIDTH = 0.68
"""Part of a row that a name takes; the rest holds a priority of four digits at the default width of the sidebar."""


class MediaList(bpy.types.UIList):
    """The scene's media, the one that wins over all others on top."""

    bl_idname = "NESTED_DIELECTRIC_UL_media"

    def filter_items(self, context: bpy.types.Context, data: bpy.types.WindowManager, property: str) -> tuple:
        lines = listed_lines(context.scene).lines
        text = self.filter_name.lower()
        flags = [self.bitflag_filter_item if not text or _holds(line, text) else 0 for line in lines]
        places = len(getattr(data, property))
        return (flags + [0] * places)[:places], []

    def draw_filter(self, context: bpy.types.Context, layout: bpy.types.UILayout) -> None:
        layout.prop(self, "filter_name", text="", icon="VIEWZOOM")

    def draw_item(self, context, layout, data, item, icon, active_data, active_property, index) -> None:
        lines = listed_lines(context.scene).lines
        if index >= len(lines):
            return
        line = lines[index]
        if isinstance(line.chosen, bpy.types.Material):
            draw_material(layout, line)
        else:
            draw_object(layout, line, context.scene)


def _holds(line: Line, text: str) -> bool:
    return text in line.chosen.name.lower() or any(text in obj.name.lower() for obj in line.row.objects if not line.obj)


def draw_media(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw the scene's media by material, to choose and to move, and what the active row's priority means."""
    scene = context.scene
    make_places(scene)
    manager = bpy.context.window_manager
    layout.template_list(
        MediaList.bl_idname,
        "",
        manager,
        "nested_dielectric_places",
        scene,
        "nested_dielectric_active",
        rows=4,
        sort_lock=True,
    )
    line = active_line(scene)
    if not listed_media(scene).rows:
        return
    buttons = layout.row(align=True)
    arrows = buttons.row(align=True)
    arrows.enabled = line is not None
    for direction, icon in (("UP", "TRIA_UP"), ("DOWN", "TRIA_DOWN")):
        arrows.operator(PriorityMove.bl_idname, text="", icon=icon).direction = direction
    buttons.operator(SelectObjects.bl_idname)
    buttons.operator(SpaceOut.bl_idname, text="Space Out")
    layout.operator(SuggestPriorities.bl_idname, text="Suggest Priorities...")
    if line is not None:
        draw_text(layout, context, f"{line.row.owner.name} {in_words(listed_media(scene).rows, line.row)}", "INFO")


def draw_material(layout: bpy.types.UILayout, line: Line) -> None:
    """Draw a material: whether its objects are shown, its colour, its name, how many objects it has, and its priority."""
    columns = layout.split(factor=NAME_WIDTH, align=True)
    row = columns.row(align=True)
    material = line.row.owner
    icon = "DISCLOSURE_TRI_DOWN" if is_open(line.row) else "DISCLOSURE_TRI_RIGHT"
    row.operator(OpenMaterial.bl_idname, text="", icon=icon, emboss=False).number = material.session_uid
    swatch = row.row(align=True)
    swatch.ui_units_x = 0.7
    colour = _socket(material, "Transmittance")
    if colour is not None:
        swatch.prop(colour, "default_value", text="")
    else:
        swatch.prop(material, "diffuse_color", text="")
    row.separator(factor=0.4)
    row.label(text=f"{material.name} ({len(line.row.objects)})")
    priority = _socket(material, "Priority")
    if priority is not None:
        columns.prop(priority, "default_value", text="")
    else:
        columns.label(text=str(line.row.priority), icon="NODETREE")


def _socket(material: bpy.types.Material, name: str) -> bpy.types.NodeSocket | None:
    """Return what :func:`parameter_socket` does, in a hundredth of the time where the node is plugged in itself."""
    node = material.node_tree.nodes.get(GROUP_NAME)
    socket = node.inputs.get(name) if node is not None and is_plugged(node) else None
    return socket if socket is not None and not socket.is_linked else parameter_socket(material, name)


def draw_object(layout: bpy.types.UILayout, line: Line, scene: bpy.types.Scene) -> None:
    """Draw an object: its name, and its own priority or the button that gives it one."""
    obj = line.chosen
    is_here = scene.objects.get(obj.name) == obj
    icon = "OBJECT_DATA" if is_here else "OUTLINER_OB_GROUP_INSTANCE"
    columns = layout.split(factor=NAME_WIDTH, align=True) if line.row.is_own else layout.row(align=True)
    names = columns.row(align=True)
    if not line.row.is_own:
        names.label(text="", icon="BLANK1")
    name = names.row(align=True)
    name.active = is_here
    name.prop(obj, "name", text="", emboss=False, icon=icon)
    _draw_pin(names, obj)
    if line.row.is_own:
        columns.prop(obj, f'["{PRIORITY_PROPERTY}"]', text="")


def draw_priority(layout: bpy.types.UILayout, obj: bpy.types.Object, text: str = "") -> None:
    """Draw an object's own priority to edit, or its material's to read, and the button between the two."""
    if own_priority(obj) is not None:
        layout.prop(obj, f'["{PRIORITY_PROPERTY}"]', text=text)
    else:
        value = layout.row(align=True)
        value.active = False
        odd = PRIORITY_PROPERTY in obj
        value.alert = odd
        value.label(text=f"{text} {get_priority(obj)}, its material's", icon="ERROR" if odd else "BLANK1")
    _draw_pin(layout, obj)


def _draw_pin(layout: bpy.types.UILayout, obj: bpy.types.Object) -> None:
    own = own_priority(obj) is not None
    icon = "PINNED" if own else "UNPINNED"
    layout.operator(PriorityOwn.bl_idname, text="", icon=icon, emboss=not own, depress=own).name = obj.name


CLASSES = (MediaList,)
