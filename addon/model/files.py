"""Files that are written whole or not at all.

What is written goes to a temporary file in the same folder, which takes the old one's place when it is whole. A process
that is killed leaves the old file as it was, and beside it at most a hidden one whose name begins with :data:`MARK`.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import signal
import socket
import stat
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

MARK = ".nested_dielectric_"
"""How names of temporary files begin."""

PATIENCE = 1.0
"""Longest time that the end of the process waits for a file that is just taking its place, s."""


class WriteError(RuntimeError):
    """A file that cannot be written, or was not written whole. What was there before is still there."""


@contextmanager
def replacing(path: Path | str) -> Iterator[Path]:
    """Yield a path for a block to write to; what it writes takes the file's place at the end.

    The path is in the same folder and has the same ending, in lower case.

    Whatever the block raises leaves the old file as it was, and nothing else behind; missing folders are made. A path
    is the operating system's: braces, ``#`` and ``//``, which Blender reads in its own way, stand for themselves.

    :raises WriteError: before the block, if no file can be written there; for an OSError in it; if it writes no file.
    """
    target = absolute(path)
    with _blaming(path), _draft(target.parent, target.suffix.lower()) as draft:
        _require_writable(path, target)
        yield draft.path
        with _moving:
            draft.settle(draft.path, target)


@contextmanager
def new_folder(path: Path | str) -> Iterator[Path]:
    """Yield a folder for a block to fill, which takes its place at the end with all that is in it.

    Whatever the block raises leaves nothing behind; missing folders above it are made.

    :raises WriteError: before the block, if something is there already, but for an empty folder, or if no folder can be made
        there; for an OSError in it.
    """
    target = absolute(path)
    with _blaming(path):
        if os.path.lexists(target) and not (target.is_dir() and not any(target.iterdir())):
            raise WriteError(f"{path}: is there already; name a new folder, or an empty one")
        if target == absolute(os.curdir):  # whoever is in it would be left in one that is gone
            raise WriteError(f"{path}: is the folder that you are in, which would be replaced; name a new one in it")
        with _draft(target.parent) as draft:
            draft.path.mkdir()
            yield draft.path
            with _moving:
                if target.exists():
                    target.rmdir()
                os.replace(draft.path, target)
                draft.made = []


@contextmanager
def replacing_in(folder: Path | str) -> Iterator[Path]:
    """Yield a new folder in a folder; the files that the block leaves in it take their places in the folder at the end.

    Whatever the block raises leaves the old files as they were.

    :raises WriteError: before the block, if no files can be written there; for an OSError in it; for a file that cannot
        take its place.
    """
    place = absolute(folder)
    with _blaming(folder), _draft(place) as draft:
        draft.path.mkdir()
        yield draft.path
        for file in sorted(path for path in draft.path.rglob("*") if path.is_file()):
            target = place / file.relative_to(draft.path)
            with _blaming(target), _moving:
                _require_writable(target, target)
                target.parent.mkdir(parents=True, exist_ok=True)
                draft.settle(file, target)


def require_place(path: Path | str) -> None:
    """Make sure that a file can be written to a path; nothing is left behind.

    :raises WriteError: if none can, as by :func:`replacing`.
    """
    target = absolute(path)
    with _blaming(path), _draft(target.parent, target.suffix.lower()):
        _require_writable(path, target)


def require_folder(folder: Path | str) -> None:
    """Make sure that files can be written to a folder, which may not be there yet; nothing is left behind.

    :raises WriteError: if none can, as by :func:`replacing_in`.
    """
    with _blaming(folder), _draft(absolute(folder)):
        pass


def absolute(path: Path | str) -> Path:
    """Return where a path leads through links. Two slashes at its beginning would mean something else to Blender."""
    name = os.path.realpath(path)
    return Path("/" + name.lstrip("/") if os.sep == "/" else name)


@contextmanager
def ending_at_once(folder: Path | str | None = None) -> Iterator[None]:
    """Let Ctrl-C and other requests to end take effect at once, whatever the main thread does.

    Python's own handlers wait until Blender's code returns, which nobody can break off while it renders. So meanwhile a
    thread listens; it removes unfinished files and ends the process as of the signal. Requests that the caller handles
    or ignores stay his, and all of them at an interactive prompt and off the main thread.

    :param folder: one that goes, too, if it is empty then.
    """
    ours = _unhandled()
    if not ours:
        yield
        return
    with ExitStack() as undo:
        reader, writer = socket.socketpair()
        undo.callback(reader.close)
        listener = threading.Thread(target=_listen, args=(reader, ours, folder), daemon=True)
        listener.start()
        undo.callback(listener.join)
        undo.callback(writer.close)
        writer.setblocking(False)
        undo.callback(signal.set_wakeup_fd, signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False))
        for number in ours:
            undo.callback(_set_action, number, _get_action(number))
            undo.callback(signal.signal, number, signal.getsignal(number) or signal.SIG_DFL)
            signal.signal(number, _leave_to_listener)
        yield


_moving = threading.Lock()
"""Held while files appear, take their places and go; by a process that ends, for good."""

_drafts: list[_Draft] = []


class _Draft:
    """What is to take a file's place: a name in its folder that nobody has, and the folders that are made for it."""

    def __init__(self, folder: Path, suffix: str) -> None:
        self.folder = folder
        self.made = [each for each in (folder, *folder.parents) if not each.exists()]
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # Tells now, rather than after hours of work, whether files can be made here.
            handle, name = tempfile.mkstemp(prefix=MARK, suffix=suffix, dir=folder)
            os.close(handle)
            os.unlink(name)
        except BaseException:
            self._remove_folders()
            raise
        self.path = Path(name)

    def settle(self, file: Path, target: Path) -> None:
        """Put a file in its place once it lies on the disk."""
        with file.open("r+b") as whole:
            os.fsync(whole.fileno())
        if target.exists():
            shutil.copymode(target, file)
        os.replace(file, target)
        self.made = []

    def discard(self) -> None:
        """Remove what is left, with whatever Blender made beside it of its name."""
        for left in self.folder.glob(f"{self.path.stem}*"):
            with suppress(OSError):
                shutil.rmtree(left) if left.is_dir() else left.unlink()
        self._remove_folders()

    def _remove_folders(self) -> None:
        for folder in self.made:
            with suppress(OSError):
                folder.rmdir()


