"""Pictures of lamps and media: direct refraction, its lobes, shadows and the polarizing filter."""

from __future__ import annotations

from functools import partial
from math import radians

import bpy
import studio

VASE = (
    (0.0, 0.004, 0.0),
    (0.42, 0.004, 0.05),
    (0.60, 0.55, 0.3),
    (0.30, 1.25, 0.3),
    (0.46, 1.62, 0.02),
    (0.40, 1.62, 0.02),
    (0.24, 1.25, 0.28),
    (0.52, 0.55, 0.26),
    (0.34, 0.12, 0.08),
    (0.0, 0.12, 0.0),
)

PAWN = (
    (0.0, 0.004, 0.0),
    (0.44, 0.004, 0.05),
    (0.46, 0.20, 0.06),
    (0.22, 0.36, 0.15),
    (0.15, 0.82, 0.1),
    (0.36, 0.92, 0.05),
    (0.33, 1.0, 0.05),
    (0.13, 1.02, 0.05),
    (0.34, 1.22, 0.17),
    (0.26, 1.52, 0.16),
    (0.0, 1.56, 0.0),
)


def by_lobe(carried: bool, caustics: bool = False) -> bpy.types.Scene:
    """Solid glass with one small lamp behind it, which rays through glass do not see but its lobe may."""
    scene = studio.new_scene(300, 300, samples=48)
    values = {
        "direct_refraction": float(carried),
        "direct_roughness_offset": 0.18,
        "caustic_direct_refraction": caustics,
        "caustic_roughness_offset": 0.1,
        "shadow_mode": "BLACK",
    }
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = caustics
    scene.cycles.sample_clamp_indirect = 0.0
    studio.medium("Pawn", studio.turned(PAWN), "glass", **values)
    bpy.data.objects["Pawn"].location = (-0.3, 0.35, 0.0)
    studio.medium("Ball", studio.ball((0.62, 0.1, 0.4), 0.39), "glass", **values)
    studio.floor(light=(0.42, 0.42, 0.43), dark=(0.30, 0.30, 0.31), tile=0.35)
    studio.plain_world(studio.COOL, 0.06)
    lamp = studio.softbox((-0.5, 4.6, 3.4), (0.2, 0.0, 0.3), 500.0, size=0.4, colour=studio.WARM)
    lamp.visible_transmission = False
    studio.camera((0.25, -4.6, 2.7), (0.17, -0.25, 0.48), lens=58.0)
    return scene


def lobe(**values) -> bpy.types.Scene:
    """A clear ball whose direct refraction has a lobe of its own, with a small lamp behind it."""
    scene = studio.new_scene(240, 240, samples=48)
    values = {"separate_direct_lobe": True, "direct_roughness": 0.42, "direct_roughness_offset": 0.0, **values}
    ball = studio.ball((0.0, 0.0, 0.75), 0.745)
    studio.medium("Ball", ball, "glass", shadow_mode="BLACK", **values)
    studio.floor(light=(0.3, 0.3, 0.31), dark=(0.14, 0.14, 0.15), tile=0.4)
    studio.plain_world(studio.COOL, 0.06)
    lamp = studio.softbox((0.0, 5.0, 1.6), (0.0, 0.0, 0.75), 60.0, size=0.5, colour=studio.WARM)
    lamp.visible_transmission = False
    studio.camera((0.0, -4.4, 1.3), (0.0, 0.0, 0.7), lens=68.0)
    return scene


def shadow(mode: str) -> bpy.types.Scene:
    """An amber ball and a clear vase in the sun, with no caustics."""
    scene = studio.new_scene(300, 260, samples=32)
    amber = {"transmittance": (0.95, 0.45, 0.08), "transmittance_depth": 0.8}
    studio.medium("Ball", studio.ball((-0.55, -0.2, 0.5), 0.49), "glass", shadow_mode=mode, **amber)
    studio.medium("Vase", studio.turned(VASE), "glass", shadow_mode=mode)
    bpy.data.objects["Vase"].location = (0.55, 0.35, 0.0)
    studio.floor(light=(0.75, 0.74, 0.72), dark=(0.68, 0.68, 0.68))
    studio.wall(strength=0.7)
    studio.sun((-0.55, 0.75, 0.9), 4.0)
    studio.camera((0.2, -4.6, 2.6), (0.15, -0.15, 0.5), lens=54.0)
    return scene


def filtered(angle: float | None) -> bpy.types.Scene:
    """A ball of black glass below a bright sky, seen through a filter at an angle in degrees, or through none."""
    scene = studio.new_scene(300, 280, samples=32)
    filtering = {} if angle is None else {"polarize": True, "polarization_angle": radians(angle)}
    black = {"transmittance": (0.0, 0.0, 0.0), "transmittance_depth": 0.05}
    studio.medium("Ball", studio.ball((0.0, 0.0, 0.8), 0.79), "glass", **black, **filtering)
    studio.floor(light=(0.25, 0.25, 0.26), dark=(0.10, 0.10, 0.11))
    studio.plain_world((0.75, 0.87, 1.0), 1.0)
    studio.softbox((-3.0, -1.0, 4.0), (0.0, 0.0, 0.8), 500.0, size=1.4)
    studio.camera((0.0, -5.0, 1.5), (0.0, 0.0, 0.78), lens=68.0)
    return scene


PICTURES = {
    "direct_refraction": (
        3,
        {
            "Direct Refraction 0": partial(by_lobe, False),
            "Direct Refraction 1": partial(by_lobe, True),
            "And Caustic Direct Refraction": partial(by_lobe, True, True),
        },
    ),
    "lobes": (
        4,
        {
            "GGX": partial(lobe, direct_distribution="GGX"),
            "Beckmann": partial(lobe, direct_distribution="BECKMANN"),
            "Along the refraction": partial(
                lobe, direct_anisotropy=-0.85, tangent_from="REFRACTION", blur_anisotropic_poles=0.4
            ),
            "Across the tangent": partial(lobe, direct_anisotropy=0.85, tangent_from="TANGENT"),
        },
    ),
    "shadow_modes": (
        2,
        {
            "Black": partial(shadow, "BLACK"),
            "Transmission Only": partial(shadow, "TRANSMISSION"),
            "Transmission and Outside Fresnel": partial(shadow, "OUTSIDE_FRESNEL"),
            "Transmission and All Fresnel": partial(shadow, "ALL_FRESNEL"),
        },
    ),
    "polarizer": (
        3,
        {
            "No filter": partial(filtered, None),
            "Filter upright, 0°": partial(filtered, 0.0),
            "Filter across, 90°": partial(filtered, 90.0),
        },
    ),
}
