"""Scenes with one thing wrong, what a check finds there, and what is there to be changed."""

from __future__ import annotations

from collections.abc import Callable

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
from mathutils import Matrix
from scenes import add, add_box, add_mesh, diffuse

import nested_dielectric as nd
from nested_dielectric.checking import check as module
from nested_dielectric.checking.finding import Action, Finding, Fix
from nested_dielectric.checking.kinds import KINDS
from nested_dielectric.fixing import fix as fixing
from nested_dielectric.fixing import kept
from nested_dielectric.geometry import meshes
from nested_dielectric.model.parameter import PRIORITY_PROPERTY
from nested_dielectric.preparation import check_scene
from nested_dielectric.scene.shapes import evaluated_triangles, mesh_digest

UNIT = (-1, -1, -1), (1, 1, 1)


def found(action, *names, value=None, path="", kind="open-mesh", safe=True) -> Finding:
    """A finding that such a fix would mend."""
    return Finding(KINDS[kind], names[0], "is wrong", "mend it", names[1:], fix=Fix(action, names, value, path, safe))


def glass(ior: float = 1.5) -> bpy.types.Material:
    return nd.new_material("Glass", ior=ior)


def edit(obj: bpy.types.Object, change: Callable[[bmesh.types.BMesh], None]) -> None:
    """Change an object's mesh."""
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    bm.faces.ensure_lookup_table()
    change(bm)
    bm.to_mesh(obj.data)
    bm.free()


def flip(obj: bpy.types.Object, faces=None) -> None:
    """Turn faces of an object's mesh around, all if none are given."""
    edit(
        obj,
        lambda bm: bmesh.ops.reverse_faces(bm, faces=list(bm.faces) if faces is None else [bm.faces[i] for i in faces]),
    )


def open_up(obj: bpy.types.Object, *faces: int) -> None:
    """Remove faces of an object's mesh."""
    edit(obj, lambda bm: bmesh.ops.delete(bm, geom=[bm.faces[index] for index in faces], context="FACES_ONLY"))


def hollow(bm: bmesh.types.BMesh) -> None:
    """A ball with a hollow: its inner wall looks inwards."""
    bmesh.ops.create_icosphere(bm, subdivisions=2, radius=1.0)
    inner = bmesh.ops.create_icosphere(bm, subdivisions=2, radius=0.5)
    bmesh.ops.reverse_faces(bm, faces=list({face for vertex in inner["verts"] for face in vertex.link_faces}))


SIDES = 24
"""Of a vessel."""


def vessel(gap: float, scale=(1, 1, 1)) -> tuple[bpy.types.Object, bpy.types.Object]:
    """A vessel of glass with walls of 0.2 from a radius of 1 on, and water that stands a gap off its wall."""

    def tube(bm, radius, depth, matrix):
        return bmesh.ops.create_cone(
            bm, cap_ends=True, segments=SIDES, radius1=radius, radius2=radius, depth=depth, matrix=matrix
        )

    def wall(bm):
        tube(bm, 1.2, 2.4, Matrix())
        inner = tube(bm, 1.0, 2.0, Matrix())
        bmesh.ops.reverse_faces(bm, faces=list({face for vertex in inner["verts"] for face in vertex.link_faces}))

    cup = add_mesh("Cup", wall, glass(), 1)
    place = Matrix.Diagonal((*scale, 1)).inverted() @ Matrix.Translation((0, 0, -0.5 + gap))
    water = add_mesh("Water", lambda bm: tube(bm, 1.0 - gap, 1.0, place), nd.new_material("Water", ior=1.33), 2)
    water.scale = scale
    if np.prod(scale) < 0.0:
        water.data.flip_normals()
    return cup, water


