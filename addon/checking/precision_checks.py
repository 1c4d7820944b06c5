"""Checks of media for which single precision is too coarse: far from the origin, very small, or with walls too thin."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ..geometry.gaps import thin_walls, thinnest_wall
from ..geometry.solids import Solid
from ..geometry.surfaces import TOUCH_TOLERANCE
from ..model.contract import FLOAT_SPACING, PRECISION_LIMIT
from .finding import Action, Finding, Fix, Place
from .inspection import Inspection, Medium, listed_faces
from .kinds import PRECISION, THIN_WALL

COARSEST = 6e-4
"""The largest step between neighbouring coordinates, in diagonals of a medium's box: beyond, a ball's picture is off by more
than a hundredth (glass with water in it, 2e4 to 1e6 units away), and walls show the alarm.
"""

SMALLEST = 3e-5
"""The smallest mean way through a medium that Cycles' rays get through, in scene units."""

ALARM = PRECISION_LIMIT * FLOAT_SPACING
"""The least thickness behind a surface, in its largest coordinate, with which the shader shows no alarm."""

MOST_NAMES = 16
"""The most names of objects that one finding lists."""


@dataclass(frozen=True, eq=False)
class _Measures:
    """What is measured of n media.

    :ivar boxes: (n, 2, 3) in the world; sizes: (n,) their diagonals.
    :ivar thick: (n,) mean lengths of ways through them, scene units; infinite where a matrix leaves no volume.
    :ivar steps: (n,) between neighbouring coordinates in the world; mesh_steps: in their meshes, as large as they show.
    :ivar walls: (n,) thickness of their thinnest walls in their own units.
    """

    boxes: np.ndarray
    sizes: np.ndarray
    thick: np.ndarray
    steps: np.ndarray
    mesh_steps: np.ndarray
    walls: np.ndarray


def _measures(media: Sequence[Medium]) -> _Measures:
    """Measure media; each mesh is looked at once."""
    solids = {id(medium.body.solid): medium.body.solid for medium in media}
    known = {
        key: (_own_thickness(solid), float(np.abs(solid.vertices).max()), thinnest_wall(solid))
        for key, solid in solids.items()
    }
    own_thickness, reach, walls = np.array([known[id(medium.body.solid)] for medium in media]).T
    linear = np.array([medium.place.matrix[:3, :3] for medium in media])
    boxes = np.array([medium.place.box for medium in media])
    volume = np.abs(np.linalg.det(linear))
    flat = volume <= 1e-12 * np.prod(np.linalg.norm(linear, axis=1), axis=1)
    scales = np.cbrt(volume)
    sizes = np.where(flat, np.inf, np.linalg.norm(boxes[:, 1] - boxes[:, 0], axis=1))
    thick = np.where(flat, np.inf, np.maximum(scales * own_thickness, 1e-300))
    return _Measures(boxes, sizes, thick, _steps(np.abs(boxes).max(axis=(1, 2))), scales * _steps(reach), walls)


def _own_thickness(solid: Solid) -> float:
    """Return the mean length of ways through a solid in its own units.

    Of what overlaps itself, whose volume may count twice or less than once, it is the smallest side of its box.
    """
    if solid.overlaps_itself:
        return float(np.ptp(solid.vertices, axis=0).min())
    return solid.mean_chord


def _steps(coordinates: np.ndarray) -> np.ndarray:
    """Return how far single precision has the next number from some coordinates."""
    return np.spacing(coordinates.astype(np.float32)).astype(np.float64)


def precision_findings(inspection: Inspection) -> Iterator[Finding]:
    """Yield media that are too far away, too small or too thin for single precision; one finding for all that are far away."""
    if not inspection.media:
        return
    measures = _measures(inspection.media)
    far = measures.steps > COARSEST * measures.sizes
    if far.any():
        yield _far_finding(inspection, measures, np.flatnonzero(far))
    small = measures.thick < SMALLEST
    coarse = measures.mesh_steps > COARSEST * measures.sizes
    named = set()
    for index in np.flatnonzero(~far & (small | coarse | np.isfinite(measures.walls))):
        medium = inspection.media[index]
        if medium.obj in named:
            continue
        if small[index]:
            found = _small_finding(medium, float(measures.thick[index]))
        elif coarse[index]:
            found = _mesh_finding(medium, float(measures.mesh_steps[index]))
        else:
            found = _wall_finding(medium, float(measures.walls[index]), inspection.scene)
        if found is not None:
            named.add(medium.obj)
            yield found


