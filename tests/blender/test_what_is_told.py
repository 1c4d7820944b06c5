"""What an analysis tells media of the ones around them."""

import bpy  # before bmesh, which lives inside it
from scenes import add_box, add_mesh
from told import (
    TINT,
    UNTOLD,
    ball,
    balls,
    codes,
    fresh,
    inputs,
    medium,
    ordinary_scene,
    plain,
    snapshot,
    told_by_object,
    told_code,
)

import nested_dielectric as nd
from nested_dielectric.model.contract import MATERIAL_SLOTS, Exterior


def test_a_medium_alone_is_told_of_air_through_its_material():
    scene = fresh()
    bead = ball("Ball", 1.0, medium("Glass", 1.5))
    found = nd.analyse(scene)
    sockets = inputs(bead.active_material)
    assert sockets["Outside"].default_value == Exterior.AIR == 1
    assert sockets["Outside Priority"].default_value < 0.0
    assert not sockets["Overlaps Itself"].default_value
    assert not sockets["Foreign Objects"].default_value
    assert told_by_object(bead) == UNTOLD
    assert (found.known, found.asking, found.doubts) == (("Ball",), (), ())


def test_a_medium_in_another_is_told_of_its_values():
    scene = fresh()
    water = medium("Water", 1.33, **TINT)
    ball("Water", 1.0, water, 5)
    ball("Exterior", 2.0, medium("Exterior", 1.2), 7)
    bead = ball("Ball", 0.5, medium("Glass", 1.5), 1)
    nd.analyse(scene)
    sockets = inputs(bead.active_material)
    assert sockets["Outside"].default_value == Exterior.MEDIUM == 2
    assert plain(sockets["Surroundings"].default_value) == (5.0, 1.33, TINT["transmittance_depth"])
    assert plain(sockets["Surroundings Transmittance"].default_value[:3]) == TINT["transmittance"]
    inputs(water)["IOR"].default_value = 1.4
    nd.set_priority(bpy.data.objects["Water"], 6)
    nd.analyse(scene)
    assert plain(sockets["Surroundings"].default_value) == (6.0, 1.4, TINT["transmittance_depth"])


def test_a_medium_inside_a_stronger_or_equal_one_is_told_that_it_is_not_there():
    scene = fresh()
    glass = medium("Glass", 1.5)
    ball("Glass", 1.0, glass, 2)
    ball("Weaker", 0.3, medium("Weaker", 1.3), 3, (0.4, 0, 0))
    ball("Equal", 0.3, medium("Equal", 1.3), 2, (-0.4, 0, 0))
    nd.analyse(scene)
    assert codes() == {"Glass": Exterior.AIR, "Weaker": Exterior.WINNER, "Equal": Exterior.WINNER}


def test_objects_of_one_material_are_told_each_for_itself_where_their_surroundings_differ():
    scene = fresh()
    glass = medium("Glass", 1.5)
    ball("Water", 1.0, medium("Water", 1.33), 5)
    inside, outside = ball("Inside", 0.5, glass, 1), ball("Outside", 0.5, glass, 2, (3, 0, 0))
    nd.analyse(scene)
    assert inputs(glass)["Outside"].default_value == Exterior.BY_OBJECT == 5
    assert told_by_object(inside) == ((Exterior.MEDIUM + 16, 5.0, 1.33, 1.0), None)
    assert told_by_object(outside) == ((Exterior.AIR + 16, 0.0, 1.0, 0.0), None)
    inside.location.x = 30.0
    nd.analyse(scene)
    assert inputs(glass)["Outside"].default_value == Exterior.AIR
    assert told_by_object(inside) == told_by_object(outside) == UNTOLD


def test_a_boolean_may_bring_materials_of_another_object():
    scene, bead = ordinary_scene()
    nd.analyse(scene)
    assert inputs(bead.active_material)["Material Slots"].default_value == 1
    bead.modifiers.new("Boolean", "BOOLEAN")
    nd.analyse(scene)
    assert inputs(bead.active_material)["Material Slots"].default_value == MATERIAL_SLOTS


