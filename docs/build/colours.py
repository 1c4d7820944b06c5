"""Pictures of dispersion: a prism before white slits, in the light of several lamps."""

from __future__ import annotations

from functools import partial

import bpy
import studio

SLITS = 11
SPREAD = 0.3
"""Dispersion of the JF model, far more than any glass has, so that the spectra are wide enough to look at."""


def prism(distribution: str, clamp: bool = False, background: float = 0.1) -> bpy.types.Scene:
    """A prism that stands before slits, whose light is that of a distribution of :mod:`nested_dielectric.model.spectra`."""
    scene = studio.new_scene(400, 220, samples=96)
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.look = "None"
    studio.plain_world((background,) * 3, 1.0)
    corners = ((0.95, 0.0), (-0.95, 0.62), (-0.95, -0.62))
    studio.medium(
        "Prism",
        studio.column(corners, -1.15, 0.75),
        "glass",
        disperse=True,
        dispersion_model="JF",
        dispersion=SPREAD,
        spectral_distribution=distribution,
        clamp_negative=clamp,
    )
    for index in range(SLITS):
        _slit(1.12 * (index - (SLITS - 1) / 2))
    studio.camera((0.0, -7.0, 0.25), (0.0, 0.0, 0.0), lens=68.0)
    return scene


def _slit(x: float) -> None:
    slit = studio.add("Slit", studio.box((x, 5.0, 0.0), (0.022, 0.02, 8.0), bevel=0.001))
    material = studio.surface("White Light", (0.0, 0.0, 0.0), 0.5)
    shader = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Emission Color"].default_value = (1.0, 1.0, 1.0, 1.0)
    shader.inputs["Emission Strength"].default_value = 22.0
    slit.data.materials.append(material)


PICTURES = {
    "spectra": (
        2,
        {
            "Daylight": partial(prism, "DAYLIGHT"),
            "LED": partial(prism, "LED"),
            "Fluorescent": partial(prism, "FLUORESCENT"),
            "Sodium": partial(prism, "SODIUM"),
        },
    ),
    "negative_colours": (
        2,
        {
            "Negative colours kept": partial(prism, "DAYLIGHT", background=0.25),
            "Negative colours clamped": partial(prism, "DAYLIGHT", clamp=True, background=0.25),
        },
    ),
}
