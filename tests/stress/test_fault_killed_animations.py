"""Frames that are rendered again and a process that is killed meanwhile: each file is whole, the old one or the new one."""

import random
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from disk import names
from scenes import mostly_again, oiio, write_picture
from stripes import stripes, with_writer

from nested_dielectric import cli
from nested_dielectric.model.files import MARK
from nested_dielectric.scene.output import check_picture, save_blend

KILLS = 20
FRAMES = 8
SIDE = 160
"""Pixels: writing takes a good part of a frame's time then."""

WAYS = {
    "whole": ("--scene", "Scene"),
    "part": ("--scene", "Plain", "--samples", "0:2"),
}


@pytest.fixture(scope="module")
def shot(tmp_path_factory):
    """A file with a scene whose compositor writes a file, too, and one without; and what each way writes of them."""
    folder = tmp_path_factory.mktemp("shot")
    scene = stripes(SIDE)
    scene.cycles.samples = 2
    plain = scene.copy()
    plain.name, plain.use_fake_user = "Plain", True
    with_writer(scene, "//passes/", "beauty_")
    save_blend(folder / "shot.blend")
    for way, arguments in WAYS.items():
        place = folder / way
        place.mkdir()
        shutil.copy(folder / "shot.blend", place)
        assert cli.main(command(place, arguments)[3:]) == 0
    return folder


def command(folder: Path, arguments) -> list[str]:
    file, output = str(folder / "shot.blend"), str(folder / "frame_##.exr")
    frames = ("--frames", f"1-{FRAMES}")
    return [sys.executable, "-m", "nested_dielectric", "render", file, "-o", output, *frames, *arguments]


def pixels(path: Path) -> list[np.ndarray]:
    """Read all channels of a picture that must be whole."""
    check_picture(path, path, (SIDE, SIDE))
    return list(oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT))


def put_old_files(new: Path, folder: Path) -> dict[str, bytes]:
    """Put a grey picture in the place of each that will be written; return what they hold by their names."""
    shutil.copy(new / "shot.blend", folder)
    old = {}
    for name in names(new):
        if name.endswith((".exr", ".png")):
            (folder / name).parent.mkdir(exist_ok=True)
            write_picture(folder / name, np.full((SIDE, SIDE, 3), 0.5))
            old[name] = (folder / name).read_bytes()
    return old


@pytest.mark.always
@pytest.mark.parametrize("seed", mostly_again(range(KILLS), 4))
def test_every_frame_is_whole_whenever_the_process_is_killed(seed, shot, tmp_path):
    way = list(WAYS)[seed % len(WAYS)]
    old = put_old_files(shot / way, tmp_path)
    assert len(old) == (2 * FRAMES if way == "whole" else FRAMES)
    process = subprocess.Popen(
        command(tmp_path, WAYS[way]), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    kill_at_random(process, random.Random(seed))
    replaced = [name for name in old if (tmp_path / name).read_bytes() != old[name]]
    for name in replaced:
        np.testing.assert_array_equal(pixels(tmp_path / name), pixels(shot / way / name))
    left = [name for name in names(tmp_path) if name not in old and name not in ("passes", "shot.blend")]
    assert all(any(part.startswith(MARK) for part in Path(name).parts) for name in left), left


def kill_at_random(process: subprocess.Popen, chance: random.Random) -> None:
    """Kill a process that renders after a random frame and a part of the time of one; it may just have ended."""
    wanted = chance.randrange(FRAMES)
    begun = time.perf_counter()
    seconds = 0.1
    for line in process.stdout:
        if line.startswith("nothing to change"):
            begun = time.perf_counter()
        elif line.startswith("frame "):
            seconds = time.perf_counter() - begun
            begun = time.perf_counter()
            wanted -= 1
        else:
            continue
        if wanted <= 0:
            break
    time.sleep(chance.uniform(0.0, seconds))
    process.kill()
    process.communicate()
