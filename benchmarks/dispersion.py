"""Error of dispersing pictures against samples per pixel, for three ways to draw the wavelength of a path.

Run as ``.venv/bin/python benchmarks/dispersion.py [--scenes NAME ...] [--samples N] [--output PNG]``. The ways are

* time: as shipped, Cycles' well-distributed random number for time.
* random: independent random numbers, which are hashes of that number.
* three channels: an index for red, one for green and one for blue, drawn by Cycles' number. It converges, to a wrong
  picture; how wrong is its floor. One that is not above 0 is lost in noise.

The reference is drawn by time too, with other seeds and more samples; that it is right is up to the tests. Errors are
mean squares over pixels, channels and seeds, parted into that of the mean of the channels and what is left, the chroma:
the two add up to the whole. The variance of the reference is taken off.

The wavelength is one of a path's random numbers. Where the picture within a pixel and the choice between reflection and
refraction matter more, no way to draw it helps: the ratio of variances is that of a scene and of a size of its pixels.
Scenes that are not in the plot serve to tell these apart.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "helpers"))

import bpy

import bmesh  # isort: skip
import numpy as np
from dispersing import APEX, CLEAR, SF11, dispersing_scene, index, material, prism, set_band_world
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scenes import add_camera, add_mesh, add_sphere, render, set_world

from nested_dielectric.model.dispersion import LINE_D, mean_inverse_square_offsets
from nested_dielectric.model.presets import load_preset
from nested_dielectric.model.shader_source import inlined_source
from nested_dielectric.nodes.names import COORDINATE_NODE, TABLES_NODE
from nested_dielectric.nodes.osl import COORDINATE_FILE, compiled
from nested_dielectric.nodes.spectral_tables import set_table
from nested_dielectric.scene.material_spectra import material_table
from nested_dielectric.scene.materials import dielectric_node

DIAMOND = load_preset("diamond").parameters

RATIO_SAMPLES = 256
"""Samples per pixel at which ways are compared."""

TARGET = 3.0
"""Times lower that the variance is wanted to be by time than by random numbers."""

REFERENCE = (4, 512)
"""Renders of the reference, and samples of each."""

REFERENCE_SEED = 1000

TIME_NUMBER = "(time * SHUTTER_TABLE * SHUTTER_TABLE / (SHUTTER_TABLE - 1.0) - 0.5) / (SHUTTER_TABLE - 1.0)"
RANDOM_NUMBER = "cellnoise(time * 16777216.0)"
"""Uniform too, and the same along a path. Single precision has that many numbers between 0 and 1."""


def look_at_whole_sphere() -> bpy.types.Material:
    """The tests' sphere."""
    glass = material(SF11)
    add_sphere("Sphere", 1.0, glass, priority=1)
    set_band_world()
    add_camera((0, -5, 0.3), (0, 0, 0), width=2.1)
    return glass


def look_closer(**keywords) -> bpy.types.Material:
    """An eighth of that sphere's width, with the pixels of a picture that shows all of it at 256 x 256."""
    glass = material(SF11, **keywords)
    add_sphere("Sphere", 1.0, glass, priority=1, segments=256)
    set_band_world()
    add_camera((0.55, -5, 0.45), (0.55, 0, 0.45), width=0.25)
    return glass


def look_closer_without_reflections() -> bpy.types.Material:
    """The same with nothing to choose at a surface."""
    return look_closer(**CLEAR)


def look_closer_at_white() -> bpy.types.Material:
    """The same before white: noise comes from wavelengths and the choice between reflection and refraction alone."""
    glass = look_closer()
    set_world()
    return glass


SLIT = np.radians(0.5)