def tube_curve() -> bpy.types.Object:
    """A bent tube of glass without caps."""
    curve = bpy.data.curves.new("Tube", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.2
    spline = curve.splines.new("POLY")
    spline.points.add(2)
    for index, point in enumerate(spline.points):
        point.co = (index, 0, 0, 1)
    curve.materials.append(glass())
    return add("Tube", curve)


def fault_of(action: Action) -> Finding:
    """Put something wrong into the scene that an action mends; return it as found."""
    return _FAULTS[action]()


def _box(change: Callable[[bpy.types.Object], object]) -> bpy.types.Object:
    box = add_box("Box", *UNIT, glass())
    change(box)
    return box


def _far_slot(box: bpy.types.Object) -> None:
    box.data.materials.clear()
    for index in range(9):
        box.data.materials.append(bpy.data.materials.new(f"Paint {index}"))
    box.data.materials.append(bpy.data.materials["Glass"])
    box.data.polygons.foreach_set("material_index", [9, 9, 0, 1, 9, 9])


def _with(make: Callable[[], object], action: Action, *names: str, **keywords) -> Callable[[], Finding]:
    def put() -> Finding:
        make()
        return found(action, *names, **keywords)

    return put


def _socket(name: str, value) -> Callable[[bpy.types.Object], None]:
    def put(box: bpy.types.Object) -> None:
        box.active_material.node_tree.nodes["Nested Dielectric"].inputs[name].default_value = value

    return put


def _on_table() -> None:
    add_box("Table", (-5, -5, -2), (5, 5, -1), diffuse())
    _box(lambda box: None)


def _block_on_block() -> None:
    _box(lambda box: None)
    add_box("Water", (-0.5, -0.5, 1), (0.5, 0.5, 2), nd.new_material("Water", ior=1.33, priority=50))


def _rename(box: bpy.types.Object) -> None:
    box.active_material.node_tree.nodes["Nested Dielectric"].name = "Mine"


_FAULTS = {
    Action.RECALCULATE_NORMALS: _with(lambda: _box(flip), Action.RECALCULATE_NORMALS, "Box", kind="inward-normals"),
    Action.CLOSE_HOLES: _with(lambda: _box(lambda box: open_up(box, 1)), Action.CLOSE_HOLES, "Box"),
    Action.FILL_CAPS: _with(tube_curve, Action.FILL_CAPS, "Tube"),
    Action.PUSH_INTO_WALL: _with(lambda: vessel(0.02), Action.PUSH_INTO_WALL, "Water", "Cup", value=0.05, kind="gap"),
    Action.PART_FACES: _with(_block_on_block, Action.PART_FACES, "Water", "Box", kind="coincident"),
    Action.SET_PRIORITY: _with(
        lambda: _box(lambda box: None), Action.SET_PRIORITY, "Box", value=7, kind="equal-priorities"
    ),
    Action.SET_SETTING: _with(
        lambda: _box(lambda box: None),
        Action.SET_SETTING,
        "Scene",
        value=64,
        path="cycles.max_bounces",
        kind="few-bounces",
    ),
    Action.SET_DEPTH: _with(
        lambda: _box(_socket("Transmittance Depth", 0.001)), Action.SET_DEPTH, "Box", kind="tint-strength"
    ),
    Action.SET_VALUE: _with(
        lambda: _box(_socket("IOR", -3.0)), Action.SET_VALUE, "Glass", path="IOR", kind="value-limit"
    ),
    Action.MERGE_COPIES: _with(
        lambda: add("Copy", _box(lambda box: None).data), Action.MERGE_COPIES, "Copy", kind="duplicate", safe=False
    ),
    Action.APPLY_TRANSFORM: _with(
        lambda: _box(lambda box: setattr(box, "scale", (2, 3, -4))), Action.APPLY_TRANSFORM, "Box", kind="precision"
    ),
    Action.MOVE_TO_ORIGIN: _with(
        lambda: _box(lambda box: setattr(box, "location", (1e5, 0, 0))),
        Action.MOVE_TO_ORIGIN,
        "Scene",
        kind="precision",
    ),
    Action.MOVE_APART: _with(_on_table, Action.MOVE_APART, "Box", "Table", value=0.001, kind="foreign-coincident"),
    Action.MEND_NODES: _with(lambda: _box(_rename), Action.MEND_NODES, "Glass", kind="nodes"),
    Action.MOVE_SLOT: _with(lambda: _box(_far_slot), Action.MOVE_SLOT, "Box", kind="slot-limit"),
    Action.REMOVE_PROPERTY: _with(
        lambda: _box(lambda box: box.__setitem__(PRIORITY_PROPERTY, 2000)),
        Action.REMOVE_PROPERTY,
        "Box",
        path=PRIORITY_PROPERTY,
        kind="bad-priority",
    ),
    Action.PREPARE: _with(lambda: _box(lambda box: None), Action.PREPARE, "Scene", kind="settings"),
}


def state() -> dict[str, object]:
    """What of the open file fixes may change."""
    scene = bpy.context.scene
    result: dict[str, object] = {
        "scene": (
            scene.render.engine,
            scene.cycles.max_bounces,
            {key: str(value) for key, value in scene.items()},
        )
    }
    for obj in scene.objects:
        result[obj.name] = (
            tuple(map(tuple, obj.matrix_basis)),
            tuple(modifier.name for modifier in obj.modifiers),
            {key: str(value) for key, value in obj.items()},
            (obj.hide_render, obj.hide_viewport),
            [slot.material and slot.material.name for slot in obj.material_slots],
            mesh_digest(obj.data) if obj.type == "MESH" else getattr(obj.data, "use_fill_caps", None),
        )
    for material in bpy.data.materials:
        node = material.node_tree.nodes.get("Nested Dielectric")
        values = () if node is None else [each.default_value for each in node.inputs if each.type in ("VALUE", "INT")]
        result[f"material {material.name}"] = ([each.name for each in material.node_tree.nodes], values)
    return result


def mend(action, *names, **keywords) -> list[str]:
    """Mend the scene as a finding would have it; return what was changed."""
    return nd.fix(bpy.context.scene, found(action, *names, **keywords))


def kinds() -> list[str]:
    """What a check of the scene finds."""
    return [finding.kind.key for finding in nd.check(bpy.context.scene)]


def volume(obj):
    """Of a closed mesh; nothing of an open one."""
    bpy.context.view_layer.update()
    vertices, triangles = evaluated_triangles(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    joined = meshes.same_places(vertices)[triangles]
    return None if meshes.open_edge_count(joined) else meshes.signed_volume(vertices.astype(float), triangles)


def world_points(obj):
    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    return np.array([tuple(evaluated.matrix_world @ vertex.co) for vertex in evaluated.data.vertices])


def with_fixes(monkeypatch, *pairs):
    """Let checks give fixes for kinds that are found: those of other checks may have none yet."""
    by_kind = dict(pairs)

    def check(scene):
        result = []
        for finding in module.check(scene):
            action, safe = by_kind.get(finding.kind.key, (None, True))
            value = Fix(action, (finding.name,), safe=safe) if action else None
            result.append(Finding(finding.kind, finding.name, finding.text, finding.remedy, fix=value))
        return result

    for each in (fixing, kept, check_scene):
        monkeypatch.setattr(each, "check", check)
