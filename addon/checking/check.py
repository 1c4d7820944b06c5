"""What is wrong with a scene's media, object by object, and what to do about it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import bpy
import numpy as np
from mathutils import Vector

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
    return severe([_placed(inspection, finding) for each in CHECKS for finding in each(inspection)])


def _placed(inspection: Inspection, finding: Finding) -> Finding:
    """Return a finding with a point: amid the object that it is about, unless it has one or concerns more."""
    if finding.place.point is not None:
        return finding
    obj = inspection.scene.objects.get(finding.name)
    if obj is None:
        return finding
    evaluated = obj.evaluated_get(inspection.depsgraph)
    centre = sum((Vector(corner) for corner in evaluated.bound_box), Vector()) / 8.0
    point = evaluated.matrix_world @ (centre if np.isfinite(centre).all() else Vector())
    return replace(finding, place=replace(finding.place, point=tuple(point)))