def look_through_prism() -> bpy.types.Material:
    """A spectrum: the tests' prism before a bright slit."""
    glass = material(SF11)
    prism(glass, priority=1)
    turned = np.arcsin(index(SF11, 550.0) * np.sin(np.radians(APEX))) - np.radians(APEX)
    tree = set_world()
    nodes, links = tree.nodes, tree.links
    separate, slope, inside = (nodes.new(f"ShaderNode{kind}") for kind in ("SeparateXYZ", "Math", "Math"))
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], separate.inputs[0])
    slope.operation, inside.operation = "DIVIDE", "COMPARE"
    links.new(separate.outputs["X"], slope.inputs[0])
    links.new(separate.outputs["Y"], slope.inputs[1])
    links.new(slope.outputs[0], inside.inputs[0])
    inside.inputs[1].default_value = -np.tan(turned)
    inside.inputs[2].default_value = SLIT / 2.0 / np.cos(turned) ** 2
    links.new(inside.outputs[0], nodes["Background"].inputs["Strength"])
    add_camera((0.03, -4, 0.02), (0.03, 0, 0.02), angle=8)
    return glass


def brilliant(glass: bpy.types.Material) -> bpy.types.Object:
    """A cut with eight main facets above and below the girdle, 2 wide, its table up."""

    def build(bm):
        for height, radius, corners, turn in ((0.32, 1.12, 8, 0.5), (0.0, 2.0, 16, 0.0), (-0.86, 0.0, 1, 0.0)):
            for angle in 2.0 * np.pi * (np.arange(corners) + turn) / corners:
                bm.verts.new((radius / 2.0 * np.cos(angle), radius / 2.0 * np.sin(angle), height))
        bmesh.ops.convex_hull(bm, input=bm.verts)

    return add_mesh("Brilliant", build, glass, priority=1)


def look_into_diamond() -> bpy.types.Material:
    """The crown of a cut diamond, most of whose light has been reflected totally."""
    glass = material(DIAMOND)
    brilliant(glass)
    set_band_world()
    add_camera((0.9, -2.4, 4.1), (0.25, -0.3, 0.2), width=0.5)
    return glass


@dataclass(frozen=True)
class Scene:
    """What is rendered: a function that makes it, and the picture's size.

    What is not plotted has its variances compared alone.
    """

    label: str
    make: Callable[[], bpy.types.Material]
    width: int = 32
    height: int = 32
    plotted: bool = True


SCENES = {
    "sphere": Scene("whole sphere", look_at_whole_sphere),
    "closer": Scene("close to the sphere", look_closer),
    "prism": Scene("slit through a prism", look_through_prism, 64, 8),
    "clear": Scene("close, no reflections", look_closer_without_reflections, plotted=False),
    "white": Scene("close, white world", look_closer_at_white, 16, 16, plotted=False),
    "diamond": Scene("cut diamond", look_into_diamond, plotted=False),
    "sphere-64": Scene("whole sphere", look_at_whole_sphere, 64, 64, plotted=False),
    "sphere-128": Scene("whole sphere", look_at_whole_sphere, 128, 128, plotted=False),
}


def draw_by_time(glass: bpy.types.Material) -> None:
    """Leave the material as it is shipped."""


def draw_at_random(glass: bpy.types.Material) -> None:
    """Draw every path's wavelength by itself."""
    source = inlined_source(COORDINATE_FILE)
    if source.count(TIME_NUMBER) != 1:
        raise RuntimeError(f"{COORDINATE_FILE} no longer has the random number {TIME_NUMBER!r} once")
    source = source.replace(TIME_NUMBER, RANDOM_NUMBER)
    node = dielectric_node(glass).node_tree.nodes[COORDINATE_NODE]
    text = bpy.data.texts.new("Random")
    text.from_string(source)
    node.script = text
    node.bytecode = compiled(source)
    node.bytecode_hash = hashlib.md5(node.bytecode.encode(), usedforsecurity=False).hexdigest()


def draw_three_channels(glass: bpy.types.Material) -> None:
    """Put the wavelengths at which red, green and blue have their mean index in the place of the spectrum."""
    node = dielectric_node(glass)
    means = mean_inverse_square_offsets(material_table(glass))
    table = np.zeros((3, 4), np.float32)
    table[:, :3] = 3.0 * np.eye(3)
    table[:, 3] = 1e3 * (means + (LINE_D * 1e-3) ** -2) ** -0.5
    tables = node.node_tree.nodes[TABLES_NODE]
    tables.image = None
    tables.interpolation = "Closest"
    set_table(node, table)
    if not np.allclose(mean_inverse_square_offsets(material_table(glass)), means, rtol=1e-4):
        raise RuntimeError("three wavelengths with other means than the spectrum's")


