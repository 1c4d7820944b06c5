"""What this session knows of the scenes that it has analysed."""

from __future__ import annotations

from dataclasses import dataclass, field

import bpy

from ..geometry.contacts import PairCache
from ..nodes.identity import forget_gone_scenes
from . import solid_cache
from .findings import Found
from .snapshot import SceneSnapshot


@dataclass
class SceneAnalysis:
    """What this session knows of a scene.

    :ivar snapshot: of the scene as it was looked at last; None if it has to be looked at anew.
    :ivar found: what the last analysis found.
    :ivar pair_cache: how its bodies touch.
    """

    snapshot: SceneSnapshot | None = None
    found: Found | None = None
    pair_cache: PairCache = field(default_factory=PairCache)


_analyses: dict[int, SceneAnalysis] = {}
"""By the session's number of the scene."""


def analysis_of(scene: bpy.types.Scene) -> SceneAnalysis:
    """Return what is known of a scene; it may be brought up to date."""
    return _analyses.setdefault(scene.session_uid, SceneAnalysis())


def forget_unused() -> None:
    """Forget scenes that are gone, and solids that no snapshot holds."""
    forget_gone_scenes(_analyses)
    latest = (known.snapshot for known in _analyses.values() if known.snapshot)
    solid_cache.keep_only(instance.body.solid for snapshot in latest for instance in snapshot.bodies)


def forget_snapshots() -> None:
    """Look at all scenes anew the next time."""
    for known in _analyses.values():
        known.snapshot = None
