"""Tell whether a change to the code leaves every picture as it was, bit for bit.

``python benchmarks/same_pictures.py render FOLDER [SCENE...]`` some times before the change and, into another folder, after it;
then ``... compare BEFORE AFTER``: exit code 1 where no picture of one stands among the other's. Each scene is rendered as it is
told what surrounds its media, cut, by Cycles' own nodes, and asking.

Cycles, with its own Glass alone, makes one of some few pictures of two overlapping balls, as the system places its memory: so
pictures of several runs are compared as sets.
"""

from __future__ import annotations

import hashlib
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
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"


def pictures(names: Iterable[str]) -> Iterator[tuple[str, np.ndarray]]:
    """Yield each scene's name and way, and its picture; only of scenes of these names, if there are any."""
    builders = SCENES | {name: lambda each=each: build_controls(each) for name, each in CONTROLS.items()}
    builders["iced_water"] = build_iced_water
    for name in names or builders:
        for way, do in WAYS.items():
            builders[name]()
            do(bpy.context.scene)
            bpy.context.scene.render.threads_mode, bpy.context.scene.render.threads = "FIXED", 1
            yield f"{name}.{way}", render(SAMPLES)


def render_all(folder: Path, names: Iterable[str]) -> None:
    """Add to a folder each picture that it does not hold yet."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, picture in pictures(names):
        digest = hashlib.sha256(picture.tobytes()).hexdigest()[:12]
        np.save(folder / f"{name}.{digest}.npy", picture)


def compare(before: Path, after: Path) -> int:
    """Print which pictures of ``after`` have no equal in ``before``; return how many."""
    differ = 0
    for name in sorted({path.name.rsplit(".", 2)[0] for path in after.glob("*.npy")}):
        old, new = ({path.name: path for path in folder.glob(f"{name}.*.npy")} for folder in (before, after))
        if not old.keys() & new.keys():
            differ += 1
            least = min(
                (np.abs(np.load(a) - np.load(b)).max() for a in old.values() for b in new.values()), default=np.inf
            )
            print(f"{name} differs by at least {least:.3g}, of {len(old)} and {len(new)}")
    print(f"{differ} pictures differ")
    return differ


if __name__ == "__main__":
    command, *folders = sys.argv[1:]
    if command == "compare":
        sys.exit(compare(*map(Path, folders)) > 0)
    render_all(Path(folders[0]), folders[1:])
