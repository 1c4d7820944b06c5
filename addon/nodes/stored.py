"""Reading custom properties, which may hold anything: others can change or remove what the extension has stored."""

from __future__ import annotations

from math import isfinite
from typing import Any

import bpy


def plain(value: Any) -> Any:
    """Return what a custom property holds, to be compared and copied."""
    if hasattr(value, "to_dict"):
        return value.to_dict()
    return value.to_list() if hasattr(value, "to_list") else value


def stored_list(owner: bpy.types.ID, name: str) -> list:
    """Return the list in a custom property; an empty one if it holds anything else, or there is none."""
    value = plain(owner.get(name))
    return value if isinstance(value, list) else []


def stored_numbers(owner: bpy.types.ID, name: str, count: int) -> tuple[float, ...] | None:
    """Return the floating-point numbers in a custom property; None if it holds not as many, or anything else."""
    value = owner.get(name)
    if getattr(value, "typecode", None) not in ("f", "d") or len(value) != count:
        return None
    return tuple(value) if all(map(isfinite, value)) else None
