"""The panel of a scene's lights: what carries them through media and off them."""

from __future__ import annotations

import bpy

from ...scene.lights import LOBE, NOTHING, RAYS, light_carriers
from ..drawing import Sidebar, draw_alert
from ..operators.light_operators import LIGHT_TRANSPORTS, AddPasses, LightCarrier, ShadowCaustics

WORDS = {RAYS: "Rays", LOBE: "Lobe", NOTHING: "None"}
"""What carries a light, in the panel's words."""

MAX_LIGHTS = 24
"""Lights that the panel lists; a scene may have thousands."""


def draw_lights(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """Draw what carries each light through media and off them, and the buttons to change it."""
    transports = sorted(light_carriers(context.scene), key=lambda transport: not transport.reason)
    if transports:
        rows = layout.box().column(align=True)
        draw_light(rows, "Light", "Refraction", "Reflection").active = False
        for transport in transports[:MAX_LIGHTS]:
            words = WORDS[transport.refraction], WORDS[transport.reflection]
            draw_light(rows, transport.light, *words, alert=bool(transport.reason))
        if len(transports) > MAX_LIGHTS:
            rows.label(text=f"And {len(transports) - MAX_LIGHTS} more", icon="BLANK1")
    reasons: dict[str, list[str]] = {}
    for transport in transports:
        if transport.reason:
            reasons.setdefault(transport.reason, []).append(repr(transport.light))
    for reason, names in reasons.items():
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        draw_alert(layout, context, f"No lobe can carry {', '.join(names[:3])}{more}: {reason}")

    buttons = layout.row(align=True)
    for choice in LIGHT_TRANSPORTS:
        button = buttons.operator(LightCarrier.bl_idname, text=f"Refract by {choice.name}")
        button.carrier = choice.keyword
    layout.separator()
    columns = layout.split(factor=0.5, align=True)
    columns.label(text="Shadow Caustics")
    for enable, text in ((True, "On"), (False, "Off")):
        columns.operator(ShadowCaustics.bl_idname, text=text).enable = enable
    layout.operator(AddPasses.bl_idname, text="Add Passes", icon="RENDERLAYERS")


def draw_light(
    layout: bpy.types.UILayout, name: str, refraction: str, reflection: str, alert: bool = False
) -> bpy.types.UILayout:
    """Draw one row: a light and what carries it through media and off them."""
    row = layout.row(align=True)
    row.alert = alert
    columns = row.split(factor=0.4)
    columns.label(text=name)
    for text in (refraction, reflection):
        columns.label(text=text)
    return row


class LightsPanel(Sidebar, bpy.types.Panel):
    """The scene's lights and what carries them, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar_lamps"
    bl_parent_id = "NESTED_DIELECTRIC_PT_sidebar"
    bl_label = "Lights"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        draw_lights(self.layout, context)


CLASSES = (LightsPanel,)