WAYS = {"time": draw_by_time, "random": draw_at_random, "three channels": draw_three_channels}
COLORS = {"time": "tab:blue", "random": "tab:orange", "three channels": "tab:green"}
PARTS = ("all", "luminance", "chroma")


def seeds(samples: int) -> int:
    """Renders of that many samples, for the error."""
    return 4 if samples <= RATIO_SAMPLES else 1


def picture(samples: int, seed: int) -> np.ndarray:
    """Render an aligned part of Cycles' sequence that leaves out the first sample.

    That one always goes through the middle of a pixel and would weigh too much where there are few.
    """
    cycles = bpy.context.scene.cycles
    cycles.use_sample_subset = True
    cycles.sample_offset = cycles.sample_subset_length = samples
    return render(2 * samples, seed)


def pictures(samples: int, count: int, first_seed: int = 0) -> np.ndarray:
    """Independent renders of the current scene."""
    bpy.context.scene.render.use_persistent_data = True
    return np.stack([picture(samples, first_seed + place) for place in range(count)])


def mean_squares(errors: np.ndarray) -> np.ndarray:
    """Mean squares of errors of RGB: all, of the mean of the channels, and of what is left."""
    mean = errors.mean(axis=-1, keepdims=True)
    return np.array([np.mean(part**2) for part in (errors, mean, errors - mean)])


def variance(batches: np.ndarray) -> np.ndarray:
    """:data:`PARTS` of one batch's variance."""
    return mean_squares(batches - batches.mean(axis=0)) * len(batches) / (len(batches) - 1)


def build(scene: Scene, way: str) -> None:
    settings = dispersing_scene().render
    settings.resolution_x, settings.resolution_y = scene.width, scene.height
    WAYS[way](scene.make())


def measure(scene: Scene, counts: list[int]) -> dict:
    """Errors of a scene by way and count of samples, or its variances alone."""
    result = {"label": scene.label, "size": [scene.width, scene.height], "ways": {}}
    if scene.plotted:
        build(scene, "time")
        batches = pictures(REFERENCE[1], REFERENCE[0], REFERENCE_SEED)
        reference = batches.mean(axis=0)
        doubt = variance(batches) / len(batches)
        result["reference"] = named(mean_squares(reference))
        result["reference_variance"] = named(doubt)
    compared = min(RATIO_SAMPLES, counts[-1])
    variances = {}
    for way in WAYS if scene.plotted else ("time", "random"):
        build(scene, way)
        numbers = result["ways"][way] = {"rows": []}
        for samples in counts if scene.plotted else (compared,):
            batches = pictures(samples, seeds(samples))
            if scene.plotted:
                error = named(mean_squares(batches - reference) - doubt)
                numbers["rows"].append({"samples": samples, "seeds": len(batches), "error": error})
            if samples == compared:
                variances[way] = variance(batches)
                numbers["variance"] = named(variances[way])
                if way == "three channels":
                    bias = mean_squares(batches.mean(axis=0) - reference) - variances[way] / len(batches) - doubt
                    numbers["floor"] = named(bias)
    result["variance_ratio"] = {"samples": compared} | named(variances["random"] / variances["time"])
    return result


def named(numbers: np.ndarray) -> dict[str, float]:
    return dict(zip(PARTS, numbers.tolist(), strict=True))


