"""The examples: scripts that users copy from, run as users run them, and small."""

import csv
import json
import subprocess
import sys
from math import tau
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils.bvhtree import BVHTree
from scenes import mostly_again, read_picture

import nested_dielectric as nd
from nested_dielectric.checking.kinds import Severity

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
DESCRIPTIONS = sorted(path.name for path in EXAMPLES.glob("*.json"))
TUMBLER = json.loads((EXAMPLES / "tumbler.json").read_text())


def run(script: str, *arguments: object) -> subprocess.CompletedProcess:
    command = [sys.executable, EXAMPLES / script, *arguments]
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)


@pytest.fixture
def shots(monkeypatch):
    """The script of product shots as a module, which others that are called like its neighbours do not see."""
    monkeypatch.syspath_prepend(str(EXAMPLES))
    import product_shot

    yield product_shot
    for name, module in list(sys.modules.items()):
        if EXAMPLES in Path(getattr(module, "__file__", None) or "/").parents:
            del sys.modules[name]


def changed(**changes: object) -> dict:
    """The tumbler's description with other values; a name of two words is that of a key within a key."""
    description = json.loads(json.dumps(TUMBLER))
    for name, value in changes.items():
        first, _, second = name.partition("_of_")
        if second:
            description[second][first] = value
        else:
            description[first] = value
    return description


def read(shots, folder: Path, description: object):
    file = folder / "shot.json"
    file.write_text(description if isinstance(description, str) else json.dumps(description))
    return shots.read_shot(file, nd.preset_names())


@pytest.mark.parametrize("name", mostly_again(DESCRIPTIONS))
def test_every_description_makes_a_scene_with_which_nothing_is_wrong(shots, name):
    scene = shots.prepared(shots.build(shots.read_shot(EXAMPLES / name, nd.preset_names())))
    assert [str(found) for found in nd.check(scene) if found.severity != Severity.NOTE] == []
    assert nd.get_priority(scene.objects["Vessel"]) < nd.get_priority(scene.objects["Liquid 1"])


def test_ice_floats_in_the_drink_and_keeps_off_the_glass_and_itself(shots):
    scene = shots.build(shots.read_shot(EXAMPLES / "tumbler.json", nd.preset_names()))
    bpy.context.view_layer.update()
    trees = {}
    for obj in scene.objects:
        if obj.type == "MESH":
            corners = [obj.matrix_world @ vertex.co for vertex in obj.data.vertices]
            trees[obj.name] = BVHTree.FromPolygons(corners, [tuple(face.vertices) for face in obj.data.polygons])
    cubes = [name for name in trees if name.startswith("Ice")]
    assert len(cubes) == TUMBLER["ice"]["count"]
    meets = {name: {other for other in trees if other != name and trees[name].overlap(trees[other])} for name in cubes}
    assert all(met <= {"Liquid 1"} for met in meets.values()), meets
    assert sum(met == {"Liquid 1"} for met in meets.values()) >= 2
    assert trees["Liquid 1"].overlap(trees["Vessel"])


def test_colours_and_depths_of_descriptions_are_those_of_presets(shots, tmp_path):
    """The manual's table says of red wine: 0.17, 1e-05, 2.4e-06 at 7 cm."""
    own = {"preset": "water", "colour": [0.17, 1e-5, 2.4e-6], "depth": 70, "level": 0.5}
    shots.build(read(shots, tmp_path, changed(liquids=[{"preset": "wine_red", "level": 0.3}, own], count_of_ice=0)))
    inputs = [bpy.data.materials[f"Liquid {number}"].node_tree.nodes["Nested Dielectric"].inputs for number in (1, 2)]
    preset, ours = (
        [*each["Transmittance"].default_value[:3], each["Transmittance Depth"].default_value] for each in inputs
    )
    assert ours == pytest.approx(preset, rel=0.03)  # the table has two digits


@pytest.mark.parametrize(
    "description, words",
    [
        (changed(radius_of_vessel=4), ["vessel.radius", "unknown", "preset, outside, inside"]),
        (changed(vessel={"radius": 40}), ["vessel.height", "missing"]),
        (changed(vessel={"radius": 2, "height": 40, "wall": 3}), ["vessel", "wall 3", "radius of 2"]),
        (changed(preset_of_vessel="glas"), ["vessel.preset", "'glas'", "glass"]),
        (changed(outside_of_vessel=[[0, 0], [1, 2]]), ["vessel.outside", "3 or more"]),
        (changed(inside_of_vessel=[[0, 9], [1, 2, 3, 4], [5, 6]]), ["vessel.inside[1]", "[radius, height]"]),
        (changed(inside_of_vessel=[[0, 9], [30, 5], [30, 90]]), ["vessel.inside", "must not fall"]),
        (changed(liquids=[{"level": 1.5}]), ["liquids[0].level", "1.5", "0.02 to 0.96"]),
        (changed(liquids=[{"level": 0.5}, {"level": 0.3}]), ["liquids", "must rise"]),
        (changed(liquids=[{"level": 0.5, "colour": [1, 0.5, 0]}]), ["liquids[0].colour", "depth"]),
        (changed(liquids=[{"level": 0.5, "colour": "red"}]), ["liquids[0].colour", "list of 3 numbers"]),
        (changed(liquids=[{"level": True}]), ["liquids[0].level", "number from"]),
        (changed(liquids=[]), ["ice.count", "liquids"]),
        (changed(count_of_ice=2.5), ["ice.count", "whole number from 0 to 30"]),
        (changed(frames_of_camera=0), ["camera.frames", "1 to 10000"]),
        (changed(resolution_of_render=[640]), ["render.resolution", "list of 2"]),
        (changed(glow_of_light=float("nan")), ["light.glow", "0 to 20"]),
        (changed(cameras={}), ["cameras", "unknown", "vessel, liquids, ice, camera, light, render"]),
        ([], ["must be an object with vessel"]),
        ('{"vessel": }', ["line 1", "no JSON"]),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) and value and isinstance(value[0], str) else "",
)
def test_a_wrong_description_is_refused_with_its_key_and_what_is_allowed(shots, tmp_path, description, words):
    with pytest.raises(shots.DescriptionError) as caught:
        read(shots, tmp_path, description)
    text = str(caught.value)
    assert text.startswith(str(tmp_path / "shot.json")) and "\n" not in text
    assert all(word in text for word in words), text


