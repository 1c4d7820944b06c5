"""Checks of the materials of media: their nodes, values, mixed shaders."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np

from ..model.parameters import SOCKETS
from ..nodes.lookups import caching_nodes
from ..nodes.places import ignores_masks
from ..nodes.problems import PREPARE, node_problems
from ..scene.materials import dielectric_node, dielectrics, may_disperse
from ..scene.media import all_objects, get_priority
from .finding import Action, Finding, Fix
from .inspection import Inspection
from .kinds import NODES, UNMASKED_MIX, VALUE_LIMIT


def node_findings(inspection: Inspection) -> list[Finding]:
    """Return what is wrong with the nodes of a scene's materials."""
    return material_problems(inspection.scene)


@caching_nodes()
def material_problems(scene: bpy.types.Scene) -> list[Finding]:
    """Return what is wrong with the nodes of a scene's materials, each named by the first object that has it."""
    users: dict[bpy.types.Material, bpy.types.Object] = {}
    for obj in sorted(all_objects(scene), key=lambda obj: obj.name_full):
        for slot in obj.material_slots:
            if slot.material is not None:
                users.setdefault(slot.material, obj)
    return [
        Finding(NODES, obj.name, f"has {text}", remedy, others=(material.name,), fix=_mending(material, remedy))
        for material, obj in users.items()
        for text, remedy in node_problems(material)
    ]


def _mending(material: bpy.types.Material, remedy: str) -> Fix | None:
    """Return what mends a material's nodes where Prepare Scene would."""
    return Fix(Action.MEND_NODES, (material.name,)) if PREPARE in remedy and material.library is None else None


def value_findings(inspection: Inspection) -> list[Finding]:
    """Return values of sockets beyond their limits, which only a script can set.

    The shader takes the nearest within the limits, or the default.
    """
    problems = []
    users = {material: obj for obj in reversed(inspection.objects) for _, material in dielectrics(obj)}
    for material, obj in users.items():
        node = dielectric_node(material)
        for parameter in SOCKETS:
            socket = node.inputs[parameter.name]
            if parameter.limits is None or socket.is_linked:
                continue
            value = socket.default_value
            counts = parameter.bounded(value)
            if not np.array_equal(np.float32(value), np.float32(counts)):
                problems.append(
                    Finding(
                        VALUE_LIMIT,
                        obj.name,
                        f"has {_text_of(value)} for {parameter.name!r} in material {material.name!r}, "
                        f"which counts as {_text_of(counts)}",
                        f"set it to something from {parameter.limits[0]:g} to {parameter.limits[1]:g}",
                        others=(material.name,),
                        fix=_bounding(material, parameter.name),
                    )
                )
    return problems


def _bounding(material: bpy.types.Material, name: str) -> Fix | None:
    """Return what sets a socket to the value that it counts as."""
    return Fix(Action.SET_VALUE, (material.name,), path=name) if material.library is None else None


def _text_of(value: float | Sequence[float]) -> str:
    """Return a number, or three, as text."""
    if isinstance(value, (int, float)):
        return f"{value:.4g}"
    return f"({', '.join(f'{component:.4g}' for component in tuple(value)[:3])})"


def mask_findings(inspection: Inspection) -> list[Finding]:
    """Return other shaders that show where the surface that they are mixed into does not exist."""
    shapes = inspection.shapes
    used = {material for shape in shapes for material in shape.materials}
    blind = {material for material in used if ignores_masks(material)}
    if not blind:
        return []
    shapes = [shape for shape in shapes if len(shape.vertices)]
    low = np.array([shape.vertices.min(axis=0) for shape in shapes])
    high = np.array([shape.vertices.max(axis=0) for shape in shapes])
    priorities = np.array([get_priority(shape.obj) for shape in shapes])
    remedy = "multiply the factor of the Mix Shader by Surface Exists of the nested dielectric"
    problems = []
    for index, shape in enumerate(shapes):
        mixed = [material for material in shape.materials if material in blind]
        if not mixed:
            continue
        meets = np.all((low < high[index]) & (high > low[index]), axis=1) & (priorities <= priorities[index])
        wrong = ["show inside media that win over it, too"] if np.count_nonzero(meets) > 1 else []  # more than itself
        wrong += ["count twice where light is split"] if any(map(may_disperse, mixed)) else []
        if wrong:
            text = f"mixes other shaders into material {mixed[0].name!r}, which {' and '.join(wrong)}"
            problems.append(Finding(UNMASKED_MIX, shape.obj.name, text, remedy))
    return problems
