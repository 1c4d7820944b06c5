"""Scenes that one Blender saves and another renders.

``python tests/helpers/crossing.py FOLDER`` saves them with their pictures.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from scenes import (
    add,
    add_box,
    add_camera,
    add_plane,
    add_point_light,
    add_sphere,
    batches,
    diffuse,
    new_scene,
    set_striped_world,
    set_world,
)

import nested_dielectric as nd

SAMPLES, BATCHES = 256, 16
TINT = {"transmittance": (0.9, 0.5, 0.3), "transmittance_depth": 0.8}

SCENES: dict[str, Callable[[], bool]] = {}
"""Builders by name; each tells whether its media are analysed."""


def _scene(build: Callable[[], bool]) -> Callable[[], bool]:
    SCENES[build.__name__.removeprefix("build_")] = build
    return build


def nested(**keywords) -> None:
    """Glass around water, which reaches out of it."""
    new_scene(32)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    add_sphere("Glass", 1.0, nd.new_material("Glass", ior=1.5, **keywords), 2)
    add_sphere("Water", 0.7, nd.new_material("Water", ior=1.33, **keywords), 1, (0.5, -0.2, 0.1))


@_scene
def build_smooth() -> bool:
    nested()
    return True


@_scene
def build_smooth_asking() -> bool:
    nested()
    return False


@_scene
def build_rough() -> bool:
    nested(roughness=0.4, distribution="GGX")
    return True


@_scene
def build_anisotropic() -> bool:
    nested(roughness=0.2, anisotropy=0.6, distribution="GGX")
    return False


@_scene
def build_thin_film() -> bool:
    nested(thin_film_thickness=350.0, thin_film_ior=1.8)
    return True


@_scene
def build_absorbing() -> bool:
    nested(**TINT)
    add_box("Pearl", (-0.6, -0.2, -0.2), (-0.3, 0.2, 0.2), diffuse(0.6))
    return True


@_scene
def build_dispersing() -> bool:
    nested(abbe=25.0, disperse=True)
    return True


@_scene
def build_dispersing_asking() -> bool:
    nested(abbe=25.0, disperse=True, spectral_distribution="FL2", clamp_negative=False, **TINT)
    return False


@_scene
def build_told_of_by_object() -> bool:
    """Bodies of one material in different surroundings."""
    nested()
    glass = bpy.data.materials["Glass"]
    add_sphere("Alone", 0.2, glass, 3, (-1.3, 0, 0))
    add_sphere("Inside", 0.2, glass, 0, (0.5, -0.2, 0.1))
    return True


@_scene
def build_lobes() -> bool:
    """A light that lobes carry, behind rough glass."""
    nested(roughness=0.3)
    set_world((0.1, 0.1, 0.1))
    light = add("Lamp", bpy.data.lights.new("Lamp", "AREA"), (0.0, 3.0, 1.0))
    light.data.energy = 200.0
    light.rotation_euler = (-1.4, 0.0, 0.0)
    light.visible_transmission = light.visible_glossy = False
    return True


@_scene
def build_caustics() -> bool:
    """A floor lit through a ball by Cycles' shadow caustics alone."""
    new_scene(32)
    set_world((0, 0, 0))
    cycles = bpy.context.scene.cycles
    cycles.caustics_refractive = cycles.caustics_reflective = False
    add_sphere("Ball", 0.5, nd.new_material("Glass", ior=1.5, shadow_mode="BLACK"), location=(0, 0, 1.2))
    add_plane("Floor", 6, (0, 0, 0), (0, 0, 1), diffuse())
    add_point_light((0, 0, 3), 100)
    add_camera((0, -2.5, 0.6), (0, 0, 0), angle=30)
    nd.set_shadow_caustics(bpy.context.scene)
    return True


def shadows(mode: str) -> None:
    """A floor lit through nested media."""
    new_scene(32)
    set_world((0, 0, 0))
    add_box("Glass", (-1, -1, 0.5), (1, 1, 1.5), nd.new_material("Glass", ior=1.5, shadow_mode=mode, **TINT), 2)
    add_box("Water", (-0.5, -0.5, 0.7), (0.6, 0.6, 2.0), nd.new_material("Water", ior=1.33, shadow_mode=mode), 1)
    add_plane("Floor", 6, (0, 0, 0), (0, 0, 1), diffuse())
    add_point_light((0.3, 0.2, 4), 300)
    add_camera((0.3, -5, 2.5), (0, 0, 0.4), angle=35)


for _mode in ("BLACK", "TRANSMISSION", "OUTSIDE_FRESNEL", "ALL_FRESNEL"):
    SCENES[f"shadows_{_mode.lower()}"] = lambda mode=_mode: shadows(mode) or mode != "ALL_FRESNEL"


def save_all(folder: Path) -> None:
    """Save every scene, and batches of its picture as this Blender renders it."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, build in SCENES.items():
        analysed = build()
        scene = bpy.context.scene
        limits = scene.cycles.transparent_max_bounces
        nd.prepare(scene)
        assert scene.cycles.transparent_max_bounces == limits
        if not analysed:
            nd.clear_analysis(scene)
        bpy.ops.wm.save_as_mainfile(filepath=str(folder / f"{name}.blend"))
        np.save(folder / f"{name}.npy", batches(SAMPLES, BATCHES))


if __name__ == "__main__":
    save_all(Path(sys.argv[1]))
