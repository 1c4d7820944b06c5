"""Parts of a picture, each with a range of its samples, merge to the picture in one go."""

from pathlib import Path

import bpy
import numpy as np
import pytest
from disk import OLD, full_disk, names
from layers import channels_of, coverage
from scenes import add_camera, add_plane, add_sphere, new_scene, set_striped_world

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.farm.layered_files import LayeredFileError
from nested_dielectric.farm.merging import MergeError, merge
from nested_dielectric.model.files import WriteError
from nested_dielectric.scene.output import save_blend
from nested_dielectric.scene.rendering import render_frame

SAMPLES = 16
RANGES = (range(3), range(3, 8), range(8, SAMPLES))

ROUNDING = 2 * SAMPLES * 2.0**-24
"""Relative error of both sums of so many 32-bit floats, at most, where all have one sign; measured: 9e-7 to 1.1e-6."""

SMALL = 1e-3
"""Part of a channel's largest value below which its error is taken as absolute: values may be differences of larger ones."""


def glass(disperse: bool = False) -> bpy.types.Scene:
    scene = new_scene(24, with_group=True)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    add_sphere("Glass", 1.0, nd.new_material("Glass", preset="bk7", disperse=disperse, roughness=0.1))
    scene.cycles.samples = SAMPLES
    return scene


def render_parts(scene: bpy.types.Scene, folder: Path, ranges=RANGES) -> list[Path]:
    return [render_frame(scene, folder / f"{each.start}-{each.stop}.exr", each) for each in ranges]


def assert_same_channels(found: dict[str, np.ndarray], wanted: dict[str, np.ndarray], bound: float) -> None:
    assert set(found) == set(wanted)
    for name, picture in wanted.items():
        scale = np.maximum(np.abs(picture), SMALL * np.abs(picture).max() + 1e-30)
        assert (np.abs(found[name].astype(float) - picture) / scale).max() < bound, name


@pytest.mark.parametrize("disperse", [False, True])
def test_a_picture_in_ranges_of_different_length_is_that_in_one_go(disperse, tmp_path):
    scene = glass(disperse)
    nd.prepare(scene)
    parts = render_parts(scene, tmp_path)
    assert merge(parts[::-1], tmp_path / "merged.exr") == range(SAMPLES)
    render_frame(scene, tmp_path / "whole.exr", range(SAMPLES))
    whole = channels_of(tmp_path / "whole.exr")
    assert_same_channels(channels_of(tmp_path / "merged.exr"), whole, ROUNDING)
    # The parts differ, or merging would prove nothing.
    assert np.abs(channels_of(parts[0])["ViewLayer.Combined.G"] - whole["ViewLayer.Combined.G"]).max() > 0.01


def test_what_is_merged_is_a_part_itself(tmp_path):
    scene = glass()
    nd.prepare(scene)
    first, second, third = render_parts(scene, tmp_path)
    assert merge([second, third], tmp_path / "later.exr") == range(3, SAMPLES)
    assert merge([tmp_path / "later.exr", first], tmp_path / "merged.exr") == range(SAMPLES)
    render_frame(scene, tmp_path / "whole.exr", range(SAMPLES))
    assert_same_channels(channels_of(tmp_path / "merged.exr"), channels_of(tmp_path / "whole.exr"), 2 * ROUNDING)


def with_all_passes(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Let a scene of two objects, one behind the other, write what Cycles' merging takes for pictures."""
    layer = scene.view_layers[0]
    for kind in ("z", "position", "object_index", "material_index", "normal", "cryptomatte_object"):
        setattr(layer, f"use_pass_{kind}", True)
    for kind in ("diffuse", "transmission"):
        for part in ("direct", "indirect", "color"):
            setattr(layer, f"use_pass_{kind}_{part}", True)
    wall = bpy.data.materials.new("Wall")
    wall.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.8, 0.1, 0.3, 1.0)
    add_plane("Wall", 3.0, (0.0, 2.0, 0.0), (0.3, -1.0, 0.2), wall)
    for number, ob in enumerate(scene.objects, 1):
        ob.pass_index = number
    return scene


