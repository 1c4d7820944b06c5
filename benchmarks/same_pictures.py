"""Tell whether a change to the code leaves every picture as it was, bit for bit.

``python benchmarks/same_pictures.py record FOLDER [SCENE...]`` before the change, ``... compare FOLDER`` after it, by the same Blender on
the same machine: exit code 1 where a picture differs. Each scene is rendered as it is told what surrounds its media, cut, by
Cycles' own nodes, and asking.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1] / "tests"
sys.path.insert(0, str(TESTS / "helpers"))

import bpy
import numpy as np
from crossing import SCENES, nested
from scenes import add_box, add_emission_port, diffuse, render

import nested_dielectric as nd
from nested_dielectric.demo import iced_water

SAMPLES = 16

WAYS: dict[str, Callable[[bpy.types.Scene], object]] = {
    "told": lambda scene: nd.prepare(scene, cut=False, backend="OSL"),
    "cut": lambda scene: nd.prepare(scene, cut=True, backend="OSL"),
    "native": lambda scene: nd.prepare(scene, cut=True, backend="NATIVE"),
    "asking": lambda scene: nd.clear_analysis(scene),
}
"""What is done with a scene before it is rendered."""

CONTROLS = {
    "film_and_filter": dict(thin_film_thickness=350.0, thin_film_ior=1.8, polarize=True, polarization_angle=0.7),
    "reflections": dict(separate_reflection=True, reflection_roughness=0.3, specular_scale=0.7, refraction_scale=0.9),
    "switches": dict(internal_reflections=False, refract_sky=False, energy_cutoff_exponent=-2.0),
    "chances": dict(reflection_probability=0.4, max_interior_reflections=2, caustic_refraction=False),
    "direct": dict(direct_world=True, separate_direct_lobe=True, direct_roughness=0.2, direct_second_scale=0.3),
    "stretched": dict(roughness=0.3, anisotropy=0.5, blur_anisotropic_poles=0.2, tangent_from="REFRACTION"),
}
"""Parameters of both media of a scene, by its name."""


def build_controls(keywords: dict[str, object]) -> None:
    """Build two media that cross, with an object within, and an emission port that shines."""
    nested(transmittance=(0.9, 0.5, 0.3), transmittance_depth=0.8, **keywords)
    add_box("Pearl", (-0.6, -0.2, -0.2), (-0.3, 0.2, 0.2), diffuse(0.6))
    add_emission_port(bpy.data.materials["Glass"], "Emission at Interfaces", 0.2)


def build_iced_water() -> None:
    """Build the demo's scene, small."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = iced_water.build_scene()
    bpy.context.window.scene = scene
    scene.render.resolution_x = scene.render.resolution_y = 64
    scene.cycles.use_denoising = False


def pictures(names: Iterable[str]) -> Iterator[tuple[str, np.ndarray]]:
    """Yield each scene's name and way, and its picture; only of scenes of these names, if there are any."""
    builders = SCENES | {name: lambda each=each: build_controls(each) for name, each in CONTROLS.items()}
    builders["iced_water"] = build_iced_water
    for name in names or builders:
        for way, do in WAYS.items():
            builders[name]()
            do(bpy.context.scene)
            yield f"{name}.{way}", render(SAMPLES)


def main(command: str, folder: Path, *names: str) -> int:
    """Record pictures in a folder or compare them with those in it; return an exit code."""
    folder.mkdir(parents=True, exist_ok=True)
    differ = 0
    for name, picture in pictures(names):
        path = folder / f"{name}.npy"
        if command == "record":
            np.save(path, picture)
            continue
        before = np.load(path)
        if not np.array_equal(before, picture, equal_nan=True):
            differ += 1
            print(f"{name} differs by up to {np.abs(before - picture).max():.3g}")
    print(f"{differ} pictures differ" if command == "compare" else "recorded")
    return int(differ > 0)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2]), *sys.argv[3:]))
