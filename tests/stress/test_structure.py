"""Media look the same however they come into being: instances, links, keys, bones, adaptive subdivision, motion."""

import functools
import time

import bpy  # before numpy's users
import numpy as np
import pytest
from random_bodies import stage
from scenes import add_box, cycles_glass, rarely
from significance import chance_of_same_picture, stress_rate
from structures import BY, GLASS, WATER, beside_a_block, by_mesh, droplets
from ways import ASKED, MANY, NATIVE, PREPARE, TILE, TOLD, Picture, against, asked, can_be_native, chances, faults, take
from ways import told as tell

import nested_dielectric as nd

SIDES = (10, 47)
"""Of cubes of droplets: a thousand and 103,823."""

FEW = 2
"""Samples of each part of a pixel where paths meet dozens of droplets."""


@pytest.mark.parametrize("how", ["nodes", "vertices"])
@pytest.mark.parametrize("side", rarely(SIDES))
def test_a_hundred_thousand_instances_look_as_split_by_hand(side, how, record):
    """Droplets of glass in water, and beside them droplets of the ratio of both."""

    def timed(do) -> float:
        start = time.process_time()
        do()
        return time.process_time() - start

    samples = MANY if side == min(SIDES) else FEW
    droplets(side, nested=False, how=how)
    pictures = {}
    seconds = {"split": timed(lambda: pictures.update(split=take(21, samples)))}
    droplets(side, nested=True, how=how)
    seconds["prepare"] = timed(tell)
    seconds["told"] = timed(lambda: pictures.update(told=take(22, samples)))
    nd.clear_analysis(bpy.context.scene)
    seconds["asked"] = timed(lambda: pictures.update(asked=take(23, samples)))
    found = {
        "rough": False,
        "splits": "",
        "ways": {way: picture.numbers() for way, picture in pictures.items()},
        "chances": chances(pictures, "split", (TOLD, ASKED)),
    }
    record("instances", f"{side**3} by {how}", seconds=seconds, **found)
    assert faults(found, stress_rate()) == []


@functools.cache
def egg_across_a_block() -> Picture:
    beside_a_block(by_mesh, None)
    asked()
    return take(20)


@pytest.mark.parametrize("way", rarely(BY, ("override",)))
def test_a_body_looks_the_same_however_it_comes_into_being(way, record, tmp_path):
    found = against(egg_across_a_block(), lambda: beside_a_block(BY[way], tmp_path))
    record("body", way, **found)
    assert faults(found, stress_rate()) == []


def subdivided(kind: str) -> None:
    """A block that Cycles dices into a ball as it renders, with one that it does not in it.

    :param kind: "nested", of our media; "split" by hand and "naive" in Cycles' own Glass.
    """
    stage()
    if kind == "nested":
        water, glass = nd.new_material("Water", ior=WATER, priority=1), nd.new_material("Glass", ior=GLASS, priority=0)
    else:
        water, glass = cycles_glass(WATER), cycles_glass(GLASS / WATER if kind == "split" else GLASS)
    cube = add_box("Ball", (-1.0, -1.0, -1.0), (1.0, 1.0, 1.0), water)
    cube.rotation_euler = (0.2, 0.1, 0.3)
    subdivision = cube.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels = subdivision.render_levels = 3
    subdivision.use_adaptive_subdivision = True
    for face in cube.data.polygons:
        face.use_smooth = True
    add_box("Block", (-0.3, -0.25, -0.3), (0.3, 0.35, 0.2), glass)
    bpy.context.view_layer.update()


def test_what_is_subdivided_as_it_is_rendered_looks_as_split_by_hand(record):
    subdivided("split")
    split = take(20)
    found = against(split, lambda: subdivided("nested"), lambda: subdivided("naive"))
    record("body", "adaptive subdivision", **found)
    assert faults(found, stress_rate()) == []


INSTANTS = 8


def moving(amount: float | None) -> None:
    """An egg that passes through a block: at one instant, or over a frame."""
    beside_a_block(by_mesh, None)
    scene, obj = bpy.context.scene, bpy.data.objects["Egg"]
    if amount is not None:
        obj.location.x = 0.5 * amount
        return
    for frame in (0, 1, 2, 3):
        obj.location.x = 0.5 * (frame - 1)
        obj.keyframe_insert("location", frame=frame)
    for curve in obj.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    scene.frame_set(1)
    scene.render.use_motion_blur = True
    scene.render.motion_blur_position = "START"
    scene.render.motion_blur_shutter = 1.0


def test_media_in_motion_look_as_the_mean_of_stills(record):
    """Tiles are as wide as the way: they do not show that the stills are 8 alone."""
    stills = []
    for index in range(INSTANTS):
        moving((index + 0.5) / INSTANTS)
        asked()
        stills.append(take(100 + index).batches)
    batches = np.mean(stills, axis=0)
    pictures, chance = {}, {}
    moving(None)
    for seed, (way, prepare) in enumerate(PREPARE.items()):
        result = prepare()
        if way != NATIVE or can_be_native(result):
            pictures[way] = take(seed)
            chance[way] = chance_of_same_picture(pictures[way].batches, batches, TILE)
    found = {
        "rough": False,
        "splits": "",
        "ways": {way: picture.numbers() for way, picture in pictures.items()},
        "chances": chance,
    }
    record("body", "motion blur", **found)
    assert faults(found, stress_rate()) == []
