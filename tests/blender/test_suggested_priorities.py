"""Priorities that are suggested for a scene: from how its media overlap, and nothing changes before somebody accepts them."""

from types import SimpleNamespace

import bpy
import pytest
from scenes import add, add_box, add_sphere, mostly_again, new_scene
from ui import draw_panel, labels_and_operators, texts

import nested_dielectric as nd
from nested_dielectric.scene import media
from nested_dielectric.ui.operators.suggestion_operators import SuggestPriorities
from nested_dielectric.ui.panels import scene_panels


@pytest.fixture
def scene():
    return new_scene(with_group=True)


@pytest.fixture
def registered(scene):
    nd.register()
    yield
    nd.unregister()


def preset(name, priority=None, **keywords):
    return nd.new_material(
        name.title(), preset=name, **({} if priority is None else {"priority": priority}), **keywords
    )


def priorities():
    """The numbers of all materials, and of all objects that have one of their own."""
    found = {each.name: media.material_priority(each) for each in bpy.data.materials}
    return found | {each.name: each["nd_priority"] for each in bpy.data.objects if "nd_priority" in each}


def told(scene):
    return [(each.owner.name, each.before, each.after, each.reason) for each in nd.suggest_priorities(scene)]


def add_drink(**numbers):
    """A tumbler of water with ice, and a bubble that clings to it; their presets may have other numbers."""
    add_box("Tumbler", (-1, -1, 0), (1, 1, 0.3), preset("glass", numbers.get("glass")))
    add_box("Drink", (-0.9, -0.9, 0.2), (0.9, 0.9, 1.5), preset("water", numbers.get("water")))
    add_box("Cube", (-0.4, -0.4, 1.0), (0.4, 0.4, 1.8), preset("ice", numbers.get("ice")))
    add_sphere("Bubble", 0.1, preset("air_bubble", numbers.get("bubble")), None, (0.6, 0.6, 0.3), segments=12)


# What is suggested


def test_the_order_of_the_presets_is_right_for_a_drink(scene):
    add_drink()
    assert not told(scene)


def test_a_drink_in_a_wrong_order_is_put_right_with_two_numbers(scene):
    add_drink(glass=30, ice=20, water=10, bubble=40)
    assert told(scene) == [
        ("Air_Bubble", 40, 0, "it is a bubble and 'Tumbler' is a solid"),
        ("Water", 10, 35, "it is a liquid and 'Tumbler' is a solid"),
    ]


def test_suggesting_changes_nothing(scene):
    add_drink(glass=30, water=10)
    before = priorities(), [dict(obj.items()) for obj in bpy.data.objects], dict(scene.items())
    assert told(scene) == told(scene) != []
    assert (priorities(), [dict(obj.items()) for obj in bpy.data.objects], dict(scene.items())) == before


def test_an_object_that_lies_inside_another_gets_a_number_of_its_own_where_its_material_is_around_others(scene):
    glass, water = preset("glass"), preset("water")
    add_box("Block", (0, 0, 0), (1, 1, 1), glass)
    add_sphere("Drop", 0.2, water, None, (0.5, 0.5, 0.5), segments=12)
    add_box("Sea", (0, 0, -3), (9, 9, -1), water)
    add_sphere("Marble", 0.2, glass, None, (2, 2, -2), segments=12)
    assert told(scene) == [("Drop", 30, 5, "it lies inside 'Block'")]
    assert nd.accept_priorities(scene, nd.suggest_priorities(scene)) == (["Drop: 30 -> 5"], [])
    assert nd.get_priority(bpy.data.objects["Drop"]) == 5 and nd.get_priority(bpy.data.objects["Sea"]) == 30
    assert not told(scene)


def test_instances_are_looked_at_where_they_stand(scene):
    drink = add_box("Drink", (0, 0, 0), (1, 1, 1), preset("water", 10))
    collection = bpy.data.collections.new("Cubes")
    cube = add_box("Cube", (0, 0, 0), (0.3, 0.3, 0.3), preset("ice"))
    scene.collection.objects.unlink(cube)
    collection.objects.link(cube)
    instance = add("Instance", None, (5, 5, 5))
    instance.instance_type, instance.instance_collection = "COLLECTION", collection
    assert not told(scene)
    instance.location = (0.5, 0.5, 0.5)
    assert told(scene) == [("Water", 10, 30, "'Cube' lies inside it")]
    drink.hide_render = True
    assert not told(scene)


