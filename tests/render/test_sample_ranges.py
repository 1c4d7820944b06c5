"""Ranges of a picture's samples are parts that Cycles' own merging puts together to that picture."""

import bpy
import numpy as np
import pytest
from disk import OLD, full_disk, names
from scenes import add_sphere, oiio, read_picture
from stripes import stripes, with_passes

import nested_dielectric as nd
from nested_dielectric.model.files import WriteError
from nested_dielectric.scene.rendering import RenderError, render_frame
from nested_dielectric.scene.sample_ranges import rendering_part

ROUNDING = 1e-6
"""Sums of 32-bit floats in another order, of pixels up to 1."""


def glass(samples: int = 10) -> bpy.types.Scene:
    scene = stripes(24)
    add_sphere("Glass", 1.0, nd.new_material("Glass", preset="glass"))
    nd.prepare(scene)
    scene.cycles.samples = samples
    return scene


def layers_of(path) -> dict[str, np.ndarray]:
    """Read the passes of an OpenEXR file by the names of their layers; each (height, width, channels)."""
    buffer = oiio.ImageBuf(str(path))
    pixels = np.array(buffer.get_pixels(oiio.FLOAT))
    places: dict[str, list[int]] = {}
    for place, channel in enumerate(buffer.spec().channelnames):
        places.setdefault(channel.rpartition(".")[0], []).append(place)
    return {name: pixels[..., channels] for name, channels in places.items()}


def merged(folder, *parts) -> str:
    """Merge two files as an artist would."""
    path = str(folder / "merged.exr")
    bpy.ops.cycles.merge_images(input_filepath1=str(parts[0]), input_filepath2=str(parts[1]), output_filepath=path)
    return path


def test_parts_of_different_length_merge_to_the_picture_in_one_go(tmp_path):
    scene = glass()
    scene.view_layers[0].use_pass_normal = True
    for samples in (range(3), range(3, 10), range(10)):
        render_frame(scene, tmp_path / f"{samples.start}_{samples.stop}.exr", samples)
    both = layers_of(merged(tmp_path, tmp_path / "0_3.exr", tmp_path / "3_10.exr"))
    whole = layers_of(tmp_path / "0_10.exr")
    assert set(both) == set(whole) >= {"ViewLayer.Combined", "ViewLayer.Normal"}
    for name, picture in whole.items():
        np.testing.assert_allclose(both[name], picture, atol=ROUNDING)
    render_frame(scene, tmp_path / "plain.exr")
    np.testing.assert_array_equal(whole["ViewLayer.Combined"][..., :3], read_picture(tmp_path / "plain.exr"))
    part = layers_of(tmp_path / "0_3.exr")["ViewLayer.Combined"]
    assert np.abs(part - whole["ViewLayer.Combined"]).max() > 0.01  # or the parts would not matter


def test_a_part_is_neither_denoised_nor_adaptive_and_holds_what_denoising_needs(tmp_path):
    scene = glass(8)
    render_frame(scene, tmp_path / "plain.exr", range(4))
    scene.cycles.use_adaptive_sampling, scene.cycles.adaptive_threshold = True, 1.0
    scene.cycles.use_denoising = True
    scene.cycles.time_limit = 100.0
    settings = scene.render.image_settings
    settings.color_depth, settings.exr_codec = "16", "DWAA"
    before = state(scene)
    render_frame(scene, tmp_path / "part.exr", range(4))
    assert state(scene) == before
    part, plain = layers_of(tmp_path / "part.exr"), layers_of(tmp_path / "plain.exr")
    np.testing.assert_array_equal(part["ViewLayer.Combined"], plain["ViewLayer.Combined"])
    assert {"ViewLayer.Denoising Albedo", "ViewLayer.Denoising Normal"} <= set(part)
    assert set(plain) == {"ViewLayer.Combined"}


