"""Folders, and disks that are full."""

import resource
from contextlib import contextmanager
from pathlib import Path

OLD = b"what was there before"


def names(folder: Path) -> list[str]:
    """All files and folders, hidden ones too."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*"))


@contextmanager
def full_disk(left: int):
    """Let files grow to some bytes at most. Python ignores the signal for more, so writing fails as on a full disk."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (left, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
