"""One scene by every way there is to render it, and what its pictures say of light's energy and of each other.

Red is a white furnace, green and blue tell directions: see :func:`random_bodies.stage`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import bpy  # before mathutils, which lives inside it
import numpy as np
from random_bodies import build
from random_media import SPLITS_BY_CYCLES, SPLITS_BY_TIME, RandomScene
from scenes import SUBPIXELS, render, split_into_batches
from significance import chance_of_same_picture, visible_difference

import nested_dielectric as nd
from nested_dielectric.cutting import needs

ASKED, TOLD, CUT, NATIVE, GLASS, SPLIT, REFERENCE = "asked", "told", "cut", "native", "glass", "split", "reference"

OURS = (ASKED, TOLD, CUT, NATIVE)
"""Ways of nested dielectrics; each has a seed of its own, so noise is independent."""

SAMPLES = 4
"""Of each of a pixel's parts, so 64 a pixel."""

MANY = 16
"""The same where there is one scene, not hundreds."""

BATCHES = 16
TILE = 8

ROUNDING = 1e-4
"""By which single precision may raise light that meets a thousand surfaces."""

FIT = 0.01
"""By which multi-scatter GGX, a fit, may exceed the energy that it gets; Cycles' own Glass does, too."""


@dataclass(frozen=True)
class Picture:
    """What one render says.

    `batches` (BATCHES, height, width, 3); `mean` of the furnace less 1, `error` its standard error, `highest` of all parts of
    pixels and channels, `lowest` likewise, `broken` how many of them are no number or infinite.
    """

    batches: np.ndarray
    mean: float
    error: float
    highest: float
    lowest: float
    broken: int

    def numbers(self) -> dict[str, float]:
        """Return what is kept of it."""
        return {name: getattr(self, name) for name in ("mean", "error", "highest", "lowest", "broken")}


def take(seed: int, samples: int = MANY) -> Picture:
    """Render the current scene, in parts of pixels that make independent batches."""
    scene = bpy.context.scene
    scene.render.resolution_percentage = 100 * SUBPIXELS
    try:
        parts = render(samples, seed)
    finally:
        scene.render.resolution_percentage = 100
    batches = split_into_batches(parts, BATCHES)
    furnaces = batches[..., 0].mean(axis=(1, 2))
    return Picture(
        batches,
        float(furnaces.mean() - 1.0),
        float(furnaces.std(ddof=1) / BATCHES**0.5),
        float(np.nanmax(parts)),
        float(np.nanmin(parts)),
        int((~np.isfinite(parts)).sum()),
    )


def told() -> nd.Preparation:
    """Prepare the current scene so that media which others do not cross know what surrounds them."""
    return nd.prepare(bpy.context.scene, cut=False, backend="OSL")


def asked() -> nd.Preparation:
    """Prepare the current scene so that all media ask."""
    result = told()
    nd.clear_analysis(bpy.context.scene)
    return result


def cut() -> nd.Preparation:
    """Prepare the current scene so that surfaces are cut where media cross."""
    return nd.prepare(bpy.context.scene, cut=True, backend="OSL")


def native() -> nd.Preparation:
    """Prepare the current scene for Cycles' own nodes alone."""
    result = nd.prepare(bpy.context.scene, cut=True, backend="NATIVE")
    bpy.context.scene.cycles.shading_system = False
    return result


PREPARE: dict[str, Callable[[], nd.Preparation]] = {TOLD: told, ASKED: asked, CUT: cut, NATIVE: native}


def can_be_native(result: nd.Preparation) -> bool:
    """Return whether Cycles' own nodes render all media of the current scene; else some show the alarm."""
    return not any(need.is_hard for need in needs.find_needs(bpy.context.scene, result.cut, result.found))


def by_all_ways(
    build_media: Callable[[], object], samples: int = SAMPLES, splits: str = ""
) -> tuple[dict[str, Picture], list[str]]:
    """Build a scene of nested dielectrics and render it by every way that can; return the pictures, and problems that are told.

    :param splits: how its light is split, see :mod:`random_media`.
    """
    build_media()
    pictures, problems = {}, []
    for seed, (way, prepare) in enumerate(PREPARE.items()):
        result = prepare()
        if way == NATIVE and not can_be_native(result):
            continue
        problems = problems or [str(problem) for problem in result.problems]
        if splits == SPLITS_BY_CYCLES:
            bpy.context.scene.render.use_motion_blur = False
            if way != ASKED:
                nd.analyse(bpy.context.scene)
        pictures[way] = take(seed, samples)
    return pictures, problems


