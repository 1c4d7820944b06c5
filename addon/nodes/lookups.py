"""Looking the nodes of a material, or of a group, through once instead of for each object that has them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Any

import bpy

_looked_up: dict[tuple, Any] | None = None
"""What functions of :func:`cached_by_nodes` returned in the outermost block of :func:`caching_nodes`."""


@contextmanager
def caching_nodes() -> Iterator[None]:
    """Let the nodes of each material and group be looked through once, however many objects it has.

    Within the block, none of the nodes that are asked about may come, go or be plugged in otherwise.
    """
    global _looked_up
    outer = _looked_up
    if outer is None:
        _looked_up = {}
    try:
        yield
    finally:
        _looked_up = outer


def cached_by_nodes(function: Callable) -> Callable:
    """Make a function of a material or a group remember what it returns in a block of :func:`caching_nodes`."""

    @wraps(function)
    def remembering(data: bpy.types.ID | None) -> Any:
        if _looked_up is None:
            return function(data)
        key = function, data
        if key not in _looked_up:
            _looked_up[key] = function(data)
        return _looked_up[key]

    return remembering