@contextmanager
def _draft(folder: Path, suffix: str = "") -> Iterator[_Draft]:
    with _moving:
        draft = _Draft(folder, suffix)
        _drafts.append(draft)
    try:
        yield draft
    finally:
        with _moving:
            _drafts.remove(draft)
            draft.discard()


def _require_writable(path: Path | str, target: Path) -> None:
    try:
        mode = target.stat().st_mode
    except FileNotFoundError:
        return
    if not stat.S_ISREG(mode):
        kind = "a folder" if stat.S_ISDIR(mode) else "no file"
        raise WriteError(f"{path}: cannot be written, as it is {kind}; name a file")
    if not os.access(target, os.W_OK):
        raise WriteError(f"{path}: cannot be written, as it is write-protected; name another file")


@contextmanager
def _blaming(path: Path | str) -> Iterator[None]:
    try:
        yield
    except FileExistsError as error:
        raise WriteError(f"{path}: cannot be written, as {error.filename} is no folder; name another place") from error
    except OSError as error:
        raise WriteError(f"{path}: cannot be written ({error.strerror or error}); name another place") from error


_REQUESTS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Signals that ask a process to end."""

_NOBODYS = (signal.SIG_DFL, signal.default_int_handler, None)
"""Handlers that nobody chose. None is one that Python does not know: Blender's own of Ctrl-C waits for Cycles, too."""

# signal.signal() knows Python's handlers alone, and sets none off the main thread.
_get_action = ctypes.pythonapi.PyOS_getsig
_get_action.argtypes, _get_action.restype = (ctypes.c_int,), ctypes.c_void_p
_set_action = ctypes.pythonapi.PyOS_setsig
_set_action.argtypes, _set_action.restype = (ctypes.c_int, ctypes.c_void_p), ctypes.c_void_p


def _unhandled() -> tuple[int, ...]:
    if threading.current_thread() is not threading.main_thread() or hasattr(sys, "ps1"):
        return ()
    return tuple(number for number in _REQUESTS if signal.getsignal(number) in _NOBODYS)


def _leave_to_listener(*_: object) -> None:
    """Handle a signal later than the listener does."""


def _listen(reader: socket.socket, ours: tuple[int, ...], folder: Path | str | None) -> None:
    while numbers := reader.recv(1):
        if numbers[0] in ours:
            _end(numbers[0], folder)


def _end(number: int, folder: Path | str | None) -> None:
    """End the process as the signal would, without what is unfinished."""
    _moving.acquire(timeout=PATIENCE)
    until = time.monotonic() + PATIENCE
    for draft in _drafts:
        draft.discard()
        while draft.path.is_dir() and time.monotonic() < until:  # something is still written to it, which fails soon
            draft.discard()
    if folder is not None:
        with suppress(OSError):
            os.rmdir(folder)
    if number == signal.SIGINT:
        os.write(2, b"\nnested-dielectric: interrupted\n" if os.isatty(2) else b"nested-dielectric: interrupted\n")
    if os.name == "posix":
        _set_action(number, None)
        os.kill(os.getpid(), number)
    os._exit(128 + number)
