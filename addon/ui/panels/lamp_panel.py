"""The panel of a scene's lamps: what carries their light through media and off them."""

from __future__ import annotations

import bpy

from ...scene.lights import LOBE, NOTHING, RAYS, light_carriers
from ..drawing import Sidebar, draw_alert
from ..operators.operators import LAMP_CARRIERS, AddPasses, LampCarrier, ShadowCaustics

CARRIERS = {RAYS: "Rays", LOBE: "Lobe", NOTHING: "None"}
"""What carries a lamp's light, in the panel's words."""

MAX_LAMPS = 24
"""Lamps that the panel lists; a scene may have thousands."""


def draw_lamps(layout: bpy.types.UILayout, context: bpy.types.Context) -> None:
    """What brings each lamp's light through media and off them, and the buttons to change it."""
    carriers = sorted(light_carriers(context.scene), key=lambda carrier: not carrier.reason)
    if carriers:
        rows = layout.box().column(align=True)
        draw_lamp(rows, "Lamp", "Refraction", "Reflection").active = False
        for carrier in carriers[:MAX_LAMPS]:
            words = CARRIERS[carrier.refraction], CARRIERS[carrier.reflection]
            draw_lamp(rows, carrier.lamp, *words, alert=bool(carrier.reason))
        if len(carriers) > MAX_LAMPS:
            rows.label(text=f"And {len(carriers) - MAX_LAMPS} more", icon="BLANK1")
    reasons: dict[str, list[str]] = {}
    for carrier in carriers:
        if carrier.reason:
            reasons.setdefault(carrier.reason, []).append(repr(carrier.lamp))
    for reason, names in reasons.items():
        more = f" and {len(names) - 3} more" if len(names) > 3 else ""
        draw_alert(layout, context, f"No lobe can carry {', '.join(names[:3])}{more}: {reason}")

    buttons = layout.row(align=True)
    for choice in LAMP_CARRIERS:
        button = buttons.operator(LampCarrier.bl_idname, text=f"Refract by {choice.name}")
        button.carrier = choice.keyword
    layout.separator()
    columns = layout.split(factor=0.5, align=True)
    columns.label(text="Shadow Caustics")
    for enable, text in ((True, "On"), (False, "Off")):
        columns.operator(ShadowCaustics.bl_idname, text=text).enable = enable
    layout.operator(AddPasses.bl_idname, text="Add Passes", icon="RENDERLAYERS")


def draw_lamp(
    layout: bpy.types.UILayout, name: str, refraction: str, reflection: str, alert: bool = False
) -> bpy.types.UILayout:
    """One row: a lamp and what carries its light through media and off them."""
    row = layout.row(align=True)
    row.alert = alert
    columns = row.split(factor=0.4)
    columns.label(text=name)
    for text in (refraction, reflection):
        columns.label(text=text)
    return row


class LampsPanel(Sidebar, bpy.types.Panel):
    """The scene's lamps and what carries their light, in the sidebar of the 3D view."""

    bl_idname = "NESTED_DIELECTRIC_PT_sidebar_lamps"
    bl_parent_id = "NESTED_DIELECTRIC_PT_sidebar"
    bl_label = "Lamps"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        draw_lamps(self.layout, context)


CLASSES = (LampsPanel,)
