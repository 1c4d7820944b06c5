"""Checks of how much rays meet: bounces that paths through nested media need, and limits of the shader."""

from __future__ import annotations

from collections.abc import Iterator

import bpy
import numpy as np
from mathutils import Vector

from ..cutting.cut_scene import is_cut
from ..geometry.nesting import Crossing, Met, count_crossings
from ..model.contract import PROBE_HITS
from ..scene import settings
from ..scene.foreign import is_clear
from ..scene.materials import dielectric_node, medium_material
from ..scene.media import dispersing_materials, get_priority
from .finding import Action, Finding, Fix, Place
from .inspection import Inspection
from .kinds import FEW_BOUNCES, RAY_LIMIT

RAYS = 24
"""Sample rays across the camera's view, and as many up."""

STRIDE = 349
"""Places between one ray and the next, of all in rows; it shares no divisor with their number."""

MOST_LOOKS = 2_000_000
"""How often a ray may look at an instance, a second's work: Blender's rays look at each. Of very many things rays are fewer."""

REFLECTIONS = 8
"""Bounces beyond the interfaces on a straight way: at Blender's 12 iced water, of 8 interfaces, loses 4.7 % of its light."""

_INTERFACES = ("cycles.max_bounces", "cycles.transmission_bounces")
_HIDDEN = "cycles.transparent_max_bounces"
"""Settings that count interfaces, and surfaces that do not exist."""


def ray_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield too few bounces for the nesting that rays from the camera meet, and rays that meet more than the shader counts."""
    scene = inspection.scene
    camera = scene.camera
    if camera is None or camera.type != "CAMERA" or not inspection.objects:
        return
    most = {name: (Met(), None) for name in ("valid", "hidden")}
    looks = MOST_LOOKS
    for origin, direction in camera_rays(scene, camera.evaluated_get(inspection.depsgraph)):
        met, point, casts = _met(inspection, origin, direction)
        looks -= casts * max(len(inspection.snapshot.instances), 1)
        if looks < 0:
            break
        for name, (worst, _) in most.items():
            if getattr(met, name) > getattr(worst, name):
                most[name] = met, point
    valid, through = most["valid"]
    hidden, behind = most["hidden"]
    for path in _INTERFACES if valid.valid else ():
        yield from _too_few(scene, path, valid.valid, REFLECTIONS, "interfaces", through)
    portals = 2 if dispersing_materials(scene) else 0
    if not is_cut(scene) and hidden.hidden:
        yield from _too_few(scene, _HIDDEN, hidden.hidden + portals, 0, "hidden surfaces", behind)
    for met, point in most.values():
        if met.valid + met.hidden > PROBE_HITS:
            yield Finding(
                RAY_LIMIT,
                scene.name,
                f"has {met.valid + met.hidden} surfaces of media in a row, of which a ray can count {PROBE_HITS}",
                "let fewer media stand behind each other",
                place=Place(point=point),
            )
            break


def _too_few(
    scene: bpy.types.Scene, path: str, met: int, beyond: int, what: str, point: tuple | None
) -> Iterator[Finding]:
    """Yield a limit of bounces that is below what rays meet."""
    value = settings.read(scene, path)
    if value >= met + beyond:
        return
    enough = max(settings.AT_LEAST[path], -(-(met + beyond) // 16) * 16)
    label = settings.label(scene, path)
    yield Finding(
        FEW_BOUNCES,
        scene.name,
        f"has {label} at {value}, and rays from the camera meet {met} {what} in a row",
        f"set it to {enough} (Render properties > Light Paths)",
        place=Place(point=point),
        fix=Fix(Action.SET_SETTING, (scene.name,), enough, path),
    )


def camera_rays(scene: bpy.types.Scene, camera: bpy.types.Object) -> Iterator[tuple[Vector, Vector]]:
    """Yield origins and directions of rays all over a camera's view, in the world; the first ones lie far apart."""
    corners = camera.data.view_frame(scene=scene)
    right, lower, left = corners[0] - corners[3], corners[2] - corners[3], corners[3]
    matrix = camera.matrix_world
    for index in range(RAYS * RAYS):
        row, column = divmod(index * STRIDE % (RAYS * RAYS), RAYS)
        # Off the diagonals of faces, where rays may meet an edge.
        u, v = (column + 0.481) / RAYS, (row + 0.527) / RAYS
        target = left + right * u + lower * v
        if camera.data.type == "ORTHO":
            yield matrix @ Vector((target.x, target.y, 0.0)), (matrix.to_3x3() @ Vector((0, 0, -1))).normalized()
        else:
            yield matrix.translation.copy(), (matrix @ target - matrix.translation).normalized()


_MOST_HITS = PROBE_HITS + 1
"""Where a ray is given up."""


def _met(inspection: Inspection, origin: Vector, direction: Vector) -> tuple[Met, tuple | None, int]:
    """Return what a ray meets that goes straight on until it ends at something opaque.

    :returns: beside it where it meets a medium first, and how many rays that took.
    """
    crossings: list[Crossing] = []
    first = None
    priorities: dict[bpy.types.Object, int] = {}
    casts = 0
    while casts < _MOST_HITS:
        casts += 1
        hit, point, normal, face, obj, matrix = inspection.scene.ray_cast(inspection.depsgraph, origin, direction)
        if not hit:
            break
        original = obj.original
        if original not in priorities:
            priorities[original] = get_priority(original) if medium_material(original) is not None else -1
        if priorities[original] >= 0:
            first = first or tuple(point)
            body = original, tuple(map(tuple, matrix))
            crossings.append(Crossing(body, priorities[original], normal.dot(direction) < 0.0))
        elif not _lets_through(obj, face):
            break
        reach = max(map(abs, point))
        origin = point + direction * max(1e-6 * (reach + (point - origin).length), float(np.spacing(np.float32(reach))))
    return count_crossings(crossings), first, casts


def _lets_through(obj: bpy.types.Object, face: int) -> bool:
    """Return whether a ray may go on behind a face of what is no medium."""
    slots = obj.material_slots
    if not slots:
        return False
    polygons = getattr(obj.data, "polygons", ())
    index = polygons[face].material_index if 0 <= face < len(polygons) else 0
    material = slots[min(index, len(slots) - 1)].material
    return dielectric_node(material) is not None or is_clear(material)