def _far_finding(inspection: Inspection, measures: _Measures, far: np.ndarray) -> Finding:
    """Return what is wrong with media at whose place coordinates are too coarse.

    :param far: indices of those.
    """
    boxes, steps, sizes = measures.boxes, measures.steps, measures.sizes
    worst = far[np.argmax(steps[far] / sizes[far])]
    names = list(dict.fromkeys(inspection.media[index].obj.name for index in (worst, *far)))
    middle = (boxes[:, 0].min(axis=0) + boxes[:, 1].max(axis=0)) / 2.0
    near = np.maximum(_steps(np.abs(boxes - middle).max(axis=(1, 2))), measures.mesh_steps)
    helps = bool((near <= COARSEST * sizes)[far].all())
    text = (
        f"stands where coordinates go in steps of {steps[worst]:.2g}, too coarse for what is {sizes[worst]:.2g} large"
    )
    remedy = (
        "move all of the scene so that its media are around the origin"
        if helps
        else "bring the media nearer to each other and to the origin, or take them apart into scenes"
    )
    fix = _move_to_origin(inspection.scene) if helps else None
    place = Place(point=tuple(boxes[worst].mean(axis=0).tolist()))
    return Finding(PRECISION, names[0], text, remedy, tuple(names[1:MOST_NAMES]), place, fix)


def _small_finding(medium: Medium, thickness: float) -> Finding:
    """Return that a medium is so small that rays do not get through it."""
    text = f"is {thickness:.2g} thick, and Cycles' rays tell {SMALLEST:.2g} and more"
    remedy = f"scale all of the scene up by {SMALLEST / thickness:.2g} or more"
    return Finding(PRECISION, medium.obj.name, text, remedy, place=_middle(medium))


def _mesh_finding(medium: Medium, step: float) -> Finding:
    """Return that the mesh of a medium lies far from the object's own origin.

    :param step: between neighbouring coordinates of its points, scene units.
    """
    text = f"has its mesh so far from its own origin that its points go in steps of {step:.2g}"
    remedy = (
        "move the mesh to its origin (Object > Set Origin > Geometry to Origin) and model anew what has been rounded"
    )
    return Finding(PRECISION, medium.obj.name, text, remedy, place=_middle(medium))


def _middle(medium: Medium) -> Place:
    """Return the middle of a medium's box as a place."""
    return Place(point=tuple(np.mean(medium.place.box, axis=0).tolist()))


def _wall_finding(medium: Medium, wall: float, scene: bpy.types.Scene) -> Finding | None:
    """Return what is wrong with a medium whose own walls are thinner than rays tell.

    That is so where they are thinner than what counts as touching in bodies of that size, or than the alarm allows there.

    :param wall: the thickness of the thinnest in its own units.
    """
    place = medium.place
    of_size = TOUCH_TOLERANCE * float(np.linalg.norm(np.subtract(*place.box)))
    of_place = ALARM * float(np.abs(place.box).max())
    least = wall * float(np.linalg.svd(place.matrix[:3, :3], compute_uv=False)[-1])
    limit = max(of_size, of_place)
    layer = thin_walls(place, limit) if least < limit else None
    if layer is None:
        return None
    thin = float(layer.thickness.min())
    kind, fix = THIN_WALL, None
    text = f"has walls {thin:.2g} thin, of which rays tell {limit:.2g} and more"
    remedy = "make them thicker, or leave them out"
    half = 0.5 * float(np.subtract(*place.box[::-1]).max())
    if thin > of_size and thin > ALARM * half:
        kind, text = PRECISION, f"{text} so far from the origin"
        remedy = "move all of the scene so that its media are around the origin, or make them thicker"
        fix = _move_to_origin(scene)
    point = layer.points[:, 0] - 0.5 * layer.thickness[0] * layer.normals[:, 0]
    faces = listed_faces(medium.faces[layer.faces])
    return Finding(kind, medium.obj.name, text, remedy, place=Place(faces, tuple(point.tolist())), fix=fix)


def _move_to_origin(scene: bpy.types.Scene) -> Fix | None:
    """Return what brings a scene to the origin."""
    return Fix(Action.MOVE_TO_ORIGIN, (scene.name,), safe=False) if scene.library is None else None
