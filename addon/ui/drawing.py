"""What panels share: where they stand, texts in as many lines as they take, alerts, values to read, parameters of a medium."""

from __future__ import annotations

import textwrap

import bpy

from ..model.parameters import BY_KEYWORD
from ..scene.materials import parameter_socket, rendered_node


class ObjectProperties:
    """Where a panel of the Object properties stands."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "object"
    bl_options = {"DEFAULT_CLOSED"}


class Sidebar:
    """Where a panel of the 3D view's sidebar stands."""

    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Nested Dielectric"


def draw_alert(layout: bpy.types.UILayout, context: bpy.types.Context, text: str) -> None:
    """Draw a problem, in red."""
    lines = layout.column()
    lines.alert = True
    draw_text(lines, context, text, "ERROR")


def draw_text(layout: bpy.types.UILayout, context: bpy.types.Context, text: str, icon: str) -> None:
    """Draw a text in as many lines as the region's width makes of it, the first with an icon."""
    lines = layout.column(align=True)
    characters = int(context.region.width / context.preferences.system.ui_scale / 8.0)
    for index, line in enumerate(textwrap.wrap(text[0].upper() + text[1:], max(characters, 20))):
        lines.label(text=line, icon="BLANK1" if index else icon)


def draw_value(layout: bpy.types.UILayout, name: str, value: str, factor: float = 0.4) -> None:
    """Draw a name and a value to read, placed as a property's; the name takes that part of the width."""
    columns = layout.split(factor=factor)
    label = columns.row()
    label.alignment = "RIGHT"
    label.label(text=name)
    columns.label(text=value)


def draw_parameter(
    layout: bpy.types.UILayout, material: bpy.types.Material, keyword: str, has_effect: bool = True
) -> None:
    """Draw a parameter of a medium to edit, greyed out where it does not show in the picture, or what is plugged into it.

    Names stand within the fields or above them: beside them they would be cut at the default width of Blender's regions.
    """
    parameter = BY_KEYWORD[keyword]
    label = parameter.label or parameter.name
    field = layout.column(align=True) if parameter.kind in ("MENU", "VECTOR") else layout.row()
    field.active = has_effect
    socket = parameter_socket(material, parameter.name)
    if socket is None or socket.hide_value:
        links = rendered_node(material).inputs[parameter.name].links
        draw_value(field, label, links[0].from_node.name if links else "Nothing")
    elif parameter.kind == "MENU":
        field.label(text=label)
        field.prop(socket, "default_value", text="")
    else:
        field.prop(socket, "default_value", text=label, slider=parameter.unit == "FACTOR")