def in_glass(build_glass: Callable[[], object], samples: int = SAMPLES) -> Picture:
    """Build the same bodies of Cycles' own Glass and render them, each surface as if nothing else were there."""
    build_glass()
    return take(10, samples)


def chances(pictures: dict[str, Picture], reference: str, ways: tuple[str, ...] = OURS) -> dict[str, float]:
    """Return for each way the chance that it differs as much from the reference if both show the same."""
    return {
        way: chance_of_same_picture(pictures[way].batches, pictures[reference].batches, TILE)
        for way in ways
        if way in pictures and way != reference
    }


def measured(description: RandomScene, samples: int = SAMPLES) -> dict:
    """Return what all ways say of a random scene, with Cycles' own Glass on the same bodies beside them."""
    pictures, problems = by_all_ways(lambda: build(description), samples, description.splits)
    compared = dict(pictures)
    if description.splits == SPLITS_BY_TIME:
        compared.pop(NATIVE, None)  # Cycles' own dispersion has other curves and no unclamped tables of ours
    visible = visible_difference(pictures[CUT].batches, pictures[ASKED].batches, TILE)
    pictures[GLASS] = in_glass(lambda: build(description, glass=True), samples)
    return facts(description) | {
        "ways": {way: picture.numbers() for way, picture in pictures.items()},
        "chances": chances(compared, ASKED),
        "visible": float(np.median(visible)),
        "problems": problems,
    }


def measured_split(description: RandomScene, build_split: Callable[[RandomScene], list[str]], samples: int) -> dict:
    """Return what all ways say of a random scene beside its interfaces, split by hand.

    :param build_split: builds those and returns what is wrong with them.
    """
    pictures, _ = by_all_ways(lambda: build(description), samples)
    pictures[GLASS] = in_glass(lambda: build(description, glass=True), samples)
    wrong = build_split(description)
    pictures[SPLIT] = take(11, samples)
    visible = visible_difference(pictures[CUT].batches, pictures[SPLIT].batches, TILE)
    return facts(description) | {
        "ways": {way: picture.numbers() for way, picture in pictures.items()},
        "chances": chances(pictures, SPLIT),
        "naive": chances(pictures, SPLIT, (GLASS,))[GLASS],
        "visible": float(np.median(visible)),
        "wrong pieces": wrong,
    }


def against(
    reference: Picture, build_media: Callable[[], object], build_glass: Callable[[], object] | None = None
) -> dict:
    """Return what all ways say of a scene beside a picture that it should be, and beside Cycles' own Glass."""
    pictures, _ = by_all_ways(build_media, MANY)
    if build_glass is not None:
        pictures[GLASS] = in_glass(build_glass, MANY)
    pictures[REFERENCE] = reference
    visible = visible_difference(pictures[ASKED].batches, reference.batches, TILE)
    return {
        "rough": False,
        "splits": "",
        "ways": {way: picture.numbers() for way, picture in pictures.items()},
        "chances": chances(pictures, REFERENCE),
        "naive": chances(pictures, REFERENCE, (GLASS,)).get(GLASS),
        "visible": float(np.median(visible)),
    }


def facts(description: RandomScene) -> dict:
    """Return what kind of scene it is."""
    return {
        "seed": description.seed,
        "arrangement": description.arrangement,
        "media": len(description.media),
        "bodies": len(description.bodies),
        "rough": description.rough,
        "splits": description.splits,
        "inside": description.camera_inside,
    }


def faults(found: dict, rate: float) -> list[str]:
    """Return what is wrong with a scene's numbers.

    :param rate: least chance of a difference that is taken for noise.
    """
    # Single samples of rough lobes weigh more than 1, and so do single wavelengths in one channel, which may be negative.
    sharp = not found["rough"] and not found["splits"]
    wrong = []
    for way, numbers in found["ways"].items():
        if way not in OURS:
            continue
        if numbers["broken"]:
            wrong.append(f"{way}: {numbers['broken']} parts of pixels are no light")
        if not found["splits"] and numbers["lowest"] < 0.0:
            wrong.append(f"{way}: {numbers['lowest']:.6f}, less than no light")
        if sharp and numbers["highest"] > 1.0 + ROUNDING:
            wrong.append(f"{way}: {numbers['highest']:.6f} in a white world")
        if numbers["mean"] > 5.0 * numbers["error"] + ROUNDING + (FIT if found["rough"] else 0.0):
            wrong.append(f"{way}: makes {numbers['mean']:.2e} of light")
    wrong += [f"{way} differs (chance {chance:.1g})" for way, chance in found["chances"].items() if chance < rate]
    return wrong
