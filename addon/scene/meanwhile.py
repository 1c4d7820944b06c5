"""Properties of Blender's that have other values for a while."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..model.files import WriteError


@contextmanager
def set_meanwhile(owner: Any, **values: Any) -> Iterator[None]:
    """Give properties other values meanwhile; each may bound the next one's, so their order matters."""
    before = {name: getattr(owner, name) for name in values}
    try:
        for name, value in values.items():
            setattr(owner, name, value)
        yield
    finally:
        for name, value in before.items():
            setattr(owner, name, value)


@contextmanager
def set_path_meanwhile(owner: Any, name: str, path: Path) -> Iterator[None]:
    """Let a property hold a path as it is meanwhile, though Blender would read templates in it."""
    text = str(path).replace("{", "{{").replace("}", "}}")
    with set_meanwhile(owner, **{name: text}):
        if getattr(owner, name) != text or (os.sep == "/" and "\\" in text):
            raise WriteError(f"{path.parent}: too long for Blender, or with a backslash; name another folder")
        yield
