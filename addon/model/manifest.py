"""What the extension's manifest says of it."""

from __future__ import annotations

import tomllib
from functools import cache
from typing import Any

from .folders import ROOT


@cache
def manifest() -> dict[str, Any]:
    """Return the entries of the extension's manifest."""
    return tomllib.loads((ROOT / "blender_manifest.toml").read_text(encoding="utf-8"))
