"""Checks of media for which single precision is too coarse: far from the origin, very small, or with walls too thin."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..geometry.gaps import thin_walls, thinnest_wall
from ..geometry.surfaces import FLOAT_ROUNDING, TOUCH_TOLERANCE
from .finding import Action, Finding, Fix, Place
from .inspection import Inspection, Medium, listed_faces
from .kinds import PRECISION, THIN_WALL

COARSEST = 3e-3
"""The largest step between neighbouring coordinates, in mean ways through a medium: from there on a ball's picture is off by
more than a hundredth (glass with water in it, 1e4 to 1e6 units away).
"""

SMALLEST = 3e-5
"""The smallest mean way through a medium that Cycles' rays get through, in scene units."""

THINNEST = 5.0
"""The thinnest wall, in distances within which surfaces count as touching."""

MOST_NAMES = 16
"""The most names of objects that one finding lists."""


def precision_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield media that are too far away, too small or too thin for single precision; one finding for all that are far away."""
    thickness = np.array([_thickness(medium) for medium in inspection.media])
    boxes = np.array([medium.place.box for medium in inspection.media]).reshape(-1, 2, 3)
    steps = np.spacing(np.abs(boxes).max(axis=(1, 2)).astype(np.float32)).astype(np.float64)
    thick = np.maximum(thickness, 1e-300)
    far = (thickness > 0.0) & (steps > COARSEST * thick)
    if far.any():
        yield _far_finding(inspection, boxes, steps, thick, np.flatnonzero(far))
    walls: dict[int, float] = {}
    reaches: dict[int, float] = {}
    named = set()
    for index in np.flatnonzero((thickness > 0.0) & ~far):
        medium = inspection.media[index]
        if medium.obj in named:
            continue
        found = (
            _small_finding(medium, thickness[index])
            or _mesh_finding(medium, thickness[index], reaches)
            or _wall_finding(medium, walls)
        )
        if found is not None:
            named.add(medium.obj)
            yield found


def _thickness(medium: Medium) -> float:
    """Return the mean length of ways through a medium, scene units; 0 where its matrix leaves no volume.

    Of what overlaps itself, whose volume may count twice or less than once, it is the smallest side of its box.
    """
    if medium.place.flat:
        return 0.0
    if medium.body.solid.overlaps_itself:
        return float(np.subtract(*medium.place.box[::-1]).min())
    return medium.body.solid.mean_chord * float(np.cbrt(abs(np.linalg.det(medium.place.matrix[:3, :3]))))


def _far_finding(
    inspection: Inspection, boxes: np.ndarray, steps: np.ndarray, thick: np.ndarray, far: np.ndarray
) -> Finding:
    """Return what is wrong with media at whose place coordinates are too coarse.

    :param boxes: (n, 2, 3) of all media; steps: (n,) between coordinates there; thick: (n,) means of ways through them; far:
        indices of those that are.
    """
    worst = far[np.argmax(steps[far] / thick[far])]
    names = list(dict.fromkeys(inspection.media[index].obj.name for index in (worst, *far)))
    middle = (boxes[:, 0].min(axis=0) + boxes[:, 1].max(axis=0)) / 2.0
    near = np.spacing(np.abs(boxes - middle).max(axis=(1, 2)).astype(np.float32))
    helps = bool((near <= COARSEST * thick)[far].all())
    text = (
        f"stands where coordinates go in steps of {steps[worst]:.2g}, too coarse for what is {thick[worst]:.2g} thick"
    )
    remedy = (
        "move all of the scene so that its media are around the origin"
        if helps
        else "bring the media nearer to each other and to the origin, or take them apart into scenes"
    )
    scene = inspection.scene
    fix = Fix(Action.MOVE_TO_ORIGIN, (scene.name,), safe=False) if helps and scene.library is None else None
    place = Place(point=tuple(boxes[worst].mean(axis=0).tolist()))
    return Finding(PRECISION, names[0], text, remedy, tuple(names[1:MOST_NAMES]), place, fix)


def _small_finding(medium: Medium, thickness: float) -> Finding | None:
    """Return what is wrong with a medium that is so small that rays do not get through it."""
    if thickness >= SMALLEST:
        return None
    text = f"is {thickness:.2g} thick, and Cycles' rays tell {SMALLEST:.2g} and more"
    remedy = f"scale all of the scene up by {SMALLEST / thickness:.2g} or more"
    place = Place(point=tuple(np.mean(medium.place.box, axis=0).tolist()))
    return Finding(PRECISION, medium.obj.name, text, remedy, place=place)


def _mesh_finding(medium: Medium, thickness: float, reaches: dict[int, float]) -> Finding | None:
    """Return what is wrong with a medium whose mesh lies far from the object's own origin.

    :param reaches: largest coordinates of solids, by id; brought up to date.
    """
    solid = medium.body.solid
    if id(solid) not in reaches:
        reaches[id(solid)] = float(np.abs(solid.vertices).max())
    scale = float(np.cbrt(abs(np.linalg.det(medium.place.matrix[:3, :3]))))
    step = scale * float(np.spacing(np.float32(reaches[id(solid)])))
    if step <= COARSEST * thickness:
        return None
    text = f"has its mesh so far from its own origin that its points go in steps of {step:.2g}"
    remedy = (
        "move the mesh to its origin (Object > Set Origin > Geometry to Origin) and model anew what has been rounded"
    )
    place = Place(point=tuple(np.mean(medium.place.box, axis=0).tolist()))
    return Finding(PRECISION, medium.obj.name, text, remedy, place=place)


def _wall_finding(medium: Medium, walls: dict[int, float]) -> Finding | None:
    """Return what is wrong with a medium whose own walls are thinner than rays tell.

    :param walls: thinnest walls of solids, by id; brought up to date.
    """
    solid, place = medium.body.solid, medium.place
    if id(solid) not in walls:
        walls[id(solid)] = thinnest_wall(solid)
    if np.isinf(walls[id(solid)]):
        return None
    size = float(np.linalg.norm(np.subtract(*place.box)))
    limit = THINNEST * (TOUCH_TOLERANCE * size + FLOAT_ROUNDING * float(np.abs(place.box).max()))
    least = walls[id(solid)] * float(np.linalg.svd(place.matrix[:3, :3], compute_uv=False)[-1])
    layer = thin_walls(place, limit) if least < limit else None
    if layer is None:
        return None
    text = f"has walls {layer.thickness.min():.2g} thin, of which rays tell {limit:.2g} and more"
    remedy = "make them thicker, or leave them out"
    point = layer.points[:, 0] - 0.5 * layer.thickness[0] * layer.normals[:, 0]
    faces = listed_faces(medium.faces[layer.faces])
    return Finding(THIN_WALL, medium.obj.name, text, remedy, place=Place(faces, tuple(point.tolist())))