def test_what_nodes_instance_is_looked_at_where_it_is_an_object(scene):
    add_box("Drink", (0, 0, 0), (1, 1, 1), preset("water", 10))
    bubble = add_sphere("Bubble", 0.05, preset("air_bubble", 40), segments=12)
    scene.collection.objects.unlink(bubble)
    add_box("Pane", (1.1, 0, 0), (1.3, 1, 1), preset("glass", 20))
    points = add_box("Points", (0.3, 0.3, 0.3), (0.6, 0.6, 0.6), preset("ice", 5))
    tree = bpy.data.node_groups.new("Scatter", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    start, end, scatter, info, cube, others = (
        tree.nodes.new(kind)
        for kind in (
            "NodeGroupInput",
            "NodeGroupOutput",
            "GeometryNodeInstanceOnPoints",
            "GeometryNodeObjectInfo",
            "GeometryNodeMeshCube",
            "GeometryNodeInstanceOnPoints",
        )
    )
    info.inputs["Object"].default_value, info.inputs["As Instance"].default_value = bubble, True
    tree.links.new(start.outputs[0], scatter.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], scatter.inputs["Instance"])
    tree.links.new(start.outputs[0], others.inputs["Points"])
    tree.links.new(
        cube.outputs["Mesh"], others.inputs["Instance"]
    )  # cubes that are no objects, and reach out of the drink
    both = tree.nodes.new("GeometryNodeJoinGeometry")
    for node in (start, scatter, others):
        tree.links.new(node.outputs[0], both.inputs[0])
    tree.links.new(both.outputs[0], end.inputs[0])
    points.modifiers.new("Scatter", "NODES").node_group = tree
    assert told(scene) == [("Air_Bubble", 40, 0, "it lies inside 'Drink'")]
    assert nd.accept_priorities(scene, nd.suggest_priorities(scene))[1] == []
    assert not told(scene)


def test_a_mesh_is_taken_as_modifiers_have_it_and_an_open_one_overlaps_nothing(scene):
    add_box("Glass", (0, 0, 0), (1, 1, 1), preset("glass", 30))
    drink = add_box("Drink", (2, 0, 0), (3, 1, 1), preset("water", 10))
    assert not told(scene)
    array = drink.modifiers.new("Array", "ARRAY")
    array.relative_offset_displace[0] = -1.5
    assert len(told(scene)) == 1
    drink.scale.z = 0.0
    assert not told(scene)
    drink.scale.z = 1.0
    drink.vertex_groups.new(name="Corner").add([0], 1.0, "REPLACE")
    mask = drink.modifiers.new("Mask", "MASK")
    mask.vertex_group, mask.invert_vertex_group = "Corner", True
    assert not told(scene)


def test_a_liquid_of_an_index_as_glass_is_known_by_standing_in_its_vessel(scene):
    vessel = add_box("Vessel", (-1, -1, 0), (1, 1, 0.3), nd.new_material("Vessel", ior=1.47, priority=9))
    add_box("Drink", (-0.9, -0.9, 0.2), (0.9, 0.9, 1.5), nd.new_material("Drink", ior=1.46, priority=2))
    assert [each[3] for each in told(scene)] in (
        ["it is a solid and 'Drink' is a liquid"],
        ["it is a liquid and 'Vessel' is a solid"],
    )
    vessel.scale = 0.1, 0.1, 1.0
    assert not told(scene)


def test_what_has_keyframes_stays_and_others_go_by_it(scene):
    add_drink(glass=30, water=10)
    bpy.data.objects["Tumbler"]["nd_priority"] = 30
    bpy.data.objects["Tumbler"].keyframe_insert('["nd_priority"]')
    assert told(scene) == [("Water", 10, 35, "it is a liquid and 'Tumbler' is a solid")]


def test_an_object_of_a_material_that_cannot_be_changed_gets_a_number_of_its_own(scene):
    glass, water = preset("glass"), preset("water", 5)
    water.node_tree.nodes["Nested Dielectric"].inputs["Priority"].keyframe_insert("default_value")
    glass.node_tree.nodes["Nested Dielectric"].inputs["Priority"].keyframe_insert("default_value")
    add_box("Tumbler", (-1, -1, 0), (1, 1, 0.3), glass)
    add_box("Drink", (-0.9, -0.9, 0.2), (0.9, 0.9, 1.5), water)
    add_box("Puddle", (5, 5, 0), (6, 6, 0.1), water)
    (suggestion,) = nd.suggest_priorities(scene)
    assert suggestion.owner in (bpy.data.objects["Tumbler"], bpy.data.objects["Drink"])
    assert nd.accept_priorities(scene, [suggestion])[1] == []
    assert not told(scene) and nd.get_priority(bpy.data.objects["Puddle"]) == 5