def test_passes_of_a_merged_picture_are_those_in_one_go(tmp_path):
    """Of which Cycles' own merging halves some where two parts have as many samples."""
    import _cycles  # which is there once bpy is

    scene = with_all_passes(glass())
    nd.prepare(scene)
    halves = render_parts(scene, tmp_path, (range(8), range(8, SAMPLES)))
    merge(halves, tmp_path / "merged.exr")
    render_frame(scene, tmp_path / "whole.exr", range(SAMPLES))
    merged, whole = (channels_of(tmp_path / name) for name in ("merged.exr", "whole.exr"))
    assert set(merged) == set(whole)
    mattes = {name for name in whole if "Crypto" in name}
    covered = [coverage(found, "CryptoObject") for found in (merged, whole)]
    assert set(covered[0]) == set(covered[1]) and len(covered[0]) == 2
    for number, wanted in covered[1].items():
        np.testing.assert_allclose(covered[0][number], wanted, atol=ROUNDING)
    lights = {name for name in whole if "Direct" in name or "Indirect" in name}
    for name in lights:  # up to 1, or differences of what is; measured: 3e-7
        np.testing.assert_allclose(merged[name], whole[name], atol=ROUNDING)
    rest = set(whole) - mattes - lights
    assert_same_channels(*({name: found[name] for name in rest} for found in (merged, whole)), ROUNDING)
    _cycles.merge(input=[str(path) for path in halves], output=str(tmp_path / "cycles.exr"))
    cycles = channels_of(tmp_path / "cycles.exr")
    np.testing.assert_array_equal(cycles["ViewLayer.Combined.R"], merged["ViewLayer.Combined.R"])
    for name in ("ViewLayer.Position.Y", "ViewLayer.Object Index.X"):
        np.testing.assert_array_equal(2.0 * cycles[name], whole[name])  # should that fail, Cycles merges it itself


def test_a_picture_denoised_after_merging_is_that_denoised_in_one_go(tmp_path):
    scene = glass()
    scene.cycles.use_denoising = True
    nd.prepare(scene)
    parts = render_parts(scene, tmp_path)
    save_blend(tmp_path / "scene.blend")
    render_frame(scene, tmp_path / "whole.exr")
    arguments = [
        "merge",
        *parts,
        "-o",
        tmp_path / "merged.exr",
        "--denoise",
        tmp_path / "scene.blend",
        "--parts",
        "remove",
    ]
    assert cli.main(list(map(str, arguments))) == 0
    assert names(tmp_path) == ["merged.exr", "scene.blend", "whole.exr"]
    merged, whole = (channels_of(tmp_path / name) for name in ("merged.exr", "whole.exr"))
    for channel in "RGB":
        # A denoiser that is told of rounding passes it on; measured: 3e-6. Without denoising it is 0.1.
        np.testing.assert_allclose(merged[f"ViewLayer.Combined.{channel}"], whole[channel], atol=5e-5)
    assert not any("Vector" in name for name in merged)


@pytest.fixture(scope="module")
def parts(tmp_path_factory) -> Path:
    """A folder of parts: three of a picture, one of another frame, one of another size, one with another pass."""
    folder = tmp_path_factory.mktemp("parts")
    scene = glass()
    render_parts(scene, folder)
    render_frame(scene, folder / "frame.exr", RANGES[1], frame=2)
    render_frame(scene, folder / "picture.exr")
    scene.view_layers[0].use_pass_z = True
    render_frame(scene, folder / "pass.exr", RANGES[1])
    scene.render.resolution_x = 20
    render_frame(scene, folder / "size.exr", RANGES[1])
    return folder


@pytest.mark.parametrize(
    "chosen, words",
    [
        (["0-3"], "name two parts at least"),
        (["0-3", "8-16"], "samples 3:8 are missing"),
        (["0-3", "3-8", "0-3"], "0-3.exr holds, too; name each part once"),
        (["0-3", "frame"], "no part of the same picture"),
        (["0-3", "size"], "is of another size"),
        (["0-3", "pass"], "has other passes"),
        (["0-3", "picture"], "says not which samples it holds"),
        (["0-3", "none"], "none.exr: no such file"),
    ],
)
def test_what_is_no_part_of_a_picture_is_named_and_nothing_is_written(parts, chosen, words, tmp_path):
    (tmp_path / "out.exr").write_bytes(OLD)
    with pytest.raises(MergeError, match=words):
        merge([parts / f"{each}.exr" for each in chosen], tmp_path / "out.exr")
    assert names(tmp_path) == ["out.exr"] and (tmp_path / "out.exr").read_bytes() == OLD