def test_a_description_that_is_no_text_is_refused(shots, tmp_path):
    (tmp_path / "shot.json").write_bytes(b"\xff{}")
    with pytest.raises(shots.DescriptionError, match="no text in UTF-8"):
        shots.read_shot(tmp_path / "shot.json", nd.preset_names())


def test_ice_that_does_not_fit_and_walls_that_cross_are_refused_before_anything_is_rendered(shots, tmp_path):
    shot = read(shots, tmp_path, changed(ice={"count": 9, "size": 30}))
    with pytest.raises(shots.DescriptionError, match=r"ice\.count: 9 cubes of 30 mm do not fit .* \d do"):
        shots.ice_places(shots.rounded(shot.vessel.inside), 85.0, shot.ice)
    wide = [[0, 13], [50, 14, 7], [40, 104, 1]]
    with pytest.raises(shots.DescriptionError, match="'Vessel'"):
        shots.prepared(shots.build(read(shots, tmp_path, changed(inside_of_vessel=wide, count_of_ice=0, liquids=[]))))


def test_a_wrong_description_ends_with_2_and_one_line_and_leaves_nothing(tmp_path):
    (tmp_path / "shot.json").write_text(json.dumps(changed(frames_of_camera=0)))
    done = run(
        "product_shot.py", tmp_path / "shot.json", "-o", tmp_path / "out" / "#.png", "--save", tmp_path / "a.blend"
    )
    assert done.returncode == 2 and [path.name for path in tmp_path.iterdir()] == ["shot.json"]
    assert len(done.stderr.strip().splitlines()) == 1 and "camera.frames" in done.stderr


@pytest.mark.parametrize(
    "option, name, words",
    [
        ("--save", "scene.txt", "scene.txt: must end in .blend"),
        ("--save", "shot.json/scene.blend", "cannot be written"),
        ("-o", "shot.json/#.png", "cannot be written"),
    ],
)
def test_places_that_cannot_be_written_are_named_before_anything_is_built(
    shots, tmp_path, monkeypatch, capsys, option, name, words
):
    file = tmp_path / "shot.json"
    file.write_bytes(b"\xef\xbb\xbf" + json.dumps(TUMBLER).encode())  # as Windows marks UTF-8
    monkeypatch.setattr(sys, "argv", ["product_shot.py", str(file), option, str(tmp_path / name)])
    monkeypatch.setattr(shots, "build", lambda shot: pytest.fail("something was built"))
    with pytest.raises(SystemExit) as ended:
        shots.main()
    assert ended.value.code == 2 and words in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["shot.json"]


def test_a_turntable_is_rendered_and_its_scene_kept(tmp_path):
    pictures, file = tmp_path / "out" / "shot_##.png", tmp_path / "new" / "shot.blend"
    small = ("--percentage", 5, "--samples", 2, "--frames", "1-2")
    done = run("product_shot.py", EXAMPLES / "tumbler.json", "-o", pictures, "--save", file, *small)
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in pictures.parent.iterdir()) == ["shot_01.png", "shot_02.png"]
    first, second = (read_picture(pictures.parent / f"shot_0{frame}.png") for frame in (1, 2))
    assert first.shape == (45, 36, 3) and first.std() > 0.05
    # The backdrop turns with the camera, so that the ice alone looks other than before.
    assert abs(first - second).mean() > 0.001 and abs(first - second)[:8].mean() < 0.01

    bpy.ops.wm.open_mainfile(filepath=str(file))
    scene = bpy.context.scene
    assert (scene.frame_start, scene.frame_end) == (1, 48)
    scene.frame_set(13)
    assert scene.objects["Studio"].rotation_euler.z == pytest.approx(tau / 4)


def test_twenty_variants_have_their_colours_and_darken_as_the_glass_fills(tmp_path):
    done = run("variants.py", "-o", tmp_path / "all", "--percentage", 20, "--samples", 4)
    assert done.returncode == 0, done.stderr
    with open(tmp_path / "all" / "variants.csv", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    pictures = {(row["colour"], float(row["level"])): read_picture(tmp_path / "all" / row["file"]) for row in table}
    colours, levels = ([*dict.fromkeys(key[part] for key in pictures)] for part in (0, 1))
    assert len(table) == len(pictures) == 20 and len(colours) == 5 and levels == sorted(levels)
    assert read_picture(tmp_path / "all" / "sheet.png").shape == (4 * 40, 5 * 32, 3)
    darkest = {"lemon": 2, "orange": 2, "raspberry": 1, "mint": 0, "blueberry": 0}
    for colour in colours:
        means = [pictures[colour, level].mean(axis=(0, 1)) for level in levels]
        assert np.all(np.diff([mean[darkest[colour]] for mean in means]) < 0), (colour, means)
        middle = pictures[colour, levels[-1]][15:25, 13:19].mean(axis=(0, 1))
        assert middle.argmin() == darkest[colour], (colour, middle)
