"""What a Blender application without OSL shows of iced water, where ND_BLENDER names one (real_blender.py)."""

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest
import real_blender
from scenes import SUBPIXELS, read_picture, split_into_batches
from significance import assert_same_picture

import nested_dielectric as nd
from nested_dielectric.demo import iced_water

SAMPLES, BATCHES = 256, 16
FILE = real_blender.EXCHANGE / "iced_water.blend"

pytestmark = pytest.mark.skipif(not real_blender.COMMAND, reason="ND_BLENDER names no Blender application")


@pytest.fixture(scope="module")
def file() -> Path:
    """Iced water that is cut, to be rendered by Cycles' own nodes."""
    if real_blender.version() != bpy.app.version[:2]:
        pytest.skip("the application is of another version")
    bpy.ops.wm.read_factory_settings()
    scene = iced_water.build_scene()
    bpy.context.window.scene = scene
    for screen in bpy.data.screens:
        for area in screen.areas:
            if area.type == "VIEW_3D":
                area.spaces.active.region_3d.view_perspective = "CAMERA"
    nd.prepare(scene, cut=True)
    scene.render.resolution_x = scene.render.resolution_y = 48
    scene.render.resolution_percentage = 100 * SUBPIXELS
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.shading_system = cycles.use_denoising = cycles.use_preview_denoising = cycles.use_guiding = False
    cycles.pixel_filter_type, cycles.samples = "BOX", SAMPLES // SUBPIXELS**2
    FILE.parent.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(FILE))
    return FILE


def test_an_application_without_osl_renders_what_the_wheel_does(file, tmp_path):
    farm = Path(__file__).parents[1] / "helpers" / "farm.py"
    arguments = [farm, SAMPLES // SUBPIXELS**2, 100 * SUBPIXELS, tmp_path, file]
    subprocess.run([sys.executable, *map(str, arguments)], check=True, capture_output=True)
    picture = file.with_suffix(".exr")
    real_blender.render(file, picture)
    ours, theirs = (read_picture(each) for each in (tmp_path / picture.name, picture))
    assert theirs.mean() > 0.05
    assert_same_picture(*(split_into_batches(each, BATCHES) for each in (ours, theirs)), size=8)


def is_alarm(picture: np.ndarray) -> np.ndarray:
    """Where a picture is magenta, as media that do not know what surrounds them."""
    red, green, blue = np.moveaxis(picture, -1, 0)
    return (np.minimum(red, blue) > 0.25) & (green < 0.4 * np.minimum(red, blue))


def test_a_window_without_osl_shows_media_that_cross(file):
    """The pictures are kept, to be looked at."""
    pictures = real_blender.photograph(file, real_blender.EXCHANGE / "iced_water")
    shown = {kind: read_picture(path) for kind, path in pictures.items()}
    for kind in ("MATERIAL", "RENDERED"):
        assert is_alarm(shown[kind]).mean() < 1e-4
        assert np.abs(shown[kind] - shown["SOLID"]).mean() > 0.02