def state(scene: bpy.types.Scene) -> list:
    """What a render of a part changes meanwhile."""
    cycles, settings = scene.cycles, scene.render.image_settings
    return [
        *(getattr(cycles, name) for name in ("use_adaptive_sampling", "use_denoising", "time_limit", "samples")),
        *(getattr(cycles, name) for name in ("use_sample_subset", "sample_offset", "sample_subset_length")),
        *(getattr(settings, name) for name in ("media_type", "file_format", "color_depth", "exr_codec")),
        settings.use_exr_interleave,
        scene.view_layers[0].cycles.denoising_store_passes,
    ]


@pytest.mark.parametrize(
    "change, samples, name, words",
    [
        (lambda scene: None, range(4, 11), "x.exr", "samples 4:11: scene 'Scene' has 10, so name a range within 0:10"),
        (lambda scene: None, range(4), "x.png", "x.png: a range of samples is kept in OpenEXR alone"),
        (lambda scene: setattr(scene.render, "engine", "BLENDER_EEVEE"), range(4), "x.exr", "with Cycles"),
        (lambda scene: setattr(scene.view_layers[0], "samples", 4), range(4), "x.exr", "'ViewLayer'"),
    ],
)
def test_what_is_no_part_of_a_picture_is_named_before_the_work(change, samples, name, words, tmp_path):
    scene = stripes()
    scene.cycles.samples = 10
    change(scene)
    with pytest.raises(RenderError) as caught:
        render_frame(scene, tmp_path / name, samples)
    assert words in str(caught.value) and not names(tmp_path)


def test_a_compositor_is_not_let_loose_on_parts(tmp_path):
    scene = stripes()
    scene.cycles.samples = 4
    with_passes(tmp_path, scene)
    with pytest.raises(RenderError, match="compositor, which would work on each range"):
        render_frame(scene, tmp_path / "x.exr", range(2))
    scene.render.use_compositing = False
    render_frame(scene, tmp_path / "x.exr", range(2))
    assert names(tmp_path) == ["x.exr"]


def test_a_part_for_which_the_disk_is_too_full_leaves_the_old_file(tmp_path):
    scene = glass()
    render_frame(scene, tmp_path / "x.exr", range(2))
    size = (tmp_path / "x.exr").stat().st_size
    (tmp_path / "x.exr").write_bytes(OLD)
    with full_disk(size - 100), pytest.raises((WriteError, RenderError), match=r"x\.exr: was not written"):
        render_frame(scene, tmp_path / "x.exr", range(2))
    assert names(tmp_path) == ["x.exr"] and (tmp_path / "x.exr").read_bytes() == OLD


def test_cycles_says_of_a_part_that_it_holds_all_samples_and_merges_of_files_in_parts_the_first(tmp_path):
    """Why parts are told what they hold, and are written in one part with all layers."""
    scene = stripes(8)
    scene.cycles.samples = 4
    scene.view_layers[0].use_pass_normal = True
    for interleave in (True, False):
        for samples in (range(1), range(1, 4)):
            with rendering_part(scene, samples):
                scene.render.image_settings.use_exr_interleave = interleave
                scene.render.filepath = str(tmp_path / f"{samples.start}.exr")
                bpy.ops.render.render(write_still=True)
            spec = oiio.ImageBuf(scene.render.filepath).spec()
            assert spec.getattribute("cycles.ViewLayer.samples") == "4"
        layers = layers_of(merged(tmp_path, tmp_path / "0.exr", tmp_path / "1.exr"))
        assert ("ViewLayer.Normal" in layers) == interleave


def test_parts_of_several_view_layers_are_told_what_they_hold(tmp_path):
    scene = stripes(8)
    scene.cycles.samples = 4
    scene.view_layers.new("Second.samples")
    render_frame(scene, tmp_path / "x.exr", range(1, 4))
    spec = oiio.ImageBuf(str(tmp_path / "x.exr")).spec()
    counts = [
        each.value for each in spec.extra_attribs if each.name.startswith("cycles.") and each.name.endswith(".samples")
    ]
    assert counts == ["3", "3"]
