"""Handlers of other add-ons and scripts that may change a scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import bpy

_OURS = __package__.rpartition(".")[0]
"""The package whose handlers are no scripts: all of the extension."""


def frame_scripts() -> Iterator[Callable]:
    """Yield others' handlers that may change a scene on every frame."""
    return _scripts("frame_change_pre", "frame_change_post", "render_pre", "render_init")


def update_scripts() -> Iterator[Callable]:
    """Yield others' handlers that may change a scene whenever anything changes."""
    return _scripts("depsgraph_update_pre", "depsgraph_update_post")


def _scripts(*names: str) -> Iterator[Callable]:
    """Yield others' handlers in some of Blender's lists."""
    for name in names:
        for handler in getattr(bpy.app.handlers, name):
            if not getattr(handler, "__module__", "").startswith(_OURS):
                yield handler
