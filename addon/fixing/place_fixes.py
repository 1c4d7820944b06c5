"""Fixes of where surfaces lie: pushed into a wall, moved off what is no medium, parted, or all brought to the origin."""

from __future__ import annotations

from collections import Counter

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..analysis.mesh_modifiers import is_offset
from ..analysis.surroundings import clear_analysis
from ..analysis.validity import is_analysed
from ..checking.coincident_checks import coincident_findings
from ..checking.finding import Fix
from ..checking.inspection import inspect
from ..geometry.coincident_faces import least_squares_offsets
from ..geometry.coplanar import flat_sides
from ..geometry.solids import Solid
from ..geometry.surfaces import FLOAT_ROUNDING
from ..model.parameter import ParameterError
from ..nodes.animation import curves
from ..preparation.live import analyse
from ..preparation.offset_modifier import add_offset
from ..preparation.separate_faces import separate_coincident_faces, users_of_attributes
from ..scene.media import HIDDEN_BY_CUT
from ..scene.ray_visibility import show
from ..scene.shapes import evaluated_triangles
from .access import length_in, own_object, require_plain_points, shown_object

TOWARDS = 0.5
"""Cosine from which on a face and the wall that it is pushed into look against each other."""

BESIDE = 0.99
"""Cosine of the largest angle between a face and another that it lies on."""


