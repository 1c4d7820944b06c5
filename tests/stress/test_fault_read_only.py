"""Where nothing can be written, media render, and what cannot be saved says so.

The installation and the user's home are mounted read-only for a process of its own: to the superuser, who these tests may run
as, permissions are no hindrance.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from disk import full_disk, names

import nested_dielectric as nd
from nested_dielectric.model.files import MARK, WriteError
from nested_dielectric.model.presets import load_preset, renamed, save_preset
from nested_dielectric.model.shader_source import inlined_source
from nested_dielectric.nodes.compatibility import UnsupportedError
from nested_dielectric.nodes.osl import LIGHT_FILE, compiled
from nested_dielectric.scene.output import save_blend
from nested_dielectric.scene.preset_library import delete_user_preset

USER = Path(__file__).parents[1] / "helpers" / "farm_user.py"
NAMESPACE = ["unshare", "-m"] if hasattr(os, "geteuid") and os.geteuid() == 0 else ["unshare", "-Urm"]


def read_only(*places: Path) -> str:
    """A command of the shell that mounts folders read-only; what is mounted within them is, too."""
    mounts = (f"mount --rbind '{place}' '{place}' && mount -o remount,ro,bind '{place}'" for place in places)
    return " && ".join((*mounts, 'exec "$@"'))


def can_mount(place: Path) -> bool:
    try:
        return (
            subprocess.run([*NAMESPACE, "sh", "-c", read_only(place), "sh", "true"], capture_output=True).returncode
            == 0
        )
    except FileNotFoundError:
        return False


@pytest.mark.always
def test_a_farm_user_who_may_write_in_one_folder_alone_renders_and_is_told_what_cannot_be_written(tmp_path):
    installed = Path(nd.__file__).resolve().parents[1]
    (tmp_path / "home").mkdir()
    (tmp_path / "work").mkdir()
    if not can_mount(installed):
        pytest.skip("this system lets no process mount folders read-only for itself")
    environment = {**os.environ, "HOME": str(tmp_path / "home"), "MPLCONFIGDIR": str(tmp_path / "work")}
    for name in ("PYTHONDONTWRITEBYTECODE", "BLENDER_USER_RESOURCES", "XDG_CONFIG_HOME"):
        environment.pop(name, None)
    before = names(installed / "osl"), names(installed / "presets")
    done = subprocess.run(
        [*NAMESPACE, "sh", "-c", read_only(installed, tmp_path / "home"), "sh"]
        + [sys.executable, str(USER), str(tmp_path / "work")],
        capture_output=True,
        text=True,
        env=environment,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Traceback" not in done.stdout + done.stderr
    assert "mine.toml: cannot be written (Read-only file system); name another place" in done.stdout
    assert "codes [0, 0, 0, 1, 1]" in done.stdout
    assert done.stderr.count("cannot be written (Read-only file system); name another place") == 2
    assert names(tmp_path / "home") == [] and (names(installed / "osl"), names(installed / "presets")) == before
    assert [name for name in names(tmp_path / "work") if MARK in name] == []


@pytest.mark.always
def test_a_shader_for_which_the_disk_is_too_full_says_so_and_is_never_half_compiled():
    source = inlined_source(LIGHT_FILE)
    whole = compiled(source)
    for left in (0, len(source) - 1, len(source) + 1, len(whole) // 2, len(whole) - 1):
        with full_disk(left), pytest.raises(UnsupportedError, match="was not compiled"):
            compiled(source)


@pytest.mark.always
def test_without_a_folder_for_temporary_files_the_shader_says_so(monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "gone"))
    with pytest.raises(UnsupportedError, match=r"was not compiled: No such file .* in .*gone"):
        compiled(inlined_source(LIGHT_FILE))


@pytest.mark.always
def test_a_preset_for_which_the_disk_is_too_full_leaves_the_old_one(tmp_path, preset_folder):
    preset = renamed(load_preset("water"), "Mine")
    path = save_preset(preset, preset_folder)
    old = path.read_bytes()
    for left in (0, len(old) // 2, len(old) - 1):
        with full_disk(left), pytest.raises(WriteError, match=r"mine\.toml: cannot be written"):
            save_preset(preset, preset_folder)
        assert names(preset_folder) == ["mine.toml"] and path.read_bytes() == old
    delete_user_preset("mine")
    assert names(preset_folder) == []


@pytest.mark.always
def test_a_folder_with_a_backslash_is_named_before_anything_is_written(tmp_path):
    folder = tmp_path / "back\\slash"
    folder.mkdir()
    with pytest.raises(WriteError, match="has a backslash, which Blender reads as a slash"):
        save_blend(folder / "x.blend")
    assert names(folder) == []
