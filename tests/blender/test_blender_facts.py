"""What Blender does that the design leans on and that no other test would show; see docs/design.md."""

import bpy
import pytest
from scenes import add, add_box, add_plane, native, new_scene


def nodes_on(obj: bpy.types.Object) -> bpy.types.NodeTree:
    """A new tree of Geometry Nodes on an object, with an output that nothing is linked to."""
    tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    tree.nodes.new("NodeGroupInput")
    tree.nodes.new("NodeGroupOutput")
    obj.modifiers.new("Nodes", "NODES").node_group = tree
    return tree


def read(tree: bpy.types.NodeTree, obj: bpy.types.Object) -> bpy.types.NodeSocket:
    node = tree.nodes.new("GeometryNodeObjectInfo")
    node.transform_space = "RELATIVE"
    node.inputs["Object"].default_value = obj
    return node.outputs["Geometry"]


def boolean(tree: bpy.types.NodeTree, operation: str, *bodies: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    node = tree.nodes.new("GeometryNodeMeshBoolean")
    node.operation, node.solver = operation, "MANIFOLD"
    sockets = bodies if operation == "DIFFERENCE" else (None, *bodies)
    for index, body in enumerate(sockets):
        if body is not None:
            tree.links.new(body, node.inputs[min(index, 1)])
    return node.outputs[0]


def shown(tree: bpy.types.NodeTree, socket: bpy.types.NodeSocket, obj: bpy.types.Object) -> bpy.types.Mesh:
    output = next(node for node in tree.nodes if node.bl_idname == "NodeGroupOutput")
    tree.links.new(socket, output.inputs[0])
    bpy.context.view_layer.update()
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data


def empty_object() -> tuple[bpy.types.Object, bpy.types.NodeTree]:
    obj = add("Shown", bpy.data.meshes.new("Shown"))
    return obj, nodes_on(obj)


def hidden(obj: bpy.types.Object, way: str) -> None:
    if way == "excluded":
        collection = bpy.data.collections.new("Excluded")
        scene = bpy.context.scene
        scene.collection.children.link(collection)
        scene.collection.objects.unlink(obj)
        collection.objects.link(obj)
        bpy.context.view_layer.layer_collection.children[0].exclude = True
    else:
        setattr(obj, way, True)


@pytest.mark.parametrize("way", ["hide_render", "hide_viewport", "excluded"])
def test_object_info_reads_objects_that_are_hidden(way):
    new_scene()
    box = add_box("Box", (-1, -1, -1), (1, 1, 1))
    hidden(box, way)
    obj, tree = empty_object()
    assert len(shown(tree, read(tree, box), obj).polygons) == 6


def test_the_manifold_solver_gives_nothing_for_an_open_mesh():
    new_scene()
    box, other = add_box("Box", (-1, -1, -1), (1, 1, 1)), add_box("Other", (0, 0, 0), (2, 2, 2))
    for open_one in (False, True):
        obj, tree = empty_object()
        if open_one:
            box.data.materials.clear()
            plane = add_plane("Plane", 3.0, (0, 0, 0), (0, 0, 1))
            box = plane
        mesh = shown(tree, boolean(tree, "DIFFERENCE", read(tree, box), read(tree, other)), obj)
        assert (len(mesh.polygons) == 0) is open_one


def test_what_is_joined_first_brings_its_slots_and_its_texture_space():
    new_scene()
    first, second = native("First", "ShaderNodeEmission"), native("Second", "ShaderNodeEmission")
    small = add_box("Small", (-1, -1, -1), (1, 1, 1), first)
    large = add_box("Large", (3, -3, -3), (9, 3, 3), second)
    for body, size in ((small, 1.0), (large, 3.0)):
        body.data.use_auto_texspace = False
        body.data.texspace_size = (size, size, size)
    obj, tree = empty_object()
    join = tree.nodes.new("GeometryNodeJoinGeometry")
    for body in (large, small):  # the last link comes first
        tree.links.new(read(tree, body), join.inputs[0])
    mesh = shown(tree, join.outputs[0], obj)
    assert [material.name for material in mesh.materials] == ["First", "Second"]
    assert tuple(mesh.texspace_size) == (1.0, 1.0, 1.0)


def test_the_solver_leaves_attributes_of_new_points_at_0():
    new_scene()
    box, other = add_box("Box", (-1, -1, -1), (1, 1, 1)), add_box("Other", (0, 0, 0), (2, 2, 2))
    for body in (box, other):
        values = body.data.attributes.new("Value", "FLOAT", "POINT").data
        values.foreach_set("value", [1.0] * len(values))
    obj, tree = empty_object()
    mesh = shown(tree, boolean(tree, "DIFFERENCE", read(tree, box), read(tree, other)), obj)
    values = [each.value for each in mesh.attributes["Value"].data]
    assert len(values) > 8 and 1.0 in values and 0.0 in values


def test_a_mesh_keeps_its_faces_attributes_through_the_solver():
    new_scene()
    box, other = add_box("Box", (-1, -1, -1), (1, 1, 1)), add_box("Other", (0, 0, 0), (2, 2, 2))
    values = box.data.attributes.new("Own", "BOOLEAN", "FACE").data
    values.foreach_set("value", [True] * len(values))
    obj, tree = empty_object()
    mesh = shown(tree, boolean(tree, "DIFFERENCE", read(tree, box), read(tree, other)), obj)
    own = [each.value for each in mesh.attributes["Own"].data]
    assert sum(own) >= 6 and own.count(False) >= 3


def test_a_custom_property_is_not_lost_with_the_extension():
    """What is registered is kept elsewhere since Blender 5.0: media use plain custom properties."""
    new_scene()
    box = add_box("Box", (-1, -1, -1), (1, 1, 1))
    bpy.types.Object.nd_test = bpy.props.IntProperty()
    try:
        box.nd_test = 3
        assert "nd_test" not in box
    finally:
        del bpy.types.Object.nd_test


def test_reading_a_menu_by_path_gives_a_word():
    new_scene()
    tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
    tree.interface.new_socket("Choice", in_out="INPUT", socket_type="NodeSocketMenu")
    material = native("Material", "ShaderNodeEmission")
    node = material.node_tree.nodes.new("ShaderNodeGroup")
    node.name, node.node_tree = "ND", tree
    assert isinstance(material.path_resolve('node_tree.nodes["ND"].inputs["Choice"].default_value'), str)
