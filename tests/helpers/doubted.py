"""An ordinary scene in which something makes an analysis doubt."""

from collections.abc import Callable

from told import ORDINARY, codes, ordinary_scene

import nested_dielectric as nd
from nested_dielectric.analysis.findings import Found


def doubted(doubtful: Callable) -> tuple[set[str], Found]:
    """Names of which one must be doubted or asking, and what an analysis finds, after one that told the media."""
    scene, bead = ordinary_scene()
    assert not nd.analyse(scene).doubts
    assert codes() == ORDINARY
    named = doubtful(bead) or bead.name
    return {named} if isinstance(named, str) else set(named), nd.analyse(scene)
