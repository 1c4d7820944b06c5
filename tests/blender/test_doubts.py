"""Media that may be anywhere, or have another shape, leave all to rays."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import pytest
from doubted import doubted
from scenes import add, add_box, add_plane
from told import UNTOLD, displacing, inputs, instance, instanced_by_geometry_nodes, into_collection, told_by_object

import nested_dielectric as nd
from nested_dielectric.model.contract import Exterior


def keyframed(obj) -> None:
    obj.keyframe_insert("location", frame=1)


def driven(obj) -> None:
    obj.driver_add("location", 0)


def constrained(obj) -> None:
    obj.constraints.new("LIMIT_LOCATION")


def child_of_what_is_keyframed(obj) -> None:
    obj.parent = add("Parent", None)
    obj.parent.keyframe_insert("location", frame=1)


def grandchild_of_what_is_constrained(obj) -> None:
    obj.parent = add("Parent", None)
    obj.parent.parent = add("Grandparent", None)
    obj.parent.parent.constraints.new("LIMIT_LOCATION")


def child_of_a_vertex(obj) -> None:
    obj.parent = add_box("Parent", (8, 8, 8), (9, 9, 9))
    obj.parent_type = "VERTEX"


def child_of_a_keyframed_path(obj) -> None:
    curve = bpy.data.curves.new("Path", "CURVE")
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points[1].co = (3.0, 0.0, 0.0, 1.0)
    curve.use_path = True
    curve.keyframe_insert("eval_time", frame=1)
    obj.parent = add("Path", curve)


def with_a_keyframed_shape(obj) -> None:
    obj.shape_key_add(name="Basis")
    obj.shape_key_add(name="Other").keyframe_insert("value", frame=1)


def with_a_modifier_of_time(obj) -> None:
    obj.modifiers.new("Build", "BUILD")


def with_a_modifier_that_looks_elsewhere(obj) -> None:
    obj.modifiers.new("Displace", "DISPLACE").texture = bpy.data.textures.new("Clouds", "CLOUDS")


def with_geometry_nodes(obj) -> None:
    obj.modifiers.new("Nodes", "NODES").node_group = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")


def displaced_by_its_material(obj) -> None:
    displacing(obj.active_material)


def hidden_from_the_viewport(obj) -> None:
    obj.hide_viewport = True


def hidden_from_renders(obj) -> None:
    obj.hide_render = True


def closed_by_the_eye(obj) -> None:
    obj.hide_set(True)


def in_a_collection_hidden_from_renders(obj) -> str:
    collection = into_collection(obj)
    bpy.context.scene.collection.children.link(collection)
    collection.hide_render = True
    return collection.name


def not_in_the_second_view_layer(obj) -> str:
    collection = into_collection(obj)
    bpy.context.scene.collection.children.link(collection)
    second = bpy.context.scene.view_layers.new("Second")
    second.layer_collection.children[collection.name].exclude = True
    return second.name


def being_edited(obj) -> None:
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")


def with_a_hole(obj) -> None:
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    bm.faces.ensure_lookup_table()
    bmesh.ops.delete(bm, geom=[bm.faces[3]], context="FACES_ONLY")
    bm.to_mesh(obj.data)
    bm.free()


def inside_out(obj) -> None:
    obj.data.flip_normals()


def with_a_linked_priority(obj) -> None:
    nd.set_priority(obj, None)
    tree = obj.active_material.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], inputs(obj.active_material)["Priority"])


def with_a_keyframed_priority_of_its_own(obj) -> None:
    obj.keyframe_insert('["nd_priority"]', frame=1)


def with_a_keyframed_priority_of_its_material(obj) -> None:
    nd.set_priority(obj, None)
    inputs(obj.active_material)["Priority"].keyframe_insert("default_value", frame=1)


def instanced_by_what_is_keyframed(obj) -> tuple[str, ...]:
    instancer = instance(into_collection(obj))
    instancer.keyframe_insert("location", frame=1)
    return obj.name, instancer.name


def instanced_by_what_is_constrained_in_another_instance(obj) -> tuple[str, ...]:
    inner = instance(into_collection(obj))
    inner.constraints.new("LIMIT_LOCATION")
    outer = instance(into_collection(inner))
    return obj.name, inner.name, outer.name


def instanced_on_vertices(obj) -> tuple[str, ...]:
    obj.parent = add_box("Parent", (-0.1, -0.1, -0.1), (0.1, 0.1, 0.1))
    obj.parent.instance_type = "VERTS"
    return obj.name, "Parent"


def instanced_by_particles(obj) -> tuple[str, ...]:
    host = add_plane("Host", 0.2, (0, 0, 0), (0, 0, 1))
    host.modifiers.new("Particles", "PARTICLE_SYSTEM")
    settings = host.particle_systems[0].settings
    settings.type, settings.render_type, settings.instance_object = "HAIR", "OBJECT", obj
    settings.count, settings.display_percentage, settings.particle_size = 10, 50, 0.1
    return obj.name, host.name


def of_a_material_from_geometry_nodes(obj) -> None:
    tree = bpy.data.node_groups.new("Material", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    given, node, output = map(tree.nodes.new, ("NodeGroupInput", "GeometryNodeSetMaterial", "NodeGroupOutput"))
    node.inputs["Material"].default_value = obj.active_material
    tree.links.new(given.outputs[0], node.inputs["Geometry"])
    tree.links.new(node.outputs[0], output.inputs[0])
    obj.data.materials.clear()
    obj.modifiers.new("Nodes", "NODES").node_group = tree


@pytest.mark.parametrize(
    "doubtful",
    [
        keyframed,
        driven,
        constrained,
        child_of_what_is_keyframed,
        grandchild_of_what_is_constrained,
        child_of_a_vertex,
        child_of_a_keyframed_path,
        with_a_keyframed_shape,
        with_a_modifier_of_time,
        with_a_modifier_that_looks_elsewhere,
        with_geometry_nodes,
        displaced_by_its_material,
        hidden_from_the_viewport,
        hidden_from_renders,
        closed_by_the_eye,
        in_a_collection_hidden_from_renders,
        not_in_the_second_view_layer,
        being_edited,
        with_a_hole,
        inside_out,
        with_a_linked_priority,
        with_a_keyframed_priority_of_its_own,
        with_a_keyframed_priority_of_its_material,
        instanced_by_what_is_keyframed,
        instanced_by_what_is_constrained_in_another_instance,
        instanced_on_vertices,
        instanced_by_particles,
        instanced_by_geometry_nodes,
        of_a_material_from_geometry_nodes,
    ],
    ids=lambda doubtful: doubtful.__name__,
)
def test_a_medium_that_may_be_anywhere_leaves_all_to_rays(doubtful):
    named, found = doubted(doubtful)
    assert named & {name for name, _ in found.doubts}, found
    assert found.known == ()
    for material in bpy.data.materials:
        sockets = inputs(material)
        assert sockets["Outside"].default_value == Exterior.UNKNOWN, material.name
        assert sockets["Outside Priority"].default_value < 0.0
        assert sockets["Foreign Objects"].default_value
    for obj in bpy.data.objects:
        assert told_by_object(obj) == UNTOLD
