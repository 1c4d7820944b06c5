"""Checks of what absorbs or scatters light inside media."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np
from mathutils import Vector

from ..analysis.extents import SHAPED
from ..analysis.solid_cache import mesh_of
from ..geometry.meshes import mean_chord
from ..model.contract import BY_VOLUME_SOCKET
from ..nodes.identity import known_number
from ..nodes.names import MASK_OUTPUT
from ..scene.foreign import is_clear, light_box, sends_light_on
from ..scene.lights import scene_lights
from ..scene.materials import absorption_coefficients, dielectric_node, has_own_volume, medium_material
from ..scene.media import get_priority
from .evaluated_shapes import evaluated_shape, sample_points
from .finding import Action, Finding, Fix
from .inspection import Inspection
from .kinds import TINT_IN_PART, TINT_STRENGTH, TINTED_LABEL, VOLUME_IN_WINNER


def _is_tinted(obj: bpy.types.Object) -> bool:
    """Return whether an object's medium absorbs light."""
    return max(absorption_coefficients(dielectric_node(medium_material(obj)))) > 0.0


def _is_left_to_volume(scene: bpy.types.Scene, obj: bpy.types.Object) -> bool:
    """Return whether Cycles' volume absorbs in a medium for all rays, as an analysis has told its material."""
    socket = dielectric_node(medium_material(obj)).inputs.get(BY_VOLUME_SOCKET)
    return socket is not None and 0 < socket.default_value == known_number(scene)


def tint_findings(inspection: Inspection) -> list[Finding]:
    """Return what surfaces do not charge rightly for in a tinted medium that is not left to its volume."""
    scene = inspection.scene
    charged = [shape for shape in inspection.solids if _is_tinted(shape.obj)]
    findings = [
        Finding(
            TINTED_LABEL,
            shape.obj.name,
            f"is tinted and has the label {slot.material.name!r}, which lets light into it unseen",
            "make the label an object of its own, a little off the surface",
        )
        for shape in charged
        for slot in shape.obj.material_slots
        if dielectric_node(slot.material) is None and is_clear(slot.material)
    ]
    charged = [shape for shape in charged if not _is_left_to_volume(scene, shape.obj)]
    findings += [
        Finding(
            TINT_IN_PART,
            shape.obj.name,
            "is tinted and has a volume of its own in its material, whose scattered light is tinted in part",
            _TO_VOLUME.format(shape.obj.name),
        )
        for shape in charged
        if has_own_volume(medium_material(shape.obj))
    ]
    if charged:
        for name, points in _transmitting_objects(inspection):
            findings += [
                Finding(
                    TINT_IN_PART,
                    name,
                    f"shines, scatters or lets light through inside the tinted {shape.obj.name!r}, which tints that in part",
                    _TO_VOLUME.format(shape.obj.name),
                )
                for shape in charged
                if inspection.inside.any(shape, points)
            ]
    return findings


_TO_VOLUME = (
    "prepare the scene; should that not help, let nothing that touches {!r} move, link nothing into its colour, give it a "
    "priority of its own, and less tint where others win over it"
)


def _transmitting_objects(inspection: Inspection) -> Iterator[tuple[str, np.ndarray]]:
    """Yield lights and what sends light on, by name, with (n, 3) points of them."""
    scene, depsgraph = inspection.scene, inspection.depsgraph
    for light in scene_lights(scene):
        if light.data.type != "SUN" and not light.hide_render:
            yield light.name, light_box(light).mean(axis=0)[None]
    for obj in scene.objects:
        if obj in inspection.among or obj.type not in SHAPED or obj.hide_render or not sends_light_on(obj):
            continue
        if medium_material(obj) is not None:
            continue
        evaluated = obj.evaluated_get(depsgraph)
        shape = (
            evaluated_shape(evaluated, np.array(evaluated.matrix_world), mesh_of(obj, evaluated))
            if obj.type == "MESH"
            else None
        )
        if shape is not None and len(shape.vertices):
            yield obj.name, sample_points(shape)
        else:
            yield (
                obj.name,
                np.array([tuple(obj.matrix_world @ Vector(corner)) for corner in obj.bound_box]).mean(axis=0)[None],
            )


DARKEST, CLEAREST = 0.01, 0.99
"""Parts of the light beyond which a tint is hardly meant: what the brightest, and what the darkest channel lets through."""


def strength_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield media whose colour is black or invisible through as much of it as the object is thick: a depth in another unit."""
    seen = set()
    for shape in inspection.solids:
        material = medium_material(shape.obj)
        node = dielectric_node(material)
        if material in seen or any(node.inputs[name].is_linked for name in ("Transmittance", "Transmittance Depth")):
            continue
        coefficients = np.array(absorption_coefficients(node))
        if not coefficients.any():
            continue
        thickness = mean_chord(shape.vertices, shape.triangles)
        left = np.exp(-coefficients * thickness)
        if left.max() >= DARKEST and not CLEAREST < left.min() < 1.0:
            continue
        seen.add(material)
        depth = node.inputs["Transmittance Depth"].default_value
        yield Finding(
            TINT_STRENGTH,
            shape.obj.name,
            f"lets {_percent(left)} of the light through: it is {thickness:.3g} thick, its colour has a Transmittance Depth "
            f"of {depth:.3g}",
            "press Fit Depth (Object > Nested Dielectric), if that is not meant",
            others=(material.name,),
            fix=Fix(Action.SET_DEPTH, (shape.obj.name,), thickness, safe=False),
        )


def _percent(left: np.ndarray) -> str:
    """Return in words what is left of the light, of red, green and blue."""
    return "less than 1 %" if left.max() < DARKEST else f"{100.0 * left.min():.4g} %"


def volume_findings(inspection: Inspection) -> list[Finding]:
    """Return volumes that an artist has added to a medium and that go on where another wins, or cannot tell where that is."""
    findings = []
    inside = inspection.inside
    for shape in inspection.solids:
        material = medium_material(shape.obj)
        if not has_own_volume(material):
            continue
        mask = dielectric_node(material).outputs.get(MASK_OUTPUT)
        is_masked = mask is not None and mask.is_linked
        priority = get_priority(shape.obj)
        for winner in (other for other in inspection.solids if get_priority(other.obj) < priority):
            if is_masked and winner.obj.matrix_world.determinant() < 0.0:
                text = f"is mirrored, so the {MASK_OUTPUT!r} of {shape.obj.name!r} takes its inside for its outside"
                remedy = "apply its scale (Object > Apply > Scale) and recalculate its normals"
                findings.append(Finding(VOLUME_IN_WINNER, winner.obj.name, text, remedy))
            elif not is_masked and (
                inside.any(shape, sample_points(winner)) or inside.any(winner, sample_points(shape))
            ):
                text = f"has a volume of its own in its material that goes on inside {winner.obj.name!r}, which wins over it"
                remedy = f"multiply its density by the node's output {MASK_OUTPUT!r}"
                findings.append(Finding(VOLUME_IN_WINNER, shape.obj.name, text, remedy))
    return findings