def push_into_wall(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Move the faces of a liquid that lie before walls outwards by a distance, by a modifier that can be taken off again."""
    liquid, distance = own_object(scene, fix.names[0]), length_in(fix)
    require_plain_points(liquid)
    walls = [shown_object(scene, name) for name in fix.names[1:]]
    names = ", ".join(repr(wall.name) for wall in walls)
    vertices, triangles, normals = _in_world(scene, liquid)
    trees = [_tree(scene, wall) for wall in walls]
    near, thin = np.zeros((2, len(triangles)), dtype=bool)
    for index, (corners, normal) in enumerate(zip(vertices[triangles], normals)):
        depths = [_depth(tree, corners, Vector(normal), distance) for tree in trees]
        near[index] = any(depth is not None for depth in depths)
        thin[index] = any(
            depth is not None and _comes_out(tree, corners.mean(axis=0), Vector(normal), depth, distance)
            for tree, depth in zip(trees, depths)
        )
    if not near.any():
        raise ParameterError(
            f"{liquid.name!r} has no faces within {distance:.3g} before {names}; make it as large as its vessel by hand"
        )
    if thin.any():
        raise ParameterError(f"{liquid.name!r} would come out of {names}, whose wall is thinner than {distance:.3g}")
    near = _whole_sides(vertices, triangles, near)
    heights = np.full(np.count_nonzero(near), distance)
    _offset(scene, liquid, least_squares_offsets(len(vertices), triangles[near], normals[near], heights))
    return [f"{liquid.name}: pushed {distance:.3g} into {names} (modifier {_modifier_name(liquid)!r})"]


def move_apart(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Move the faces of a medium that lie on something off it by a distance, by a modifier that can be taken off again.

    Where modifiers make the faces, the whole object moves.
    """
    medium, distance = own_object(scene, fix.names[0]), length_in(fix)
    others = [shown_object(scene, name) for name in fix.names[1:]]
    names = ", ".join(repr(other.name) for other in others)
    vertices, triangles, normals = _in_world(scene, medium)
    near = _lying_on(vertices, triangles, normals, [_in_world(scene, other) for other in others], distance)
    if not near.any():
        raise ParameterError(f"{medium.name!r} has no faces on {names} any more; check the scene again")
    try:
        require_plain_points(medium)
    except ParameterError:
        _move_object(medium, _away_from(medium, normals[near], distance))
        return [f"{medium.name}: moved {distance:.3g} off {names}"]
    near = _whole_sides(vertices, triangles, near)
    heights = np.full(np.count_nonzero(near), -distance)
    _offset(scene, medium, least_squares_offsets(len(vertices), triangles[near], normals[near], heights))
    return [f"{medium.name}: faces moved {distance:.3g} off {names} (modifier {_modifier_name(medium)!r})"]


def part_faces(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Part the faces of media that lie in the same place, as preparing the scene does."""
    for name in fix.names:
        shown_object(scene, name)
    was_analysed = is_analysed(scene)
    analyse(scene)
    changes = separate_coincident_faces(scene)
    left = [] if changes else list(coincident_findings(inspect(scene, just_analysed=True)))
    if not was_analysed:
        clear_analysis(scene)
    if left:
        raise ParameterError(str(next((each for each in left if each.name in fix.names), left[0])))
    return changes


def hide_copies(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Hide objects that are the same as another in the same place, in viewports and renders."""
    copies = [own_object(scene, name) for name in fix.names]
    for copy in copies:
        if any(curve.data_path in ("hide_render", "hide_viewport") for curve in curves(copy.animation_data)):
            raise ParameterError(f"{copy.name!r} has keyframes or a driver that show and hide it; delete it by hand")
    changes = []
    for copy in copies:
        if not (copy.hide_render and copy.hide_viewport) or HIDDEN_BY_CUT in copy:
            show(copy)
            copy.pop(HIDDEN_BY_CUT, None)
            copy.hide_render = copy.hide_viewport = True
            changes.append(f"{copy.name}: hidden in viewports and renders")
    return changes


def _in_world(scene: bpy.types.Scene, obj: bpy.types.Object) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return an evaluated object's vertices in the world, (n, 3) float64, its triangles, and their unit normals, outwards."""
    layer = scene.view_layers[0]
    layer.update()
    evaluated = obj.evaluated_get(layer.depsgraph)
    vertices, triangles = evaluated_triangles(evaluated)
    matrix = np.array(evaluated.matrix_world, dtype=np.float64)
    if np.linalg.det(matrix[:3, :3]) < 0.0:
        triangles = triangles[:, ::-1]
    vertices = vertices.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    a, b, c = vertices[triangles].swapaxes(0, 1)
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return vertices, triangles, normals


def _tree(scene: bpy.types.Scene, obj: bpy.types.Object) -> BVHTree:
    vertices, triangles, _ = _in_world(scene, obj)
    return BVHTree.FromPolygons(vertices.tolist(), triangles.tolist(), all_triangles=True)


def _depth(tree: BVHTree, corners: np.ndarray, normal: Vector, reach: float) -> float | None:
    """Return how deep a triangle lies in a wall that looks against it, negative before it; None where none is in reach."""
    middle = corners.mean(axis=0)
    for point in map(Vector, (middle, *(0.5 * (corners + np.roll(corners, 1, axis=0))))):
        place, against, _, distance = tree.find_nearest(point, reach)
        if place is None or against.dot(normal) > -TOWARDS:
            continue
        ahead = (place - point).dot(normal)
        if abs(ahead) >= TOWARDS * distance:
            return -ahead
    return None


def _comes_out(tree: BVHTree, point: np.ndarray, normal: Vector, depth: float, way: float) -> bool:
    """Return whether a point that lies so deep in a wall comes out of it on a way along a normal."""
    rounding = 4.0 * FLOAT_ROUNDING * float(np.abs(point).max()) + 1e-3 * way
    before = max(depth, 0.0) + rounding
    start, left, met = Vector(point) - before * normal, way + before, 0
    while left > 0.0 and (hit := tree.ray_cast(start, normal, left))[0] is not None:
        met += 1
        step = hit[3] + rounding
        start, left = start + step * normal, left - step
    return met > 1


def _lying_on(
    vertices: np.ndarray,
    triangles: np.ndarray,
    normals: np.ndarray,
    others: list[tuple[np.ndarray, np.ndarray, np.ndarray]],
    reach: float,
) -> np.ndarray:
    """Return which triangles lie on others' faces, or these on them, within a distance, (m,) bool."""
    own = BVHTree.FromPolygons(vertices.tolist(), triangles.tolist(), all_triangles=True)
    result = np.zeros(len(triangles), dtype=bool)
    for points, faces, directions in others:
        tree = BVHTree.FromPolygons(points.tolist(), faces.tolist(), all_triangles=True)
        for index, middle in enumerate(vertices[triangles].mean(axis=1)):
            _, normal, _, _ = tree.find_nearest(Vector(middle), reach)
            result[index] |= normal is not None and abs(normal.dot(Vector(normals[index]))) >= BESIDE
        for middle, direction in zip(points[faces].mean(axis=1), directions):
            _, normal, index, _ = own.find_nearest(Vector(middle), reach)
            if normal is not None and abs(normal.dot(Vector(direction))) >= BESIDE:
                result[index] = True
    return result


def _whole_sides(vertices: np.ndarray, triangles: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Return some triangles and all that lie in a flat side with any of them, (m,) bool."""
    sides = flat_sides(Solid(vertices, triangles))
    return np.isin(sides, sides[chosen])


def _offset(scene: bpy.types.Scene, obj: bpy.types.Object, offsets: np.ndarray) -> None:
    """Move an object's points by vectors of the world, (n, 3), where they show."""
    linear = np.array(obj.evaluated_get(scene.view_layers[0].depsgraph).matrix_world, dtype=np.float64)[:3, :3]
    add_offset(obj, offsets @ np.linalg.inv(linear).T, Counter(users_of_attributes()))


def _modifier_name(obj: bpy.types.Object) -> str:
    return next(filter(is_offset, obj.modifiers)).name


def _away_from(obj: bpy.types.Object, normals: np.ndarray, distance: float) -> np.ndarray:
    """Return the shortest way by which faces that look along some normals rise off what they lie on, (3,) in the world.

    :raises ParameterError: if they lie on it on both sides.
    """
    way = np.linalg.lstsq(normals, np.full(len(normals), -distance), rcond=1e-3)[0]
    if (normals @ way > -0.5 * distance).any():
        raise ParameterError(f"{obj.name!r} lies between what it touches; make it smaller, or let them overlap")
    return way


def _move_object(obj: bpy.types.Object, way: np.ndarray) -> None:
    """Move an object in the world.

    :raises ParameterError: if keyframes, drivers or constraints place it.
    """
    if obj.constraints or any(curve.data_path.endswith("location") for curve in curves(obj.animation_data)):
        raise ParameterError(f"{obj.name!r} is placed by keyframes, a driver or a constraint; move those")
    to_local = (obj.matrix_world @ obj.matrix_basis.inverted()).to_3x3().inverted()
    obj.location += to_local @ Vector(way)