@pytest.mark.parametrize("place", [-1, -3000, 500])
def test_a_part_that_is_not_whole_is_named(place, parts, tmp_path):
    """Where its end is missing, or something within it."""
    data = (parts / "3-8.exr").read_bytes()
    cut = tmp_path / "cut.exr"
    cut.write_bytes(data[:place] if place < 0 else data[:-place] + bytes(300) + data[-place + 300 :])
    with pytest.raises((MergeError, LayeredFileError), match=r"cut\.exr.*; render .*again"):
        merge([parts / "0-3.exr", cut], tmp_path / "out.exr")
    assert names(tmp_path) == ["cut.exr"]


def test_a_full_disk_leaves_what_was_there(parts, tmp_path):
    (tmp_path / "out.exr").write_bytes(OLD)
    with full_disk(1000), pytest.raises((MergeError, WriteError), match=r"out\.exr"):
        merge([parts / "0-3.exr", parts / "3-8.exr"], tmp_path / "out.exr")
    assert names(tmp_path) == ["out.exr"] and (tmp_path / "out.exr").read_bytes() == OLD


def test_frames_are_merged_each_from_its_parts_and_those_that_are_there_are_left(parts, tmp_path, capsys):
    for frame in ("0001", "0002"):
        for each in ("0-3", "3-8", "8-16"):
            (tmp_path / f"{frame}_{each}.exr").write_bytes((parts / f"{each}.exr").read_bytes())
    named = [tmp_path / f"####_{each}.exr" for each in ("0-3", "3-8", "8-16")]
    arguments = [*named, "-o", tmp_path / "####.exr", "--skip-existing", "--frames"]
    assert cli.main(["merge", *map(str, arguments), "1"]) == 0
    written = (tmp_path / "0001.exr").stat().st_mtime_ns
    assert cli.main(["merge", *map(str, arguments), "1-2", "--parts", "remove"]) == 0
    assert "0001.exr is there" in capsys.readouterr().out
    assert names(tmp_path) == ["0001.exr", "0002.exr"] and (tmp_path / "0001.exr").stat().st_mtime_ns == written
    assert cli.main(["merge", *map(str, named), "-o", "x.exr", "--frames", "1-2"]) == 1
    assert "put #### in its name" in capsys.readouterr().err


@pytest.mark.parametrize("skip", [(), ("--skip-existing",)])
def test_a_picture_never_takes_the_place_of_a_part_and_goes_with_it(skip, parts, tmp_path, capsys):
    paths = [tmp_path / "a.exr", tmp_path / "b.exr"]
    for path, each in zip(paths, ("0-3", "3-8")):
        path.write_bytes((parts / f"{each}.exr").read_bytes())
    before = paths[0].read_bytes()
    assert cli.main(["merge", *map(str, paths), "-o", str(paths[0]), "--parts", "remove", *skip]) == 1
    assert "is one of the parts" in capsys.readouterr().err
    assert names(tmp_path) == ["a.exr", "b.exr"] and paths[0].read_bytes() == before


@pytest.mark.parametrize("there", ["picture", "8-16", "size"])
def test_parts_are_not_removed_for_a_picture_that_is_not_theirs(there, parts, tmp_path):
    paths = [tmp_path / "a.exr", tmp_path / "b.exr"]
    for path, each in zip((*paths, tmp_path / "out.exr"), ("0-3", "3-8", there)):
        path.write_bytes((parts / f"{each}.exr").read_bytes())
    arguments = ["merge", *map(str, paths), "-o", str(tmp_path / "out.exr"), "--skip-existing", "--parts", "remove"]
    assert cli.main(arguments) == 0
    assert names(tmp_path) == ["out.exr"]
    merge([parts / "0-3.exr", parts / "3-8.exr"], tmp_path / "wanted.exr")
    assert_same_channels(channels_of(tmp_path / "out.exr"), channels_of(tmp_path / "wanted.exr"), ROUNDING)


def test_a_picture_that_was_denoised_is_not_merged_again(tmp_path):
    scene = glass()
    scene.cycles.use_denoising = True
    first, second, third = render_parts(scene, tmp_path)
    merge([first, second], tmp_path / "some.exr", (scene, scene.view_layers[0]))
    with pytest.raises(MergeError, match="is denoised, so that nothing can be added"):
        merge([tmp_path / "some.exr", third], tmp_path / "all.exr")
    assert not (tmp_path / "all.exr").exists()
