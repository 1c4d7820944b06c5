"""What is wrong with a scene's media, object by object, and what to do about it."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import bpy

from ..analysis import solid_cache
from ..nodes.lookups import caching_nodes
from .absorption_checks import strength_findings, tint_findings, volume_findings
from .coincident_checks import coincident_findings
from .finding import Finding, severe
from .foreign_checks import foreign_findings, view_findings
from .gap_checks import gap_findings
from .inspection import Inspection, inspect
from .light_checks import dispersion_findings, light_findings
from .material_checks import mask_findings, node_findings, value_findings
from .mesh_checks import mesh_findings
from .object_checks import kind_findings, object_findings
from .overlap_checks import overlap_findings
from .precision_checks import precision_findings
from .ray_checks import ray_findings
from .scene_checks import scene_findings
from .setting_checks import backend_findings, setting_findings
from .version_checks import version_findings

CHECKS: tuple[Callable[[Inspection], Iterable[Finding]], ...] = (
    setting_findings,
    version_findings,
    node_findings,
    kind_findings,
    object_findings,
    value_findings,
    mesh_findings,
    coincident_findings,
    overlap_findings,
    gap_findings,
    precision_findings,
    mask_findings,
    foreign_findings,
    dispersion_findings,
    light_findings,
    tint_findings,
    volume_findings,
    strength_findings,
    ray_findings,
    backend_findings,
    scene_findings,
    view_findings,
)
"""All checks, in the order of what they find."""


def check(scene: bpy.types.Scene) -> list[Finding]:
    """Look at a scene as it is evaluated now, and return what is wrong with it, the worst first; change nothing."""
    solid_cache.forget_all()
    return find(inspect(scene))


@caching_nodes()
def find(inspection: Inspection) -> list[Finding]:
    """Return what is wrong with a scene that is being looked at, the worst first."""
    return severe([finding for each in CHECKS for finding in each(inspection)])
