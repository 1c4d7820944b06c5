"""Files take the place of others when they are whole, and not before."""

import os
import signal
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest
from disk import OLD, names

from nested_dielectric.model import files
from nested_dielectric.model.files import WriteError, new_folder, replacing, replacing_in


@pytest.mark.parametrize("name", ["{blend_name}.png", "shot_##.png", "é 漢\n.png", "a\udcff.png", "n" * 251 + ".png"])
def test_a_name_stands_for_itself(name, tmp_path):
    with replacing(f"/{tmp_path}/new/{name}") as draft:
        draft.write_bytes(b"new")
        assert names(tmp_path) == ["new", f"new/{draft.name}"]
    assert names(tmp_path) == ["new", f"new/{name}"] and (tmp_path / "new" / name).read_bytes() == b"new"


def test_a_block_that_fails_leaves_the_old_file_and_nothing_else(tmp_path):
    (tmp_path / "old.png").write_bytes(OLD)
    with pytest.raises(KeyError), replacing(tmp_path / "old.png") as draft:
        draft.write_bytes(b"new")
        Path(f"{draft}@").write_bytes(b"as Blender makes beside a .blend")
        raise KeyError
    with pytest.raises(WriteError, match=r"old\.png"), replacing(tmp_path / "old.png"):
        pass  # wrote nothing
    with pytest.raises(KeyError), replacing(tmp_path / "new" / "deep" / "x.png"):
        raise KeyError
    assert names(tmp_path) == ["old.png"] and (tmp_path / "old.png").read_bytes() == OLD


def test_a_new_file_keeps_the_mode_of_the_old_one_and_links_to_it(tmp_path):
    (tmp_path / "old.png").write_bytes(OLD)
    (tmp_path / "old.png").chmod(0o640)
    (tmp_path / "link.png").symlink_to("old.png")
    with replacing(tmp_path / "link.png") as draft:
        draft.write_bytes(b"new")
    assert (tmp_path / "link.png").is_symlink() and (tmp_path / "old.png").read_bytes() == b"new"
    assert stat.S_IMODE((tmp_path / "old.png").stat().st_mode) == 0o640


@pytest.mark.parametrize(
    "name, words",
    [
        ("folder.png", "is a folder"),
        ("file/x.png", "file is no folder"),
        ("file/deep/x.png", "file is no folder|Not a directory"),
        ("device.png", "is no file"),
        ("n" * 252 + ".png", "name too long"),
        ("loop.png", "symbolic links"),
    ],
)
def test_what_cannot_be_written_is_named_before_any_work_is_done(name, words, tmp_path):
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "file").write_bytes(OLD)
    (tmp_path / "device.png").symlink_to("/dev/full")
    (tmp_path / "loop.png").symlink_to("loop.png")
    before = names(tmp_path)
    with pytest.raises(WriteError, match=f"(?s){name[:8]}.*({words})"), replacing(tmp_path / name):
        pytest.fail("the work was begun")
    assert names(tmp_path) == before


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="root may write everywhere")
def test_write_protection_holds(tmp_path):
    (tmp_path / "old.png").write_bytes(OLD)
    (tmp_path / "old.png").chmod(0o440)
    with pytest.raises(WriteError, match="write-protected"), replacing(tmp_path / "old.png"):
        pytest.fail("the work was begun")
    tmp_path.chmod(0o550)
    with pytest.raises(WriteError, match="Permission denied"), replacing(tmp_path / "new.png"):
        pytest.fail("the work was begun")
    tmp_path.chmod(0o750)


def test_files_of_a_folder_take_their_places_together(tmp_path):
    (tmp_path / "a").write_bytes(OLD)
    with replacing_in(tmp_path) as folder:
        (folder / "deep").mkdir()
        (folder / "a").write_bytes(b"a")
        (folder / "deep" / "b").write_bytes(b"b")
        assert (tmp_path / "a").read_bytes() == OLD
    assert names(tmp_path) == ["a", "deep", "deep/b"] and (tmp_path / "a").read_bytes() == b"a"