def plot(results: dict[str, dict], path: Path) -> None:
    results = {name: result for name, result in results.items() if SCENES[name].plotted}
    if not results:
        return
    figure = Figure(figsize=(3.4 * len(results), 6.4), layout="constrained")
    axes = figure.subplots(2, len(results), sharex=True, sharey="col", squeeze=False)
    for column, result in zip(axes.T, results.values(), strict=True):
        for axis, part in zip(column, ("all", "chroma"), strict=True):
            draw(axis, result, part)
        column[0].set_title(result["label"])
        column[1].set_xlabel("samples per pixel")
    axes[0, 0].set_ylabel("mean square error")
    axes[1, 0].set_ylabel("mean square error of the chroma")
    figure.legend(*axes[0, -1].get_legend_handles_labels(), loc="outside lower center", ncols=5)
    figure.savefig(path, dpi=120)


def draw(axis: Axes, result: dict, part: str) -> None:
    for way, numbers in result["ways"].items():
        counts = [row["samples"] for row in numbers["rows"]]
        errors = [row["error"][part] for row in numbers["rows"]]
        axis.loglog(counts, errors, "o-", markersize=4, color=COLORS[way], label=way)
        if numbers.get("floor", {}).get(part, 0.0) > 0.0:
            axis.axhline(numbers["floor"][part], color=COLORS[way], linestyle="--", linewidth=1, label="its floor")
        if way == "random":
            slope = errors[0] * counts[0] / np.array(counts)
            axis.loglog(counts, slope, color="0.6", linestyle=":", linewidth=1, label="1 / samples", zorder=0)
    ratio = result["variance_ratio"]
    text = f"variance at {ratio['samples']}:\n{ratio[part]:.1f} times lower"
    axis.text(0.03, 0.03, text, transform=axis.transAxes, fontsize="small", bbox={"color": "white", "pad": 1})
    axis.set_xticks(counts, [str(count) for count in counts])
    axis.tick_params(axis="x", which="minor", bottom=False)
    axis.grid(alpha=0.3)


def print_table(results: dict[str, dict]) -> None:
    for name, result in results.items():
        if not SCENES[name].plotted:
            continue
        counts = [row["samples"] for row in result["ways"]["time"]["rows"]]
        width, height = result["size"]
        print(f"\n{result['label']}, {width} x {height}: mean square error by samples per pixel")
        print(f"{'':28}" + "".join(f"{count:>10}" for count in counts) + f"{'floor':>10}")
        for part in PARTS:
            for way, numbers in result["ways"].items():
                cells = [row["error"][part] for row in numbers["rows"]]
                cells += [numbers["floor"][part]] if "floor" in numbers else []
                print(f"{part:12}{way:16}" + "".join(f"{cell:10.2e}" for cell in cells))
    print(f"\nvariance by random numbers over that by time (wanted: at least {TARGET:g}), and that by time")
    print(f"{'':40}" + "".join(f"{part:>12}" for part in (*PARTS, "by time")))
    for result in results.values():
        ratio = result["variance_ratio"]
        width, height = result["size"]
        label = f"{result['label']}, {width} x {height}, {ratio['samples']}"
        cells = "".join(f"{ratio[part]:12.2f}" for part in PARTS)
        print(f"{label:40}{cells}{result['ways']['time']['variance']['all']:12.2e}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument(
        "--scenes", nargs="+", choices=SCENES, help="all but the two largest if not given", default=list(SCENES)[:-2]
    )
    parser.add_argument("--samples", type=int, default=1024, help="most samples per pixel, a power of 4")
    parser.add_argument(
        "--output", type=Path, default=ROOT / "out" / "dispersion.png", help="plot; JSON goes beside it"
    )
    arguments = parser.parse_args()
    counts = [4**power for power in range(12) if 4**power <= arguments.samples]
    start = time.perf_counter()
    results = {name: measure(SCENES[name], counts) for name in arguments.scenes}
    seconds = time.perf_counter() - start
    arguments.output.parent.mkdir(parents=True, exist_ok=True)
    arguments.output.with_suffix(".json").write_text(json.dumps(results, indent=1))
    plot(results, arguments.output)
    print_table(results)
    print(f"\n{seconds:.0f} s; {arguments.output} and {arguments.output.with_suffix('.json').name}")


if __name__ == "__main__":
    main()
