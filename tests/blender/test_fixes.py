"""What a check finds is mended: each action, what it keeps, what it refuses, and that one undo takes it back."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from faults import SIDES, UNIT, fault_of, flip, found, glass, hollow, open_up, state, tube_curve, vessel
from mathutils import Vector
from scenes import add, add_box, add_camera, add_mesh, add_plane, add_sphere, diffuse, empty_file, mostly_again

import nested_dielectric as nd
from nested_dielectric.analysis.mesh_modifiers import is_offset
from nested_dielectric.analysis.validity import is_analysed
from nested_dielectric.checking.finding import Action, Finding, Fix
from nested_dielectric.checking.kinds import KINDS
from nested_dielectric.fixing.fix import ACTIONS
from nested_dielectric.fixing.words import in_words
from nested_dielectric.geometry import meshes
from nested_dielectric.model.parameter import PRIORITY_PROPERTY
from nested_dielectric.preparation.prepare_scene import put_back
from nested_dielectric.preparation.report import keep_findings, last_report
from nested_dielectric.scene.media import get_priority
from nested_dielectric.scene.shapes import evaluated_triangles
from nested_dielectric.ui.operators import problem_operators


@pytest.fixture(autouse=True)
def scene():
    empty_file(with_group=True)
    return bpy.context.scene


def mend(action, *names, **keywords):
    return nd.fix(bpy.context.scene, found(action, *names, **keywords))


def kinds():
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


def test_each_action_has_a_function_and_words_and_those_that_need_names_refuse_none(scene):
    assert set(ACTIONS) == set(Action)
    for action in Action:
        text = in_words(scene, Fix(action, ("Glass", "Table"), 0.5, "cycles.max_bounces"))
        assert text[0].isupper() and "{" not in text and not text.endswith(".")
    assert in_words(scene, Fix(Action.SET_PRIORITY, ("Glass",), 1)) == "Give 'Glass' the priority 1"
    with pytest.raises(nd.ParameterError, match="does not say what to change"):
        nd.fix(scene, Finding(KINDS["gap"], "Glass", "", "", fix=Fix(Action.PUSH_INTO_WALL, ("Glass",), 1.0)))
    with pytest.raises(nd.ParameterError, match="'Glass' is open: close it"):
        nd.fix(scene, Finding(KINDS["open-mesh"], "Glass", "is open", "close it"))


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


@pytest.mark.parametrize("scale", mostly_again(((1, 1, 1), (-2, 1, 0.5))))
def test_a_liquid_is_pushed_into_its_wall_and_its_surface_stays(scale):
    gap, overlap = 0.02, 0.03
    _, water = vessel(gap, scale)
    before = world_points(water)
    (change,) = mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=gap + overlap, kind="gap")
    assert change == f"Water: pushed 0.05 into 'Cup' (modifier {water.modifiers[0].name!r})"
    after = world_points(water)
    radius, below = np.linalg.norm(after[:, :2], axis=1), before[:, 2] < -0.5
    # The faces rise by the distance, so their corners by a little more.
    assert radius == pytest.approx(1.0 - gap + (gap + overlap) / np.cos(np.pi / SIDES), abs=1e-4)
    assert after[below, 2] == pytest.approx(before[below, 2] - gap - overlap, abs=1e-5)
    assert after[~below, 2] == pytest.approx(before[~below, 2], abs=1e-6)
    assert is_offset(water.modifiers[0])
    assert "Water: faces are where they were" in put_back(bpy.context.scene)
    assert world_points(water) == pytest.approx(before)


def test_a_liquid_is_not_pushed_through_its_wall_nor_where_there_is_none():
    _, water = vessel(0.02)
    with pytest.raises(nd.ParameterError, match="would come out of 'Cup', whose wall is thinner than"):
        mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=0.5)
    with pytest.raises(nd.ParameterError, match="has no faces within"):
        mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=0.01)
    for value in (None, -1.0, float("nan"), "x", True):
        with pytest.raises(nd.ParameterError, match="needs a distance"):
            mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=value)
    water.modifiers.new("Smooth", "SUBSURF")
    with pytest.raises(nd.ParameterError, match="gets its points from the modifier 'Smooth'; apply it first"):
        mend(Action.PUSH_INTO_WALL, "Water", "Cup", value=0.05)
    assert len(water.modifiers) == 1


@pytest.mark.parametrize("prepared", (False, True))
def test_coincident_faces_are_parted_and_an_unprepared_scene_stays_unprepared(prepared, scene):
    add_box("Ice", *UNIT, nd.new_material("Ice", ior=1.31), 1)
    water = add_box("Water", (-0.5, -0.5, 1), (0.5, 0.5, 2), nd.new_material("Water", ior=1.33), 2)
    if prepared:
        nd.prepare(scene)
        put_back(scene)
        nd.analyse(scene)
    (change,) = mend(Action.PART_FACES, "Water", "Ice", kind="coincident")
    assert "parted from 'Ice'" in change and world_points(water)[:, 2].min() < 1.0 - 1e-5
    assert is_analysed(scene) == prepared
    assert mend(Action.PART_FACES, "Water", "Ice", kind="coincident") == []


def test_what_stands_on_no_medium_is_moved_off_it():
    table = add_box("Table", (-5, -5, -1), (5, 5, 0), diffuse())
    cup = add_box("Cup", (-1, -1, 0), (1, 1, 2), glass())
    (finding,) = nd.check(bpy.context.scene)
    assert finding.kind.key == "foreign-coincident"
    (change,) = mend(Action.MOVE_APART, "Cup", "Table", value=0.001)
    assert change.startswith("Cup: faces moved 0.001 off 'Table'")
    points = world_points(cup)
    assert points.min(axis=0) == pytest.approx((-1, -1, 0.001), abs=1e-6)
    assert points.max(axis=0) == pytest.approx((1, 1, 2)) and kinds() == []
    assert world_points(table)[:, 2].max() == 0.0
    with pytest.raises(nd.ParameterError, match="has no faces on 'Table' any more"):
        mend(Action.MOVE_APART, "Cup", "Table", value=0.0001)


def test_what_modifiers_make_is_moved_as_a_whole_unless_it_lies_between():
    add_box("Table", (-5, -5, -1), (5, 5, 0), diffuse())
    cup = add_box("Cup", (-1, -1, 0), (1, 1, 2), glass())
    bevel = cup.modifiers.new("Bevel", "BEVEL")
    bevel.width = 0.1
    root = add("Root", None)
    root.scale = (2, 2, 2)
    bpy.context.view_layer.update()
    cup.parent = root
    cup.matrix_parent_inverse = root.matrix_world.inverted()
    assert mend(Action.MOVE_APART, "Cup", "Table", value=0.001) == ["Cup: moved 0.001 off 'Table'"]
    assert world_points(cup)[:, 2].min() == pytest.approx(0.001, abs=1e-6)
    cup.location.z -= 0.001
    add_box("Shelf", (-5, -5, 2), (5, 5, 3), diffuse())
    with pytest.raises(nd.ParameterError, match="'Cup' lies between what it touches"):
        mend(Action.MOVE_APART, "Cup", "Table", "Shelf", value=0.001)
    cup.keyframe_insert("location", frame=1)
    with pytest.raises(nd.ParameterError, match="is placed by keyframes"):
        mend(Action.MOVE_APART, "Cup", "Table", value=0.001)


def test_priorities_of_objects_and_materials_are_set():
    material = glass()
    box = add_box("Box", *UNIT, material)
    before = get_priority(box)
    assert mend(Action.SET_PRIORITY, "Box", value=7) == [f"Box: priority {before} -> 7"]
    assert mend(Action.SET_PRIORITY, "Glass", value=9) == [f"Glass: priority {before} -> 9"]
    assert get_priority(box) == 7 == box[PRIORITY_PROPERTY]
    assert mend(Action.REMOVE_PROPERTY, "Box", path=PRIORITY_PROPERTY) == [
        f"Box: custom property {PRIORITY_PROPERTY!r} removed"
    ]
    assert get_priority(box) == 9 and mend(Action.REMOVE_PROPERTY, "Box", path=PRIORITY_PROPERTY) == []
    box["note"] = 1
    with pytest.raises(nd.ParameterError, match="'note' is no property of nested dielectrics"):
        mend(Action.REMOVE_PROPERTY, "Box", path="note")
    for value in (None, 1.5, 2000, True, "3"):
        with pytest.raises(nd.ParameterError, match="A priority is a whole number"):
            mend(Action.SET_PRIORITY, "Box", value=value)
    material.node_tree.nodes["Nested Dielectric"].inputs["Priority"].keyframe_insert("default_value", frame=1)
    with pytest.raises(nd.ParameterError, match="'Glass' has keyframes or a driver of its priority"):
        mend(Action.SET_PRIORITY, "Box", "Glass", value=3)
    assert PRIORITY_PROPERTY not in box


def test_settings_are_set_and_put_back_takes_them_back(scene):
    for path, value, words in (
        ("cycles.max_bounces", 64, "Max Bounces: 12 -> 64"),
        ("render.engine", "CYCLES", "Render Engine: EEVEE -> Cycles"),
        ("render.use_motion_blur", True, "Motion Blur: off -> on"),
        ("render.use_simplify", True, "Use Simplify: off -> on"),
    ):
        assert mend(Action.SET_SETTING, scene.name, value=value, path=path) == [words]
        assert mend(Action.SET_SETTING, scene.name, value=value, path=path) == []
    assert {"Max Bounces: 64 -> 12", "Render Engine: Cycles -> EEVEE"} <= {*put_back(scene)}
    for path, value, said in (
        ("render.filepath", "/tmp/x", "is no setting of how a scene renders"),
        ("world.name", "x", "is no setting"),
        ("name", "x", "is no setting"),
        ("cycles.max_bounces", "many", "cannot be 'many'"),
        ("cycles.device", "TOASTER", "cannot be 'TOASTER'"),
    ):
        with pytest.raises(nd.ParameterError, match=said):
            mend(Action.SET_SETTING, scene.name, value=value, path=path)


def test_the_depth_of_a_colour_is_fitted_to_its_objects():
    material = nd.new_material("Wine", preset="wine_red")
    socket = material.node_tree.nodes["Nested Dielectric"].inputs["Transmittance Depth"]
    add_sphere("Ball", 3.0, material)
    socket.default_value = 0.001
    (change,) = mend(Action.SET_DEPTH, "Ball", kind="tint-strength")
    # The mean way through a ball is 4/3 of its radius.
    assert change.startswith("Wine: Transmittance Depth 0.001 -> ") and socket.default_value == pytest.approx(
        4.0, rel=0.01
    )
    assert mend(Action.SET_DEPTH, "Ball", kind="tint-strength") == []
    mend(Action.SET_DEPTH, "Ball", value=2.0, kind="tint-strength")
    assert socket.default_value == 2.0
    socket.keyframe_insert("default_value", frame=1)
    with pytest.raises(nd.ParameterError, match="'Wine': other nodes, keyframes or a driver set"):
        mend(Action.SET_DEPTH, "Ball", kind="tint-strength")


def test_values_beyond_their_limits_become_what_they_count_as():
    material = glass()
    add_box("Box", *UNIT, material)
    inputs = material.node_tree.nodes["Nested Dielectric"].inputs
    inputs["IOR"].default_value = -3.0
    inputs["Transmittance"].default_value = (2.0, 0.5, 0.0, 1.0)
    assert kinds() == ["value-limit"] * 2
    (change,) = mend(Action.SET_VALUE, "Glass", path="IOR", kind="value-limit")
    assert change.startswith("Glass: IOR -3 -> ")
    (change,) = mend(Action.SET_VALUE, "Glass", path="Transmittance", kind="value-limit")
    assert change == "Glass: Transmittance (2, 0.5, 0) -> (1, 0.5, 0)" and kinds() == []
    with pytest.raises(nd.ParameterError, match="'Colour' is no value of a nested dielectric"):
        mend(Action.SET_VALUE, "Glass", path="Colour")
    with pytest.raises(nd.ParameterError, match="Material 'Gone' is gone"):
        mend(Action.SET_VALUE, "Gone", path="IOR")


def test_nodes_are_mended_so_that_neighbours_read_them():
    material = glass()
    add_box("Box", *UNIT, material)
    material.node_tree.nodes["Nested Dielectric"].name = "Mine"
    material.use_transparent_shadow = False
    assert "nodes" in kinds()
    changes = mend(Action.MEND_NODES, "Glass", kind="nodes")
    assert len(changes) == 2 and kinds() == [] and mend(Action.MEND_NODES, "Glass", kind="nodes") == []


def test_a_medium_in_a_far_slot_moves_to_one_that_neighbours_read_and_faces_keep_their_materials():
    box = add_box("Box", *UNIT)
    for index in range(9):
        box.data.materials.append(bpy.data.materials.new(f"Paint {index}"))
    box.data.materials.append(glass())
    box.data.polygons.foreach_set("material_index", [9, 9, 0, 1, 9, 9])
    box.material_slots[0].link = "OBJECT"
    box.material_slots[0].material = bpy.data.materials["Paint 5"]

    def shown():
        return [box.material_slots[polygon.material_index].material.name for polygon in box.data.polygons]

    before = shown()
    assert "slot-limit" in kinds()
    assert mend(Action.MOVE_SLOT, "Box", kind="slot-limit") == ["Box: slots 1 and 10 exchanged"]
    assert shown() == before and "slot-limit" not in kinds()
    with pytest.raises(nd.ParameterError, match="has no nested dielectric in a far slot any more"):
        mend(Action.MOVE_SLOT, "Box", kind="slot-limit")


def test_copies_are_hidden_not_deleted():
    add_box("Box", *UNIT, glass())
    copy = add("Copy", bpy.data.objects["Box"].data)
    assert mend(Action.MERGE_COPIES, "Copy", kind="duplicate") == ["Copy: hidden in viewports and renders"]
    assert copy.hide_render and copy.hide_viewport and mend(Action.MERGE_COPIES, "Copy", kind="duplicate") == []
    copy.hide_render = False
    copy.keyframe_insert("hide_render", frame=1)
    with pytest.raises(nd.ParameterError, match="keyframes or a driver that show and hide it"):
        mend(Action.MERGE_COPIES, "Copy", kind="duplicate")


@pytest.mark.parametrize("scale", ((1e-3, 2e-3, 5e-3), (-1.0, 1.0, 3.0)))
def test_scale_and_rotation_are_applied_and_nothing_moves(scale):
    box = add_mesh("Box", hollow, glass())
    root = add("Root", None, (1, 2, 3))
    root.rotation_euler = (0.3, 0.2, 0.1)
    box.parent = root
    box.location, box.rotation_euler, box.scale = (1, 0, 2), (0.5, 1.0, 0.2), scale
    child = add("Child", None, (1, 1, 1))
    child.parent = box
    bpy.context.view_layer.update()
    normals = [Vector(each.vector) for each in box.data.corner_normals]
    box.data.normals_split_custom_set(normals)
    before, place = world_points(box), np.array(child.matrix_world)
    assert mend(Action.APPLY_TRANSFORM, "Box", kind="precision") == ["Box: scale and rotation applied"]
    assert world_points(box) == pytest.approx(before, abs=1e-5)
    assert np.array(child.matrix_world) == pytest.approx(place, abs=1e-4)
    assert tuple(box.scale) == (1, 1, 1) and tuple(box.rotation_euler) == (0, 0, 0) and volume(box) > 0.0
    for polygon in box.data.polygons:
        for index in polygon.loop_indices:
            assert box.data.corner_normals[index].vector.dot(polygon.normal) > 0.99
    assert mend(Action.APPLY_TRANSFORM, "Box", kind="precision") == []


def test_transforms_that_would_leave_a_trace_are_refused():
    box = add_box("Box", *UNIT, glass())
    box.scale = (2, 2, 2)
    copy = add("Copy", box.data)
    with pytest.raises(nd.ParameterError, match="shares its mesh; make it single-user"):
        mend(Action.APPLY_TRANSFORM, "Box")
    bpy.data.objects.remove(copy)
    bevel = box.modifiers.new("Bevel", "BEVEL")
    with pytest.raises(nd.ParameterError, match="has the modifier 'Bevel', which would do otherwise"):
        mend(Action.APPLY_TRANSFORM, "Box")
    box.modifiers.remove(bevel)
    box.delta_scale = (2, 1, 1)
    with pytest.raises(nd.ParameterError, match="has delta transforms"):
        mend(Action.APPLY_TRANSFORM, "Box")
    box.delta_scale = (1, 1, 1)
    box.keyframe_insert("scale", frame=1)
    with pytest.raises(nd.ParameterError, match="keyframes, a driver or a constraint"):
        mend(Action.APPLY_TRANSFORM, "Box")
    assert tuple(box.scale) == (2, 2, 2)


def test_a_scene_far_away_is_brought_to_the_origin_with_camera_lights_keyframes_and_instances(scene):
    far = Vector((1e5, -2e5, 3e4))
    box = add_box("Box", *UNIT, glass())
    box.location = far
    for frame, z in ((1, 0.0), (10, 4.0)):
        box.location = far + Vector((0, 0, z))
        box.keyframe_insert("location", frame=frame)
    camera = add_camera(far + Vector((0, -5, 0)), far)
    child = add("Child", None, (1, 0, 0))
    child.parent = box
    collection = bpy.data.collections.new("Kept")
    scene.collection.children.link(collection)
    collection.objects.link(camera)
    instancer = add("Instancer", None, far + Vector((3, 0, 0)))
    instancer.instance_type, instancer.instance_collection = "COLLECTION", collection
    scene.frame_set(10)

    def places():
        bpy.context.view_layer.update()
        graph = bpy.context.evaluated_depsgraph_get()
        return np.array([tuple(each.matrix_world.translation) for each in graph.object_instances])

    before, count = places(), len(places())
    mend(Action.MOVE_TO_ORIGIN, scene.name, kind="precision")
    after = places()
    assert len(after) == count >= 4
    # The coordinates of single precision at 2e5 are 0.016 apart.
    assert after - before == pytest.approx(np.tile(after[0] - before[0], (count, 1)), abs=0.05)
    assert np.abs(world_points(box).mean(axis=0)).max() < 0.05
    scene.frame_set(1)
    assert box.matrix_world.translation.z == pytest.approx(-4.0, abs=0.05)


def test_scenes_that_cannot_be_moved_as_a_whole_are_refused(scene):
    box = add_box("Box", *UNIT, glass())
    box.location = (1e5, 0, 0)
    target = add("Target", None)
    for kind, refused in (("TRACK_TO", False), ("CHILD_OF", True)):
        constraint = box.constraints.new(kind)
        constraint.target = target
        if refused:
            with pytest.raises(nd.ParameterError, match="'Box' has the constraint 'Child Of', which may hold it"):
                mend(Action.MOVE_TO_ORIGIN, scene.name)
        box.constraints.remove(constraint)
    other = bpy.data.scenes.new("Other")
    other.collection.objects.link(box)
    with pytest.raises(nd.ParameterError, match="'Box' stands in scene 'Other', too"):
        mend(Action.MOVE_TO_ORIGIN, scene.name)
    other.collection.objects.unlink(box)
    box.driver_add("location", 0)
    with pytest.raises(nd.ParameterError, match="'Box' is placed by a driver"):
        mend(Action.MOVE_TO_ORIGIN, scene.name)
    assert box.location.x == 1e5


def test_a_scene_is_prepared(scene):
    add_box("Box", *UNIT, glass())
    assert "Render Engine: EEVEE -> Cycles" in mend(Action.PREPARE, scene.name, kind="settings")
    assert is_analysed(scene)


def test_what_is_linked_is_never_changed(tmp_path, scene):
    box = add_box("Box", *UNIT, glass())
    open_up(box, 1)
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {box})
    empty_file(with_group=True)
    scene = bpy.context.scene
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["Box"]
    (box,) = wanted.objects
    scene.collection.objects.link(box)
    local = add("Local", box.data)
    for action, value, path in (
        (Action.RECALCULATE_NORMALS, None, ""),
        (Action.CLOSE_HOLES, None, ""),
        (Action.PUSH_INTO_WALL, 0.1, ""),
        (Action.MOVE_APART, 0.1, ""),
        (Action.SET_PRIORITY, 3, ""),
        (Action.APPLY_TRANSFORM, None, ""),
        (Action.MERGE_COPIES, None, ""),
        (Action.MOVE_SLOT, None, ""),
        (Action.REMOVE_PROPERTY, None, PRIORITY_PROPERTY),
        (Action.MOVE_TO_ORIGIN, None, ""),
    ):
        with pytest.raises(nd.ParameterError, match="comes from"):
            mend(action, "Box", "Local", value=value, path=path)
    for action, value, path in (
        (Action.MEND_NODES, None, ""),
        (Action.SET_VALUE, None, "IOR"),
        (Action.SET_PRIORITY, 3, ""),
    ):
        with pytest.raises(nd.ParameterError, match="'Glass' comes from"):
            mend(action, "Glass", value=value, path=path)
    with pytest.raises(nd.ParameterError, match="'Local' has its shape from"):
        mend(Action.RECALCULATE_NORMALS, local.name)


def with_fixes(monkeypatch, *pairs):
    """Let checks give fixes for kinds that are found: those of other checks may have none yet."""
    from nested_dielectric.checking import check as module
    from nested_dielectric.fixing import fix as fixing
    from nested_dielectric.fixing import kept
    from nested_dielectric.preparation import check_scene

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


def test_all_that_is_safe_is_fixed_and_what_is_left_is_said(monkeypatch, scene):
    with_fixes(
        monkeypatch,
        ("open-mesh", (Action.CLOSE_HOLES, True)),
        ("inward-normals", (Action.RECALCULATE_NORMALS, True)),
        ("slot-limit", (Action.MOVE_SLOT, False)),
    )
    open_up(add_box("Open", *UNIT, glass()), 1)
    flip(add_box("Inward", (4, 0, 0), (5, 1, 1), glass()))
    add_plane("Plane", 1.0, (9, 9, 9), (0, 0, 1), glass())
    far = add_box("Far", (6, 0, 0), (7, 1, 1))
    for index in range(9):
        far.data.materials.append(bpy.data.materials.new(f"Paint {index}"))
    far.data.materials.append(glass())
    fixed = nd.fix_all(scene)
    assert sorted(change.split(":")[0] for change in fixed.changes) == ["Inward", "Open"]
    left = {(finding.kind.key, finding.name) for finding in fixed.left}
    assert ("open-mesh", "Plane") in left and ("slot-limit", "Far") in left
    assert not {"Open", "Inward"} & {name for _, name in left}
    assert "changed: Open: 1 hole closed" in str(fixed) and "left: 'Plane'" in str(fixed)
    assert nd.fix_all(scene).changes == ()


@pytest.fixture
def operators(scene):
    """The extension is registered, and what its panel lists is still there."""
    nd.register()
    yield
    nd.unregister()


@pytest.mark.parametrize("action", mostly_again(Action))
def test_a_fix_is_one_step_that_undo_takes_back_and_redo_does_again(action, operators, monkeypatch):
    monkeypatch.setattr(problem_operators, "as_it_is_now", lambda scene, kept: kept)
    finding = fault_of(action)
    keep_findings(bpy.context.scene, 1, [finding])
    bpy.context.view_layer.update()
    bpy.ops.ed.undo_push(message="fault")
    before = state()
    assert bpy.ops.nested_dielectric.fix("EXEC_DEFAULT", True, index=0) == {"FINISHED"}
    after = state()
    changed = {name for name in before if before[name] != after.get(name)}
    assert changed - {"scene"} or before["scene"][:-1] != after["scene"][:-1]
    bpy.ops.ed.undo()
    assert state() == before
    bpy.ops.ed.redo()
    assert state() == after


def test_a_button_fixes_one_problem_and_lists_what_is_left(operators, monkeypatch, capfd):
    scene = bpy.context.scene
    with_fixes(monkeypatch, ("open-mesh", (Action.CLOSE_HOLES, True)), ("value-limit", (None, True)))
    open_up(add_box("Open", *UNIT, glass()), 1)
    add_plane("Plane", 1.0, (9, 9, 9), (0, 0, 1), glass())
    before = state()
    assert bpy.ops.nested_dielectric.check() == {"FINISHED"}
    assert {**state(), "scene": None} == {**before, "scene": None} and not is_analysed(scene)
    names = [problem.name for problem in last_report(scene).problems]
    assert names == ["Open", "Plane"]
    description = problem_operators.FixProblem.description.__func__
    index = type("Index", (), {"index": 0})
    assert description(problem_operators.FixProblem, bpy.context, index).startswith(
        "Close Holes: Fill the holes in the mesh"
    )
    assert bpy.ops.nested_dielectric.fix(index=0) == {"FINISHED"}
    assert [problem.name for problem in last_report(scene).problems] == ["Plane"]
    assert "Open: 1 hole closed" in "".join(capfd.readouterr())
    with pytest.raises(RuntimeError, match="'Plane' is flat"):
        bpy.ops.nested_dielectric.fix(index=0)
    with pytest.raises(RuntimeError, match="This problem has no fix"):
        bpy.ops.nested_dielectric.fix(index=7)
    assert bpy.ops.nested_dielectric.fix_all() == {"FINISHED"}
    output = "".join(capfd.readouterr())
    assert "Left: 'Plane' is not closed" in output and "1 problem left" in output
    bpy.data.objects.remove(bpy.data.objects["Plane"])
    assert bpy.ops.nested_dielectric.fix(index=0) == {"FINISHED"}
    assert "'Plane' has this problem no more" in "".join(capfd.readouterr())
    for operator in (bpy.ops.nested_dielectric.fix, bpy.ops.nested_dielectric.fix_all):
        with pytest.raises(RuntimeError, match="No problem is listed"):
            operator()
    bpy.context.view_layer.objects.active = bpy.data.objects["Open"]
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="Leave this mode for Object Mode"):
        bpy.ops.nested_dielectric.fix_all()


def test_to_fix_all_is_one_step_too(operators, monkeypatch):
    with_fixes(
        monkeypatch, ("open-mesh", (Action.CLOSE_HOLES, True)), ("inward-normals", (Action.RECALCULATE_NORMALS, True))
    )
    open_up(add_box("Open", *UNIT, glass()), 1)
    flip(add_box("Inward", (4, 0, 0), (5, 1, 1), glass()))
    bpy.ops.nested_dielectric.check()
    bpy.ops.ed.undo_push(message="faults")
    before = state()
    bpy.ops.nested_dielectric.fix_all("EXEC_DEFAULT", True)
    assert all(map(volume, bpy.context.scene.objects))
    bpy.ops.ed.undo()
    assert state() == before


def test_a_problem_shows_its_faces_and_its_point(operators, capfd):
    from dataclasses import replace

    from nested_dielectric.checking.finding import Place

    scene = bpy.context.scene
    box = add_box("Box", *UNIT, glass())
    finding = replace(fault_of(Action.SET_SETTING), name="Box", place=Place((2, 4, 99), (1.0, 2.0, 3.0)))
    keep_findings(scene, 1, [finding, replace(finding, name=scene.name)])
    bpy.context.view_layer.update()
    assert bpy.ops.nested_dielectric.show_problem(index=0) == {"FINISHED"}
    assert bpy.context.object == box and tuple(scene.cursor.location) == (1.0, 2.0, 3.0)
    assert [polygon.index for polygon in box.data.polygons if polygon.select] == [2, 4]
    assert "Tab shows them in Edit Mode" in "".join(capfd.readouterr())
    bpy.ops.object.mode_set(mode="EDIT")
    bm = bmesh.from_edit_mesh(box.data)
    assert [face.index for face in bm.faces if face.select] == [2, 4]
    bpy.ops.object.mode_set(mode="OBJECT")
    scene.cursor.location = (0, 0, 0)
    assert bpy.ops.nested_dielectric.show_problem(index=1) == {"FINISHED"}
    assert tuple(scene.cursor.location) == (1.0, 2.0, 3.0)
    box.modifiers.new("Round", "SUBSURF")
    assert bpy.ops.nested_dielectric.show_problem(index=0) == {"FINISHED"}
    assert "Tab shows" not in "".join(capfd.readouterr())
