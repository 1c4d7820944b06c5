"""A process that is killed while it writes leaves every file whole: as it was before, or as it was to be."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import bpy
import pytest

from nested_dielectric.model.files import MARK
from nested_dielectric.model.presets import load_preset, preset_names
from nested_dielectric.scene import preset_library
from nested_dielectric.scene.output import check_picture

KILLS = 20 if "ND_STRESS" in os.environ else 2
WRITER = Path(__file__).parents[1] / "helpers" / "writer.py"


def write_and_die(folder: Path, chance: random.Random) -> str:
    """Let a process write until it is killed at a random moment after its first round; return what it was writing."""
    process = subprocess.Popen(
        [sys.executable, str(WRITER), str(folder)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
    )
    rounds = chance.randrange(1, 3)
    writing = ""
    wanted = chance.randrange(1, 6)
    for line in process.stdout:
        rounds -= line == "round\n"
        if rounds <= 0 and line.startswith("writes"):
            writing = line
            wanted -= 1
            if wanted <= 0:
                break
    time.sleep(chance.uniform(0.0, 0.05))
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert process.returncode == -signal.SIGKILL, "the writer ended by itself"
    return writing


def assert_whole(folder: Path, monkeypatch) -> None:
    """Every file by its own name can be read, and a preset that is half written is none."""
    for name in ("saved", "copy"):
        bpy.ops.wm.open_mainfile(filepath=str(folder / f"{name}.blend"))
        assert {"Glass", "Water", "Camera"} <= set(bpy.data.objects.keys())
        assert all(not obj.hide_viewport for obj in bpy.data.objects if "nd_cut_of" not in obj)
    check_picture(folder / "table.exr", "table", channels=4)
    check_picture(folder / "picture.png", "picture", (64, 64))
    assert load_preset("mine", folder / "presets").name == "Mine"
    monkeypatch.setattr(preset_library, "user_folder", lambda: folder / "presets")
    assert preset_library.catalogue().own == {"mine"} and preset_library.catalogue().problems == ()
    ours = {"saved.blend", "saved.blend1", "copy.blend", "copy.blend1", "presets", "table.exr", "picture.png"}
    others = {path.name for path in folder.iterdir()} - ours
    assert [name for name in others if not name.startswith(MARK) and name != "saved.blend@"] == []


@pytest.mark.always
@pytest.mark.parametrize("seed", range(KILLS))
def test_files_are_whole_whenever_the_process_is_killed(seed, tmp_path, monkeypatch):
    chance = random.Random(seed)
    writing = write_and_die(tmp_path, chance)
    try:
        assert_whole(tmp_path, monkeypatch)
    except Exception as error:
        raise AssertionError(f"killed as it {writing}") from error


@pytest.mark.always
def test_what_a_killed_process_left_of_a_preset_is_none(tmp_path):
    """The longest-lived trace of a process that was killed."""
    (tmp_path / f"{MARK}abc.toml").write_text('name = "Ha', encoding="utf-8")
    assert preset_names(tmp_path) == ()
