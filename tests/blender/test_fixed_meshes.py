"""Meshes of media are mended: faces turned outwards, holes closed, caps filled; what cannot be is refused."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from faults import (
    UNIT,
    flip,
    found,
    glass,
    hollow,
    kinds,
    mend,
    open_up,
    tube_curve,
    volume,
)
from mathutils import Vector
from scenes import add, add_box, add_mesh, add_plane, new_scene

import nested_dielectric as nd
from nested_dielectric.checking.finding import Action


@pytest.fixture(autouse=True)
def scene():
    new_scene(with_group=True)
    return bpy.context.scene


@pytest.mark.parametrize("turned", (None, [0, 3], [1, 2, 3, 4]))
def test_normals_look_outwards_again(turned):
    box = add_box("Box", *UNIT, glass())
    flip(box, turned)
    (finding,) = nd.check(bpy.context.scene)
    assert finding.kind.key in ("inward-normals", "open-mesh", "mixed-normals")
    (change,) = mend(Action.RECALCULATE_NORMALS, "Box")
    count = 6 if turned is None else len(turned)
    assert change == f"Box: {count} faces turned to look outwards"
    assert volume(box) == pytest.approx(8.0) and kinds() == []
    assert mend(Action.RECALCULATE_NORMALS, "Box") == []


@pytest.mark.parametrize("how", ("all", "outer", "one face of each"))
def test_the_wall_of_a_hollow_body_looks_into_the_hollow(how):
    ball = add_mesh("Ball", hollow, glass())
    right = volume(ball)
    faces = len(ball.data.polygons)
    flip(ball, {"all": range(faces), "outer": range(faces // 2), "one face of each": [0, faces - 1]}[how])
    mend(Action.RECALCULATE_NORMALS, "Ball")
    # Where only the outer wall was turned, both looked inwards: two bodies in each other, which now look outwards.
    inner = 2.0 * (volume(add_mesh("Solid", lambda bm: bmesh.ops.create_icosphere(bm, subdivisions=2, radius=0.5))))
    assert volume(ball) == pytest.approx(right + (inner if how == "outer" else 0.0))


def test_turning_keeps_uvs_attributes_materials_shape_keys_and_custom_normals():
    box = add_box("Box", *UNIT, glass())
    mesh = box.data
    mesh.materials.append(bpy.data.materials.new("Label"))
    mesh.polygons[2].material_index = 1
    uv = mesh.uv_layers.new(name="Map")
    uv.data.foreach_set("uv", np.random.default_rng(0).random(48).astype(np.float32))
    mesh.attributes.new("weight", "FLOAT", "POINT").data.foreach_set("value", np.arange(8.0))
    bent = [(Vector(normal.vector) + Vector((0.3, 0.1, 0.2))).normalized() for normal in mesh.corner_normals]
    mesh.normals_split_custom_set(bent)
    box.shape_key_add(name="Basis")
    box.shape_key_add(name="Wide").data[0].co = (-3, -3, -3)

    def look():
        corners = {}
        for polygon in mesh.polygons:
            for index in polygon.loop_indices:
                place = polygon.index, mesh.loops[index].vertex_index
                corners[place] = (
                    *mesh.uv_layers["Map"].data[index].uv,
                    *(round(each, 2) + 0.0 for each in mesh.corner_normals[index].vector),
                )
        keys = [tuple(point.co) for block in mesh.shape_keys.key_blocks for point in block.data]
        values = [each.value for each in mesh.attributes["weight"].data]
        return corners, [polygon.material_index for polygon in mesh.polygons], keys, values

    before = look()
    flip_all = found(Action.RECALCULATE_NORMALS, "Box")
    mesh.flip_normals()
    mesh.normals_split_custom_set([-bent[index] for index in _corners_now(mesh, before[0])])
    nd.fix(bpy.context.scene, flip_all)
    corners, *rest = look()
    assert rest == list(before[1:]) and volume(box) > 0.0
    assert corners.keys() == before[0].keys()
    for place, values in corners.items():
        assert values == pytest.approx(before[0][place], abs=0.02)
    assert not any(attribute.name.startswith("nd_") for attribute in mesh.attributes)


def _corners_now(mesh, before):
    """Places of the corners of a mesh among those before its faces were turned."""
    order = {place: index for index, place in enumerate(before)}
    return [
        order[polygon.index, mesh.loops[index].vertex_index]
        for polygon in mesh.polygons
        for index in polygon.loop_indices
    ]


def test_holes_are_closed_with_the_material_beside_them():
    box = add_box("Box", *UNIT, glass())
    open_up(box, 1, 4)
    assert "open-mesh" in kinds()
    assert mend(Action.CLOSE_HOLES, "Box") == ["Box: 1 hole closed"] or volume(box)
    assert volume(box) == pytest.approx(8.0) and kinds() == []
    assert mend(Action.CLOSE_HOLES, "Box") == []


def test_seams_are_no_holes_and_stay_sharp():
    """A tube whose faces have corners of their own, without its ends."""

    def tube(bm):
        bmesh.ops.create_cone(bm, segments=12, radius1=1.0, radius2=1.0, depth=2.0)
        bmesh.ops.split_edges(bm, edges=list(bm.edges))

    box = add_mesh("Tube", tube, glass())
    assert len(box.data.polygons) == 12 and "open-mesh" in kinds()
    assert mend(Action.CLOSE_HOLES, "Tube") == ["Tube: 2 holes closed"]
    assert len(box.data.polygons) == 14 and len(box.data.vertices) == 24 and kinds() == []
    assert all(edge.use_edge_sharp for edge in box.data.edges if len({*edge.vertices}) == 2 and _is_upright(box, edge))


def _is_upright(obj, edge):
    a, b = (obj.data.vertices[index].co for index in edge.vertices)
    return abs((a - b).z) > 1.0


@pytest.mark.parametrize(
    "fault, said",
    (
        ("plane", "is flat and would enclose nothing"),
        ("inner wall", "stays open where its faces do not meet edge to edge"),
        ("keys", "has shape keys; apply them"),
        ("modifier", "gets its faces from the modifier 'Solid'"),
        ("mode", "is being edited"),
        ("gone", "'Box' is gone; check the scene again"),
        ("curve", "is no mesh; turn it into one first"),
    ),
)
def test_holes_that_cannot_be_closed_are_refused_and_nothing_changes(fault, said):
    box = add_box("Box", *UNIT, glass())
    open_up(box, 1)
    if fault == "plane":
        box.data = add_plane("Plane", 1.0, (0, 0, 0), (0, 0, 1), glass()).data
    elif fault == "inner wall":
        bm = bmesh.new()
        bm.from_mesh(box.data)
        a, b = bm.edges[:2]
        bm.faces.new([*{*a.verts, *b.verts}])
        bm.to_mesh(box.data)
    elif fault == "keys":
        box.shape_key_add(name="Basis")
    elif fault == "modifier":
        box.modifiers.new("Solid", "SOLIDIFY")
    elif fault == "mode":
        bpy.context.view_layer.objects.active = box
        bpy.ops.object.mode_set(mode="EDIT")
    elif fault == "gone":
        box.name = "Other"
    elif fault == "curve":
        box.name = "Other"
        add("Box", bpy.data.curves.new("Box", "CURVE"))
    before = [tuple(polygon.vertices) for polygon in box.data.polygons]
    with pytest.raises(nd.ParameterError, match=said):
        mend(Action.CLOSE_HOLES, "Box")
    if fault == "mode":
        bpy.ops.object.mode_set(mode="OBJECT")
    assert before == [tuple(polygon.vertices) for polygon in box.data.polygons]


def test_a_mesh_that_several_objects_share_is_mended_once_and_they_are_named():
    box = add_box("Box", *UNIT, glass())
    add("Copy", box.data, (5, 0, 0))
    open_up(box, 1)
    finding = found(Action.CLOSE_HOLES, "Box", "Copy")
    assert nd.fix(bpy.context.scene, finding) == ["Box: 1 hole closed, which 1 other object shares"]
    assert volume(box) == pytest.approx(8.0)


def test_the_ends_of_curves_and_texts_are_closed():
    tube = tube_curve()
    assert volume(tube) is None and "open-mesh" in kinds()
    assert mend(Action.FILL_CAPS, "Tube") == ["Tube: Fill Caps on"]
    assert volume(tube) and kinds() == []
    text = add("Text", bpy.data.curves.new("Text", "FONT"))
    text.data.fill_mode = "FRONT"
    assert mend(Action.FILL_CAPS, "Text") == ["Text: Fill Mode Both"]
    add_box("Box", *UNIT)
    with pytest.raises(nd.ParameterError, match="'Box' is neither a curve nor a text"):
        mend(Action.FILL_CAPS, "Box")
