"""Panels of how a medium splits light: its dispersion, and the spectrum that it is split by."""

from __future__ import annotations

import bpy
import numpy as np

from ...model.dispersion import LINE_C, LINE_D, LINE_F, abbe_number, material_ior
from ...model.distributions import DISTRIBUTIONS
from ...model.enumerations import DISPERSION_MODELS
from ...model.gamuts import GAMUTS
from ...model.parameters import BY_KEYWORD
from ...model.spectral_tables import preview
from ...nodes.compatibility import shows_front_ior
from ...nodes.render_settings import achromatic_reason
from ...nodes.spectral_images import digest
from ...scene.material_spectra import material_table, usable_spectrum_settings
from ...scene.materials import get_parameter, rendered_node
from ..drawing import draw_alert, draw_parameter, draw_text, draw_value
from ..operators.dispersion_operators import (
    SELLMEIER_REMEDY,
    DispersionModel,
    SellmeierIor,
    Spectrum,
    coefficients_ior,
)
from ..pictures import drawn_picture

MODEL_SOCKETS = {
    "ABBE": ("ior", "abbe"),
    "SELLMEIER": ("ior", "sellmeier_b", "sellmeier_c"),
    "JF": ("ior", "dispersion"),
}
"""What each dispersion model reads."""

REMEDIES = {
    "ABBE": "set a larger Abbe number, or 0 for no dispersion",
    "SELLMEIER": SELLMEIER_REMEDY,
    "JF": "bring Dispersion nearer to 0",
}
"""What to do when a model has no index above 0."""

IOR_TOLERANCE = 1e-4
"""How far IOR may be from the index of the Sellmeier coefficients before the panel says so."""

PICTURE_SIZE = (256, 256)
"""Width and height of the picture of a spectral table, pixels."""

MAX_PICTURES = 32
"""Pictures of spectral tables that are kept."""


def draw_dispersion(layout: bpy.types.UILayout, context: bpy.types.Context, material: bpy.types.Material) -> None:
    """Draw a medium's dispersion: its sockets, what they come to, and what keeps colours from showing."""
    node = rendered_node(material)
    draw_parameter(layout, material, "disperse")
    if node.inputs["Disperse"].default_value:
        reason = achromatic_reason(context.scene)
        if reason is not None:
            draw_alert(layout, context, reason)
        viewport = "Cycles' own colours for it, in daylight" if shows_front_ior() else "it as at 587.6 nm"
        draw_text(layout, context, f"The viewport shows {viewport}; see its spectrum's colours in a render", "INFO")

    model = get_parameter(node, BY_KEYWORD["dispersion_model"])
    buttons = layout.row(align=True)
    for choice in DISPERSION_MODELS:
        button = buttons.operator(DispersionModel.bl_idname, text=choice.name, depress=choice.keyword == model)
        button.model = choice.keyword
    for keyword in MODEL_SOCKETS[model]:
        if keyword != "ior":
            draw_parameter(layout, material, keyword)
    draw_indices(layout, context, node)


def draw_indices(layout: bpy.types.UILayout, context: bpy.types.Context, node: bpy.types.ShaderNodeGroup) -> None:
    """Draw a medium's index at Fraunhofer's lines and its Abbe number, or what to do where it has none."""
    model = get_parameter(node, BY_KEYWORD["dispersion_model"])
    values = {keyword: get_parameter(node, BY_KEYWORD[keyword]) for keyword in MODEL_SOCKETS[model]}
    values["dispersion_model"] = model
    lines = {"n_C": LINE_C, "n_d": LINE_D, "n_F": LINE_F}
    indices = {name: material_ior(values, wavelength) for name, wavelength in lines.items()}
    unreal = [f"{lines[name]:.1f}" for name, index in indices.items() if not index > 0.0]
    if unreal:
        draw_alert(layout, context, f"No real index above 0 at {', '.join(unreal)} nm; {REMEDIES[model]}")
        return
    rows = layout.column(align=True)
    for name, index in indices.items():
        draw_value(rows, name, f"{index:.5f} ({lines[name]:.1f} nm)", 0.2)
    abbe = abbe_number(values)
    draw_value(rows, "V_d", f"{abbe:.2f}" if np.isfinite(abbe) else "no dispersion", 0.2)

    own = coefficients_ior(node)
    if model == "SELLMEIER" and abs(own - values["ior"]) > IOR_TOLERANCE:
        text = f"IOR is not the coefficients' own {own:.5f}; their curve is shifted to go through IOR"
        draw_text(layout, context, text, "INFO")
        layout.operator(SellmeierIor.bl_idname, text=f"Set IOR to {own:.5f}")


def draw_spectrum(layout: bpy.types.UILayout, material: bpy.types.Material) -> None:
    """Draw a medium's spectral table: its picture, what it was baked from, and the button to bake another."""
    settings = usable_spectrum_settings(material)
    table = material_table(material)
    if table is not None:
        layout.template_icon(icon_value=picture(table), scale=6.0)
    names = {choice.keyword: choice.name for choice in (*DISTRIBUTIONS, *GAMUTS)}
    distribution = str(settings["spectral_distribution"])
    gamut = str(settings["spectral_gamut"])
    rows = layout.column(align=True)
    draw_value(rows, "Distribution", names.get(distribution.upper()) or bpy.path.basename(distribution))
    draw_value(rows, "Gamut", names.get(gamut, gamut))
    draw_value(rows, "Saturation", f"{settings['spectral_saturation']:.3g}")
    draw_value(rows, "Negative", "clamped" if settings["clamp_negative"] else "kept")
    layout.operator(Spectrum.bl_idname, text="Spectrum...")


def picture(table: np.ndarray) -> int:
    """Return the icon that shows a spectral table, drawn on first use."""
    return drawn_picture(f"spectrum {digest(table)}", lambda: _encoded(preview(table, *PICTURE_SIZE)), MAX_PICTURES)


def _encoded(pixels: np.ndarray) -> np.ndarray:
    """Return pixels with the transfer curve of sRGB (IEC 61966-2-1): icons are not managed."""
    linear = pixels[..., :3]
    pixels[..., :3] = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    return pixels
