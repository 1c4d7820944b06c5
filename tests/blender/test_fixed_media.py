"""Priorities, settings, values, nodes and slots of media are mended."""

import bpy  # before bmesh, which lives inside it
import pytest
from faults import UNIT, glass, kinds, mend
from scenes import add_box, add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric.checking.finding import Action
from nested_dielectric.model.parameter import PRIORITY_PROPERTY
from nested_dielectric.preparation.prepare_scene import put_back
from nested_dielectric.scene.media import get_priority


@pytest.fixture(autouse=True)
def scene():
    new_scene(with_group=True)
    return bpy.context.scene


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
        ("cycles.max_bounces", 64, "Max Bounces: 256 -> 64"),
        ("render.engine", "BLENDER_EEVEE", "Render Engine: Cycles -> EEVEE"),
        ("render.use_motion_blur", True, "Motion Blur: off -> on"),
        ("render.use_simplify", True, "Use Simplify: off -> on"),
    ):
        assert mend(Action.SET_SETTING, scene.name, value=value, path=path) == [words]
        assert mend(Action.SET_SETTING, scene.name, value=value, path=path) == []
    assert {"Max Bounces: 64 -> 256", "Render Engine: EEVEE -> Cycles"} <= {*put_back(scene)}
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
