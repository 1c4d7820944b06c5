"""Fixes of objects' places: scale and rotation applied to the mesh, a scene that stands far away brought to the origin."""

from __future__ import annotations

from collections.abc import Iterable

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ..checking.finding import Fix
from ..model.parameter import ParameterError
from ..nodes.animation import curves
from ..preparation.offset_modifier import multiply_offsets
from ..scene.media import is_cut_surface, media
from .access import own_mesh, own_object, require_followers, users_of
from .mesh_fixes import keep_normals, restore_normals

TRANSFORMS = ("rotation_euler", "rotation_quaternion", "rotation_axis_angle", "rotation_mode", "scale")

SCALED_MODIFIERS = frozenset(("BEVEL", "CAST", "LATTICE", "SIMPLE_DEFORM", "SHRINKWRAP", "ARMATURE"))
"""Modifiers of those that keep a mesh closed whose result depends on its space."""

SHIFTING_CONSTRAINTS = frozenset(
    (
        "COPY_ROTATION",
        "COPY_SCALE",
        "DAMPED_TRACK",
        "FLOOR",
        "LIMIT_DISTANCE",
        "LIMIT_ROTATION",
        "LIMIT_SCALE",
        "LOCKED_TRACK",
        "MAINTAIN_VOLUME",
        "STRETCH_TO",
        "TRACK_TO",
    )
)
"""Constraints that hold what they hold where all of a scene is shifted."""

SIMULATED = frozenset(("CLOTH", "FLUID", "SOFT_BODY", "PARTICLE_SYSTEM", "DYNAMIC_PAINT"))
"""Modifiers whose caches stay where they are."""


def apply_transform(scene: bpy.types.Scene, fix: Fix) -> list[str]:
    """Apply the scale and the rotation of objects to their own meshes: nothing moves, nor do their children."""
    objects = [own_object(scene, name) for name in fix.names]
    for obj in objects:
        _require_appliable(obj)
    changes = []
    for obj in objects:
        before = obj.matrix_basis.copy()
        place = Matrix.Translation(before.translation)
        linear = place.inverted() @ before
        if np.allclose(linear, np.eye(4), atol=1e-7):
            continue
        mesh, matrix = obj.data, np.array(linear, dtype=np.float64)[:3, :3]
        keep_normals(mesh)
        mesh.transform(linear, shape_keys=True)
        if linear.is_negative:
            mesh.flip_normals()
        restore_normals(mesh, matrix)
        multiply_offsets(obj, matrix)
        obj.matrix_basis = place
        for child in _children(obj):
            child.matrix_parent_inverse = linear @ child.matrix_parent_inverse
        mesh.update()
        mesh.update_tag()
        changes.append(f"{obj.name}: scale and rotation applied")
    return changes


def _require_appliable(obj: bpy.types.Object) -> None:
    """Hold an object to one whose scale and rotation go into its mesh without a trace.

    :raises ParameterError: if they do not.
    """
    mesh = own_mesh(obj)
    name = repr(obj.name)
    if len(users_of(mesh)) > 1:
        raise ParameterError(f"{name} shares its mesh; make it single-user first (Object > Relations)")
    if abs(obj.matrix_basis.determinant()) < 1e-30:
        raise ParameterError(f"{name} has a scale of 0; give it another first")
    if obj.constraints or any(curve.data_path in TRANSFORMS for curve in curves(obj.animation_data)):
        raise ParameterError(
            f"{name} is turned or scaled by keyframes, a driver or a constraint; take those away first"
        )
    deltas = obj.delta_location.length + (obj.delta_scale - Vector((1.0, 1.0, 1.0))).length
    if deltas or not _is_unturned(obj):
        raise ParameterError(f"{name} has delta transforms; apply those first (Object > Apply)")
    require_followers(mesh)
    bent = [each.name for each in obj.modifiers if each.type in SCALED_MODIFIERS]
    if bent:
        raise ParameterError(f"{name} has the modifier {bent[0]!r}, which would do otherwise; apply it first")
    for child in _children(obj):
        if not child.is_editable:
            raise ParameterError(
                f"{child.name!r} is a child of {name} and comes from another file; make it local first"
            )
        if child.parent_type != "OBJECT":
            raise ParameterError(f"{child.name!r} hangs on a part of {name}; unparent it first")


def _is_unturned(obj: bpy.types.Object) -> bool:
    """Return whether no delta turns an object."""
    angles = obj.delta_rotation_quaternion.angle if obj.rotation_mode == "QUATERNION" else 0.0
    return angles == 0.0 and not any(obj.delta_rotation_euler)


