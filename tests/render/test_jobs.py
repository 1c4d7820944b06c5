"""Jobs of the Open Job Description give the pictures that one process does, whoever renders what, and after a kill."""

import os
import signal
import time
from pathlib import Path

import bpy
import numpy as np
import pytest
from jobs import Job, openjd
from layers import channels_of
from scenes import add_camera, add_plane, add_sphere, new_scene, read_picture, set_striped_world

import nested_dielectric as nd
from nested_dielectric import cli
from nested_dielectric.scene.output import save_blend

FRAMES = range(1, 7)


def save_scene(folder: Path, resolution: int = 24) -> Path:
    """Save a ball of glass that moves. It is the only object: the order of others may differ between processes."""
    scene = new_scene(resolution, with_group=True)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    ball = add_sphere("Glass", 0.8, nd.new_material("Glass", preset="bk7"))
    for frame, place in ((FRAMES[0], -0.3), (FRAMES[-1], 0.3)):
        ball.location.x = place
        ball.keyframe_insert("location", frame=frame)
    scene.frame_start, scene.frame_end = FRAMES[0], FRAMES[-1]
    scene.cycles.samples = 16
    return save_blend(folder / "ball.blend")


def submit(file: Path, folder: Path, *options: str) -> Path:
    assert cli.main(["submit", str(file), "--to", str(folder), *options]) == 0
    return folder


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("jobs")


@pytest.fixture(scope="module")
def bundle(folder) -> Path:
    """A job of whole frames, three a task."""
    return submit(save_scene(folder), folder / "frames", "--chunk", "3")


@pytest.fixture(scope="module")
def pictures(folder, bundle) -> dict[str, np.ndarray]:
    """What the command line renders of the file in one go, by the name of the file."""
    place = folder / "one go"
    assert cli.main(["render", str(folder / "ball.blend"), "-o", str(place / "ball_####.exr"), "--frames", "1-6"]) == 0
    return pictures_in(place)


def pictures_in(place: Path) -> dict[str, np.ndarray]:
    return {path.name: read_picture(path) for path in sorted(place.glob("*.exr")) if not path.name.startswith(".")}


def assert_same(found: dict[str, np.ndarray], wanted: dict[str, np.ndarray]) -> None:
    assert list(found) == list(wanted)
    for name, picture in wanted.items():
        np.testing.assert_array_equal(found[name], picture, err_msg=name)


def test_a_job_checks_and_renders_all_frames_as_one_process_does(bundle, pictures, tmp_path):
    assert openjd("check", bundle / "template.json").returncode == 0
    job = Job(bundle, tmp_path / "out" / "pictures")
    done = job.run("Render")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "nothing is wrong" in done.stdout
    assert len(job.running()) == 1 + 2  # the check, and two tasks of three frames
    assert_same(pictures_in(job.output), pictures)
    assert not np.array_equal(pictures["ball_0001.exr"], pictures["ball_0006.exr"])


def test_three_workers_at_once_give_the_same_pictures(bundle, pictures, tmp_path):
    job = Job(bundle, tmp_path / "pictures")
    workers = [job.start("Render", {"Frames": frames}) for frames in ("1,4", "2-3", "5-6")]
    texts = [worker.communicate()[0] for worker in workers]
    assert [worker.returncode for worker in workers] == [0, 0, 0], texts
    assert_same(pictures_in(job.output), pictures)


def test_a_task_that_is_killed_and_tried_again_gives_the_same_pictures(bundle, pictures, tmp_path):
    job = Job(bundle, tmp_path / "pictures")
    worker = job.start("Render", {"Frames": "1-6"})
    first = job.output / "ball_0001.exr"
    while not first.exists():
        assert worker.poll() is None, worker.communicate()[0]
        time.sleep(0.005)
    (process,) = job.running()
    os.killpg(os.getpgid(process), signal.SIGKILL)
    assert worker.wait() != 0
    worker.communicate()
    left = pictures_in(job.output)
    assert 1 <= len(left) < len(FRAMES)
    assert_same(left, {name: pictures[name] for name in left})
    written = first.stat().st_mtime_ns
    again = job.start("Render", {"Frames": "1-6"})
    text = again.communicate()[0]
    assert again.returncode == 0, text
    assert_same(pictures_in(job.output), pictures)
    assert first.stat().st_mtime_ns == written  # it was whole, and is not rendered again


def test_a_frame_in_ranges_of_samples_is_that_in_one_go(folder, bundle, tmp_path):
    bpy.ops.wm.open_mainfile(filepath=str(folder / "ball.blend"))
    bpy.context.scene.cycles.use_denoising = True
    file = save_blend(tmp_path / "ball.blend")
    ranges = submit(file, tmp_path / "ranges", "--ranges", "2", "--frames", "2", "--check", "none")
    assert openjd("check", ranges / "template.json").returncode == 0
    job = Job(ranges, tmp_path / "pictures")
    done = job.run("Merge")
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(job.running()) == 2 + 1
    assert os.listdir(job.output) == ["ball_0002.exr"]  # and no parts
    whole = tmp_path / "whole.exr"
    assert cli.main(["render", str(file), "-o", str(whole), "--frame", "2"]) == 0
    merged, picture = channels_of(job.output / "ball_0002.exr"), channels_of(whole)
    for channel in "RGB":
        # Rounding of the sums, which the denoiser passes on; measured: 3e-6.
        np.testing.assert_allclose(merged[f"ViewLayer.Combined.{channel}"], picture[channel], atol=5e-5)


def test_frames_that_would_go_to_one_file_are_not_rendered(bundle, tmp_path):
    """A task of one frame alone could not tell."""
    job = Job(bundle, tmp_path / "out", OutputName="ball.png")
    output, _ = job.start("Render", {"Frames": "1"}).communicate()
    assert "OutputName ball.png: all frames would go to one file" in output and "exited with code: 1" in output
    assert not job.output.exists()


def test_a_file_that_is_wrong_ends_at_the_check_and_nothing_is_rendered(tmp_path):
    scene = new_scene(8, with_group=True)
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    add_plane("Open", 1.0, (0, 0, 0), (0, -1, 0), nd.new_material("Glass", preset="bk7"))
    scene.frame_end = 1
    job = Job(submit(save_blend(tmp_path / "x.blend"), tmp_path / "job"), tmp_path / "out" / "pictures")
    done = job.run("Render")
    assert done.returncode != 0
    assert "exited with code: 3" in done.stdout and "'Open'" in done.stdout
    assert len(job.running()) == 1 and not job.output.exists()
