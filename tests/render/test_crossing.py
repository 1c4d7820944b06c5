"""What one Blender saves another renders right, and both show the same pictures."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from crossing import BATCHES, SAMPLES, SCENES
from scenes import SUBPIXELS, read_picture, split_into_batches
from significance import assert_same_picture

OTHER = os.environ.get("ND_OTHER_BLENDER", "")
HERE = Path(__file__).parents[1] / "helpers"

pytestmark = [
    pytest.mark.crossing,
    pytest.mark.skipif(not OTHER, reason="ND_OTHER_BLENDER names no second Blender; make test-lts does"),
]


def run(python: str, script: str, *arguments: object) -> subprocess.Popen:
    return subprocess.Popen(
        [python, str(HERE / script), *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )


def finish(*processes: subprocess.Popen) -> None:
    for process in processes:
        output, _ = process.communicate()
        assert process.returncode == 0, output[-3000:]


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """Pictures by scene, by the Blender that saved it and by the one that rendered it."""
    folder = tmp_path_factory.mktemp("crossing")
    blenders = {"this": sys.executable, "other": OTHER}
    finish(*(run(python, "crossing.py", folder / name) for name, python in blenders.items()))
    crossed = {("this", "other"): OTHER, ("other", "this"): sys.executable}
    for saved, rendered in crossed:
        (folder / saved / rendered).mkdir()
    files = {name: [folder / name / f"{scene}.blend" for scene in SCENES] for name in blenders}
    finish(
        *(
            run(python, "farm.py", SAMPLES // SUBPIXELS**2, 100 * SUBPIXELS, folder / saved / rendered, *files[saved])
            for (saved, rendered), python in crossed.items()
        )
    )

    def read(scene: str, saved: str, rendered: str) -> np.ndarray:
        if saved == rendered:
            return np.load(folder / saved / f"{scene}.npy")
        return split_into_batches(read_picture(folder / saved / rendered / f"{scene}.exr"), BATCHES)

    return read


@pytest.mark.parametrize("scene", SCENES)
def test_both_blenders_show_the_same_picture(pictures, scene):
    # Blender 5.2 stretches refraction by turned normals, which send 0.6 % less light through these two balls.
    bias = 1e-2 if scene == "anisotropic" else 0.0
    assert_same(pictures(scene, "this", "this"), pictures(scene, "other", "other"), bias)


@pytest.mark.parametrize("saved, rendered", [("this", "other"), ("other", "this")])
@pytest.mark.parametrize("scene", SCENES)
def test_a_file_from_one_blender_is_right_in_the_other_without_the_extension(pictures, scene, saved, rendered):
    assert_same(pictures(scene, saved, rendered), pictures(scene, rendered, rendered))


def assert_same(one: np.ndarray, other: np.ndarray, bias: float = 0.0) -> None:
    assert other.mean() > 0.01
    assert_same_picture(one, other, size=8, bias=bias)