WAITING = """
import pathlib, sys, time
sys.path.insert(0, sys.argv[1])
import files
try:
    with files.ending_at_once(), files.replacing(sys.argv[2]) as draft:
        draft.write_bytes(b"half")
        print("begun", flush=True)
        time.sleep(30)
finally:
    pathlib.Path(sys.argv[2] + ".finally").touch()
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL])
def test_a_process_that_is_ended_ends_as_of_the_signal_and_leaves_the_old_file(number, tmp_path):
    path = tmp_path / "old.png"
    path.write_bytes(OLD)
    addon = Path(files.__file__).resolve().parent
    process = subprocess.Popen(
        [sys.executable, "-c", WAITING, addon, path], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "begun\n"
    process.send_signal(number)
    error = process.communicate(timeout=20)[1]
    assert process.returncode == -number  # 128 more than the signal's number in shells: 130 after Ctrl-C
    assert error == ("nested-dielectric: interrupted\n" if number == signal.SIGINT else "")
    assert path.read_bytes() == OLD
    left = [name for name in names(tmp_path) if name != "old.png"]
    assert len(left) == (number == signal.SIGKILL) and all(name.startswith(files.MARK) for name in left)


FILLING = """
import shutil, sys
sys.path.insert(0, sys.argv[1])
import files
with files.ending_at_once(), files.new_folder(sys.argv[2]) as draft:
    print("begun", flush=True)
    for number in range(100000):
        shutil.copytree(sys.argv[1], draft / "in" / str(number))
"""


@pytest.mark.parametrize("_", range(3))
def test_a_folder_that_is_being_filled_when_the_process_is_ended_is_gone(_, tmp_path):
    addon = Path(files.__file__).resolve().parent
    process = subprocess.Popen(
        [sys.executable, "-c", FILLING, addon, tmp_path / "new"], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert process.stdout.readline()
    time.sleep(0.1)
    process.send_signal(signal.SIGTERM)
    process.communicate(timeout=20)
    assert process.returncode == -signal.SIGTERM and names(tmp_path) == []


def test_signals_that_the_caller_handles_or_ignores_stay_his():
    def handler(*_):
        caught.append(True)

    caught = []
    before = signal.signal(signal.SIGTERM, handler), signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with files.ending_at_once():
            signal.raise_signal(signal.SIGTERM)
            signal.raise_signal(signal.SIGHUP)
        assert caught == [True]
        assert signal.getsignal(signal.SIGTERM) is handler and signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGTERM, before[0])
        signal.signal(signal.SIGHUP, before[1])


def test_afterwards_signals_are_handled_as_before():
    handlers = [signal.getsignal(number) for number in files._REQUESTS]
    actions = [files._get_action(number) for number in files._REQUESTS]
    with files.ending_at_once():
        assert signal.getsignal(signal.SIGINT) not in handlers
        with files.ending_at_once():
            pass
    assert [signal.getsignal(number) for number in files._REQUESTS] == handlers
    assert [files._get_action(number) for number in files._REQUESTS] == actions
    assert signal.set_wakeup_fd(-1) == -1


@pytest.mark.parametrize("place", ["new/deep", "empty"])
def test_a_new_folder_is_there_with_all_that_is_in_it(place, tmp_path):
    (tmp_path / "empty").mkdir()
    with new_folder(tmp_path / place) as draft:
        (draft / "in").mkdir()
        (draft / "in" / "x").write_bytes(b"new")
        assert not (tmp_path / place / "in").exists()
    assert (tmp_path / place / "in" / "x").read_bytes() == b"new"
    assert not [name for name in names(tmp_path) if files.MARK in name]


def test_a_folder_that_is_not_filled_leaves_nothing_and_what_is_there_stays(tmp_path):
    with pytest.raises(KeyError), new_folder(tmp_path / "new" / "deep") as draft:
        (draft / "x").write_bytes(b"new")
        raise KeyError
    assert names(tmp_path) == []
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "x").write_bytes(OLD)
    for place in ("full", "full/x"):
        with pytest.raises(WriteError, match="is there already"), new_folder(tmp_path / place):
            pytest.fail("the work began")
    assert names(tmp_path) == ["full", "full/x"] and (tmp_path / "full" / "x").read_bytes() == OLD