def test_what_changed_since_it_was_suggested_or_cannot_be_changed_is_said_and_kept(scene):
    add_drink(glass=30, ice=20, water=10, bubble=40)
    suggestions = nd.suggest_priorities(scene)
    bubble, water = bpy.data.objects["Bubble"].active_material, bpy.data.objects["Drink"].active_material
    socket = bubble.node_tree.nodes["Nested Dielectric"].inputs["Priority"]
    socket.default_value = 41
    water.node_tree.nodes["Nested Dielectric"].inputs["Priority"].keyframe_insert("default_value")
    assert nd.accept_priorities(scene, suggestions) == (
        [],
        [
            "'Air_Bubble' has another priority by now, 41; ask for suggestions again",
            "'Water' keeps 10, because it has keyframes or a driver of its priority; change those",
        ],
    )
    bpy.data.objects.remove(bpy.data.objects["Bubble"])
    assert "is no medium of this scene any more" in nd.accept_priorities(scene, suggestions)[1][0]
    bpy.data.materials.remove(bubble)
    assert "has been deleted" in nd.accept_priorities(scene, suggestions)[1][0]


def test_a_suggestion_reads_as_a_sentence(scene):
    add_drink(water=5)
    assert [str(each) for each in nd.suggest_priorities(scene)] == [
        "Water: 5 -> 30, because it is a liquid and 'Cube' is ice"
    ]


# The operator


def test_a_script_accepts_all_and_one_undo_takes_it_back(registered):
    add_drink(glass=30, ice=20, water=10, bubble=40)
    before = priorities()
    bpy.ops.ed.undo_push(message="start")
    assert bpy.ops.nested_dielectric.suggest_priorities("EXEC_DEFAULT", True) == {"FINISHED"}
    assert priorities() == before | {"Air_Bubble": 0, "Water": 35}
    bpy.ops.ed.undo()
    assert priorities() == before


def test_where_all_is_well_it_says_so_and_makes_no_undo_step(registered, capfd):
    add_drink()
    assert bpy.ops.nested_dielectric.suggest_priorities() == {"CANCELLED"}
    assert "Nothing to suggest" in "".join(capfd.readouterr())


def test_what_is_not_ticked_stays(registered):
    add_drink(glass=30, ice=20, water=10, bubble=40)
    before = priorities()
    rows = [
        {
            "name": each.owner.name,
            "number": each.owner.session_uid,
            "before": each.before,
            "after": each.after,
            "reason": each.reason,
            "is_object": False,
            "is_accepted": each.owner.name == "Water",
        }
        for each in nd.suggest_priorities(bpy.context.scene)
    ]
    assert bpy.ops.nested_dielectric.suggest_priorities(suggestions=rows) == {"FINISHED"}
    assert priorities() == before | {"Water": 35}
    rows[1]["is_accepted"] = False
    assert bpy.ops.nested_dielectric.suggest_priorities(suggestions=rows) == {"CANCELLED"}


def test_the_button_is_greyed_out_without_media(registered):
    with pytest.raises(RuntimeError, match="The scene has no medium; assign a preset first"):
        bpy.ops.nested_dielectric.suggest_priorities()


@pytest.mark.parametrize("panel", mostly_again((scene_panels.SidebarPanel, scene_panels.ObjectPanel)))
def test_the_panel_has_the_button(registered, panel, capfd):
    add_drink()
    assert SuggestPriorities.bl_idname in labels_and_operators(draw_panel(panel, 300, capfd.readouterr))[1]


def test_the_dialog_shows_each_number_with_its_reason_to_tick(registered, capfd):
    add_drink(glass=30, ice=20, water=10, bubble=40)
    rows = bpy.context.window_manager.operator_properties_last(SuggestPriorities.bl_idname).suggestions
    rows.clear()
    for suggestion in nd.suggest_priorities(bpy.context.scene):
        rows.add().take(suggestion)

    def draw(panel, context):
        SuggestPriorities.draw(SimpleNamespace(layout=panel.layout, suggestions=rows), context)

    dialog = SimpleNamespace(draw=draw, bl_label="")
    drawn = draw_panel(dialog, 300, capfd.readouterr)
    labels, *_ = texts(drawn)
    assert [arguments[1] for name, arguments, _ in drawn if name == "prop"] == ["is_accepted"] * 2
    assert "Air_Bubble 40 \N{RIGHTWARDS ARROW} 0 because it is a bubble and 'Tumbler' is a solid" in labels
