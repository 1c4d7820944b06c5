"""Panels of a medium's parameters: what artists change first, and the rest under Advanced.

They stand in the 3D view's sidebar and in the Material properties.
"""

from __future__ import annotations

from typing import Any

import bpy

from ...model.effects import has_effect
from ...model.parameter import BASIC_KEYWORDS, BASICS, LIGHTS_BY_LOBE, SPECTRUM_PANEL
from ...model.parameters import BY_KEYWORD, SOCKETS
from ...nodes.animation import is_animated
from ...preparation.guard import guarded
from ...scene.lights import lobe_lights
from ...scene.materials import get_parameter, half_distance, parameter_socket, rendered_node
from ..active_medium import active_medium
from ..drawing import Sidebar, draw_parameter, draw_text
from ..presets.preset_menus import draw_fit_depth, draw_presets
from .dispersion_panels import draw_dispersion, draw_spectrum

DISPERSION_PANEL = "Dispersion"
LOBES_PANEL = "Direct Light"
HEADINGS = tuple(dict.fromkeys(parameter.panel for parameter in SOCKETS if parameter.panel != BASICS))
"""Of the panels under Advanced."""


def known_values(scene: bpy.types.Scene, material: bpy.types.Material) -> dict[str, Any]:
    """Return what :func:`~nested_dielectric.model.effects.has_effect` goes by.

    That is the values of a medium that are the same on every frame, by keyword, and whether lobes carry lights of the scene.
    """
    node = rendered_node(material)
    needed = {need for parameter in SOCKETS for need in parameter.needs} - {LIGHTS_BY_LOBE}
    sockets = {keyword: parameter_socket(material, BY_KEYWORD[keyword].name) for keyword in needed}
    return {LIGHTS_BY_LOBE: bool(lobe_lights(scene))} | {
        keyword: get_parameter(node, BY_KEYWORD[keyword])
        for keyword, socket in sockets.items()
        if socket is not None and socket.node == node and not is_animated(socket.id_data, socket)
    }


def draw_basics(layout: bpy.types.UILayout, context: bpy.types.Context, material: bpy.types.Material) -> None:
    """Draw the preset, colour, depth, index, roughness and priority of a medium, and what colour and depth come to."""
    values = known_values(context.scene, material)
    draw_presets(layout, material.name)
    column = layout.column()
    for keyword in BASIC_KEYWORDS:
        draw_parameter(column, material, keyword, has_effect(BY_KEYWORD[keyword], values))
    distance = half_distance(rendered_node(material))
    if distance is not None:
        units = context.scene.unit_settings
        length = bpy.utils.units.to_string(units.system, "LENGTH", distance * units.scale_length, precision=3)
        draw_text(layout, context, f"Half of the light is left after {length}", "INFO")
        draw_fit_depth(layout)


def draw_advanced(
    layout: bpy.types.UILayout, context: bpy.types.Context, material: bpy.types.Material, heading: str
) -> None:
    """Draw the parameters of one panel under Advanced."""
    if heading == DISPERSION_PANEL:
        draw_dispersion(layout, context, material)
        return
    if heading == SPECTRUM_PANEL:
        draw_spectrum(layout, material)
        return
    values = known_values(context.scene, material)
    if heading == LOBES_PANEL and not values[LIGHTS_BY_LOBE]:
        draw_text(layout, context, "Rays see all lights of this scene; Lights above lets lobes carry them", "INFO")
    for parameter in SOCKETS:
        if parameter.panel == heading:
            draw_parameter(layout, material, parameter.keyword, has_effect(parameter, values))


class _MaterialProperties:
    """Where a panel of the Material properties stands."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "material"


class _OfMedium:
    """Shown where there is a medium."""

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return active_medium(context) is not None


class _MediumPanel(_OfMedium):
    """What both panels show first."""

    bl_label = "Medium"

    def draw(self, context: bpy.types.Context) -> None:
        draw_basics(self.layout, context, active_medium(context))


class _AdvancedPanel(_OfMedium):
    """The heading of all else."""

    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        pass


class _HeadingPanel(_OfMedium):
    """The parameters of one heading."""

    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        draw_advanced(self.layout, context, active_medium(context), self.bl_label)


@guarded("while a panel was drawn", writes=False)
def draw_in_material_properties(self: bpy.types.Panel, context: bpy.types.Context) -> None:
    """Draw what artists change first, below the material's slots."""
    material = active_medium(context)
    if material is not None:
        draw_basics(self.layout.box(), context, material)


PLACES = tuple(
    (f"{engine}_context_material", draw_in_material_properties) for engine in ("CYCLES_PT", "EEVEE_MATERIAL_PT")
)
"""Blender's panels, and what is added to them."""


def _panel(
    place: type, name: str, kind: type, label: str, parent: type[bpy.types.Panel] | None = None
) -> type[bpy.types.Panel]:
    word = "".join(letter for letter in label.lower() if letter.isalpha())
    fields = {"bl_idname": f"NESTED_DIELECTRIC_PT_{name}_{word}", "bl_label": label, "__doc__": kind.__doc__}
    if parent is not None:
        fields["bl_parent_id"] = parent.bl_idname
    return type(fields["bl_idname"], (kind, place, bpy.types.Panel), fields)


def _headings(place: type, name: str, parent: type[bpy.types.Panel]) -> list[type[bpy.types.Panel]]:
    """Return the panels of all parameters but the first, in one place of Blender's window."""
    found = []
    for heading in HEADINGS:
        found.append(_panel(place, name, _HeadingPanel, heading, parent))
        if heading == DISPERSION_PANEL:
            found.append(_panel(place, name, _HeadingPanel, SPECTRUM_PANEL, found[-1]))
    return found


_MEDIUM = _panel(Sidebar, "sidebar", _MediumPanel, "Medium")
_ADVANCED = _panel(Sidebar, "sidebar", _AdvancedPanel, "Advanced", _MEDIUM)
_REST = _panel(_MaterialProperties, "material", _AdvancedPanel, "Nested Dielectric")

CLASSES = (
    _MEDIUM,
    _ADVANCED,
    *_headings(Sidebar, "sidebar", _ADVANCED),
    _REST,
    *_headings(_MaterialProperties, "material", _REST),
)