def _children(obj: bpy.types.Object) -> list[bpy.types.Object]:
    """Return what hangs on an object, but what shows its surface cut."""
    return [child for child in bpy.data.objects if child.parent == obj and not is_cut_surface(child)]


def move_to_origin(scene: bpy.types.Scene, _: Fix) -> list[str]:
    """Move all of a scene by one vector, so that its media lie around the origin: what has no parent, and what it instances."""
    shift = -_middle_of_media(scene)
    roots = [obj for obj in scene.objects if obj.parent is None and not is_cut_surface(obj)]
    collections = {obj.instance_collection for obj in scene.objects} - {None}
    moved = {each for each in collections if set(each.all_objects) & set(scene.objects)}
    _require_movable(scene, roots, moved)
    for obj in roots:
        obj.location += shift
    for each in moved:
        each.instance_offset += shift
    for curve in _location_curves(roots):
        for key in curve.keyframe_points:
            for point in (key.co, key.handle_left, key.handle_right):
                point[1] += shift[curve.array_index]
        curve.update()
    where = ", ".join(f"{each:.4g}" for each in shift)
    return [f"{scene.name}: everything moved by ({where}), so that the media are at the origin"]


def _middle_of_media(scene: bpy.types.Scene) -> Vector:
    """Return the middle of all media, in scene units.

    :raises ParameterError: without media.
    """
    layer = scene.view_layers[0]
    layer.update()
    found = set(media(scene))
    corners = [
        tuple(instance.matrix_world @ Vector(corner))
        for instance in layer.depsgraph.object_instances
        if instance.object.original in found
        for corner in instance.object.bound_box
    ]
    if not corners:
        raise ParameterError(f"{scene.name!r} shows no medium to bring to the origin")
    box = np.array(corners)
    return Vector(0.5 * (box.min(axis=0) + box.max(axis=0)))


def _require_movable(
    scene: bpy.types.Scene, roots: Iterable[bpy.types.Object], collections: Iterable[bpy.types.Collection]
) -> None:
    """Hold a scene to one that looks the same wherever it stands, and is nobody else's.

    :raises ParameterError: if it does not.
    """
    others = [other for other in bpy.data.scenes if other != scene]
    for obj in roots:
        name = repr(obj.name)
        if not obj.is_editable:
            raise ParameterError(
                f"{name} comes from another file; make it local first (Object > Relations > Make Local)"
            )
        elsewhere = next((other for other in others if obj.name in other.objects), None)
        if elsewhere is not None and elsewhere.objects[obj.name] == obj:
            raise ParameterError(f"{name} stands in scene {elsewhere.name!r}, too; move that one by hand")
        if any(curve.data_path == "location" and curve.driver for curve in _drivers(obj)):
            raise ParameterError(f"{name} is placed by a driver; change that first")
        if obj.animation_data is not None and obj.animation_data.nla_tracks:
            raise ParameterError(f"{name} is placed by strips of the NLA editor; bake them into keyframes first")
    for obj in scene.objects:
        held = next((each for each in obj.constraints if each.type not in SHIFTING_CONSTRAINTS), None)
        if held is not None:
            raise ParameterError(f"{obj.name!r} has the constraint {held.name!r}, which may hold it; apply it first")
        if obj.rigid_body is not None or any(each.type in SIMULATED for each in obj.modifiers):
            raise ParameterError(f"{obj.name!r} is simulated; bake what it does into keyframes or a mesh first")
    for each in collections:
        if not each.is_editable or not set(each.all_objects) <= set(scene.objects):
            raise ParameterError(f"Collection {each.name!r} is instanced and stands here in part; move it by hand")
    for curve in _location_curves(roots):
        if not curve.id_data.is_editable or curve.id_data.users > 1:
            raise ParameterError(f"Action {curve.id_data.name!r} has several users; make it single-user first")
        if curve.modifiers:
            raise ParameterError(f"Action {curve.id_data.name!r} has modifiers of a location; bake them first")


def _drivers(obj: bpy.types.Object) -> Iterable[bpy.types.FCurve]:
    return () if obj.animation_data is None else obj.animation_data.drivers


def _location_curves(roots: Iterable[bpy.types.Object]) -> list[bpy.types.FCurve]:
    """Return the keyframes of objects' locations."""
    return [
        curve
        for obj in roots
        for curve in curves(obj.animation_data)
        if curve.data_path == "location" and curve.driver is None
    ]