def test_a_medium_that_changes_or_disperses_is_asked_for_its_values():
    scene = fresh()
    water = medium("Water", 1.33)
    ball("Water", 1.0, water, 5)
    ball("Ball", 0.5, medium("Glass", 1.5), 1)
    nd.analyse(scene)
    assert codes() == {"Water": Exterior.AIR, "Ball": Exterior.MEDIUM}
    inputs(water)["Disperse"].default_value = True
    nd.analyse(scene)
    assert codes() == {"Water": Exterior.AIR, "Ball": Exterior.UNKNOWN}
    inputs(water)["Disperse"].default_value = False
    inputs(water)["IOR"].keyframe_insert("default_value", frame=1)
    nd.analyse(scene)
    assert codes() == {"Water": Exterior.AIR, "Ball": Exterior.UNKNOWN}


def test_media_that_cross_ask_and_know_of_the_only_priority_around():
    """The first surface of that priority decides."""
    scene = fresh()
    bead = ball("Ball", 1.0, medium("Ball", 1.5), 1)
    other = ball("Other", 1.0, medium("Other", 1.33), 2, (1.1, 0.1, 0.2))
    found = nd.analyse(scene)
    assert (found.known, found.asking) == ((), ("Ball", "Other"))
    for obj, priority in ((bead, 2), (other, 1)):
        sockets = inputs(obj.active_material)
        assert (sockets["Outside"].default_value, sockets["Outside Priority"].default_value) == (
            Exterior.UNKNOWN,
            priority,
        )
    ball("Third", 0.2, medium("Third", 1.4), 3, (1.1, 1.1, 0.2))
    nd.analyse(scene)
    assert inputs(other.active_material)["Outside Priority"].default_value < 0.0


def smooth_by_angle() -> bpy.types.NodeTree:
    """The group that Shade Auto Smooth adds, in short: edges below an angle are smooth."""
    tree = bpy.data.node_groups.new("Smooth by Angle", "GeometryNodeTree")
    for in_out in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Mesh", in_out=in_out, socket_type="NodeSocketGeometry")
    first, angle, compare, smooth, last = (
        tree.nodes.new(kind)
        for kind in (
            "NodeGroupInput",
            "GeometryNodeInputMeshEdgeAngle",
            "FunctionNodeCompare",
            "GeometryNodeSetShadeSmooth",
            "NodeGroupOutput",
        )
    )
    smooth.domain = "EDGE"
    compare.operation = "LESS_EQUAL"
    tree.links.new(first.outputs[0], smooth.inputs["Mesh"])
    tree.links.new(angle.outputs["Unsigned Angle"], compare.inputs[0])
    tree.links.new(compare.outputs[0], smooth.inputs["Shade Smooth"])
    tree.links.new(smooth.outputs[0], last.inputs[0])
    return tree


def test_media_that_are_shaded_smooth_by_angle_are_told_as_without():
    scene, bead = ordinary_scene()
    nd.analyse(scene)
    known = snapshot()
    group = smooth_by_angle()
    for obj in (bead, bpy.data.objects["Water"]):
        obj.modifiers.new("Smooth by Angle", "NODES").node_group = group
    nd.analyse(scene)
    del known["Water"], known["Bead"]  # modifiers of nodes may bring materials
    assert known.items() <= snapshot().items()
    assert told_code(bead) == Exterior.MEDIUM
    group.nodes.new("GeometryNodeInputSceneTime")
    nd.analyse(scene)
    assert set(codes().values()) == {Exterior.UNKNOWN}


def test_a_mesh_that_overlaps_itself_is_found():
    scene = fresh()
    add_mesh("Double", balls((0.8, (-0.4, 0, 0)), (0.8, (0.4, 0.1, 0.1))), medium("Double", 1.5), 1)
    add_mesh("Apart", balls((0.8, (-0.9, 5, 0)), (0.8, (0.9, 5, 0))), medium("Apart", 1.5), 1)
    found = nd.analyse(scene)
    assert found.overlapping == ("Double",) == found.asking
    assert inputs(bpy.data.materials["Double"])["Overlaps Itself"].default_value
    assert not inputs(bpy.data.materials["Apart"])["Overlaps Itself"].default_value


def test_what_stands_in_the_same_place_is_named():
    scene = fresh()
    add_box("Lower", (-1, -1, -1), (1, 1, 0), medium("Lower", 1.5), 1)
    add_box("Upper", (-0.6, -0.7, 0), (0.5, 0.6, 1), medium("Upper", 1.5), 2)
    add_box("Elsewhere", (5, -0.7, 0), (6, 0.6, 1), medium("Elsewhere", 1.5), 2)
    assert nd.analyse(scene).coincident == (("Lower", "Upper"),)
