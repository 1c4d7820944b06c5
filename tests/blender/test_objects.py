"""Objects of other types than meshes, and meshes as artists make them, are told or named with a remedy that is theirs."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import pytest
from object_types import curve, metaball, text
from scenes import add, add_box, diffuse, new_scene

import nested_dielectric as nd
from nested_dielectric.analysis.surroundings import last_found
from nested_dielectric.checking.check import check as find_problems
from nested_dielectric.checking.kinds import Severity


def problems() -> list[str]:
    return [str(problem) for problem in find_problems(bpy.context.scene)]


def wrong() -> list[str]:
    """What makes the picture wrong, not only slow."""
    return [str(found) for found in find_problems(bpy.context.scene) if found.severity == Severity.WRONG]


def bevelled_text(material) -> bpy.types.Object:
    return text(material, bevel=0.03)


def ring(material) -> bpy.types.Object:
    return curve(material, capped=False, cyclic=True)


def torus(material) -> bpy.types.Object:
    bpy.ops.surface.primitive_nurbs_surface_torus_add()
    nd.assign(bpy.context.object, material)
    return bpy.context.object


def test_texts_and_curves_that_are_alone_know_it():
    new_scene()
    glass = nd.new_material("Glass", ior=1.5)
    for place, make in enumerate((text, bevelled_text, curve, ring, torus)):
        make(glass).location.z += 3 * place
    assert len(nd.prepare(bpy.context.scene).found.known) == 5


def test_a_text_in_instanced_collections_is_one_medium_in_each():
    new_scene()
    obj = text(nd.new_material("Glass", ior=1.5))
    collection = bpy.data.collections.new("Letters")
    bpy.context.scene.collection.objects.unlink(obj)
    collection.objects.link(obj)
    for x in (0, 5):
        instance = add("Instance", None, (x, 0, 0))
        instance.instance_type, instance.instance_collection = "COLLECTION", collection
    result = nd.prepare(bpy.context.scene)
    assert result.problems == () and result.found.known == ("Text",)


def test_a_text_that_is_typed_on_is_followed():
    new_scene()
    nd.register()
    try:
        obj = text(nd.new_material("Glass", ior=1.5, priority=2))
        add_box("Far", (2, -1, -1), (4, 1, 1), nd.new_material("Water", ior=1.33, priority=1))
        assert set(nd.prepare(bpy.context.scene).found.known) == {"Text", "Far"}
        obj.data.body = "HIHIHI"
        bpy.context.view_layer.update()
        assert set(last_found(bpy.context.scene).asking) == {"Text", "Far"}
    finally:
        nd.unregister()


def test_a_curve_that_another_object_shapes_asks_while_that_one_moves():
    new_scene()
    obj = curve(nd.new_material("Glass", ior=1.5))
    profile = bpy.data.curves.new("Profile", "CURVE")
    profile.splines.new("POLY").points.add(3)
    for point, place in zip(profile.splines[0].points, ((-0.2, 0.2), (0.2, 0.2), (0.2, -0.2), (-0.2, -0.2))):
        point.co = (*place, 0, 1)
    profile.splines[0].use_cyclic_u = True
    obj.data.bevel_mode, obj.data.bevel_object = "OBJECT", add("Profile", profile)
    assert not nd.prepare(bpy.context.scene).found.doubts
    obj.data.bevel_object.keyframe_insert("scale", frame=1)
    assert dict(nd.prepare(bpy.context.scene).found.doubts)["Curve"] == "may change its shape with 'Profile'"


def test_a_metaball_asks_while_one_of_its_family_moves():
    new_scene()
    metaball(nd.new_material("Water", ior=1.33))
    bpy.data.objects["Blob.001"].data.materials.clear()
    assert not nd.prepare(bpy.context.scene).found.doubts
    bpy.data.objects["Blob.001"].keyframe_insert("location", frame=1)
    assert dict(nd.prepare(bpy.context.scene).found.doubts)["Blob"] == "may change its shape with 'Blob.001'"


def test_a_metaball_that_merges_into_another_medium_is_named():
    new_scene()
    metaball(nd.new_material("Water", ior=1.33))
    assert problems() == []
    nd.set_priority(bpy.data.objects["Blob.001"], 7)
    (found,) = problems()
    assert found.startswith("'Blob.001' merges into the metaball 'Blob'") and "a name of its own" in found
    bpy.data.objects["Blob.001"].name = "Other"
    assert problems() == []


def test_the_remedy_for_what_is_not_closed_can_be_done_on_that_object():
    new_scene()
    glass = nd.new_material("Glass", ior=1.5)
    opened = {
        text(glass, extrude=0.0): "give it an Extrude",
        curve(glass, capped=False): "switch on Fill Caps",
        curve(glass): "give it a Bevel Depth",
        text(glass): "give it letters",
        torus(glass): "Cyclic",
    }
    for obj, change in zip(list(opened)[2:], (("bevel_depth", 0.0), ("body", ""), None)):
        if change is None:
            obj.data.splines[0].use_cyclic_u = False
        else:
            setattr(obj.data, *change)
    found = {problem.name: str(problem) for problem in nd.prepare(bpy.context.scene).problems}
    assert found.keys() == {obj.name for obj in opened}
    for obj, remedy in opened.items():
        assert remedy in found[obj.name] and "Fill Holes" not in found[obj.name]


def seamed_box(name: str, low, high, material) -> bpy.types.Object:
    """Each face has vertices of its own, as in files for printers."""
    obj = add_box(name, low, high, material)
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    bmesh.ops.split_edges(bm, edges=bm.edges)
    bm.to_mesh(obj.data)
    bm.free()
    return obj


def test_a_seam_is_no_gap_and_parting_leaves_it_closed():
    new_scene()
    add_box("Glass", (-1, -1, -1), (1, 1, 0), nd.new_material("Glass", ior=1.5, priority=1))
    water = seamed_box("Water", (-1, -1, 0), (1, 1, 1), nd.new_material("Water", ior=1.33, priority=2))
    result = nd.prepare(bpy.context.scene)
    assert any("parted" in change for change in result.changes) and result.problems == () and not result.found.doubts
    assert nd.prepare(bpy.context.scene).problems == ()
    evaluated = water.evaluated_get(bpy.context.evaluated_depsgraph_get())
    assert len({tuple(vertex.co) for vertex in evaluated.data.vertices}) == 8


def test_a_text_with_faces_in_the_same_place_as_others_is_named():
    new_scene()
    add_box("Glass", (-2, -2, -1), (2, 0.2, 1), nd.new_material("Glass", ior=1.5, priority=1))
    text(nd.new_material("Water", ior=1.33, priority=2), extrude=0.2)
    found = [str(problem) for problem in nd.prepare(bpy.context.scene).problems]
    assert any(each.startswith("'Text' has faces in the same place as 'Glass'") and "Convert" in each for each in found)


def point_cloud() -> bpy.types.ID:
    data = bpy.data.pointclouds.new("Foam")
    data.resize(4)
    return data


def hair_curves() -> bpy.types.ID:
    data = bpy.data.hair_curves.new("Fibre")
    data.add_curves([2])
    return data


NO_SOLIDS = {
    "point cloud": point_cloud,
    "hair curves": hair_curves,
    "a volume": lambda: bpy.data.volumes.new("Smoke"),
    "grease pencil": lambda: bpy.data.grease_pencils.new("Sketch"),
}


def test_what_has_no_inside_is_refused_by_name():
    new_scene()
    glass = nd.new_material("Glass", ior=1.5)
    for kind, make in NO_SOLIDS.items():
        obj = add(f"Thing of {kind}", make())
        with pytest.raises(nd.ParameterError, match=f"{obj.name!r} is .*{kind}"):
            nd.assign(obj, glass)
        assert not obj.material_slots
        obj.data.materials.append(glass)
    found = {problem.name: problem.text for problem in nd.prepare(bpy.context.scene).problems}
    for kind in list(NO_SOLIDS)[:3]:  # Cycles does not render grease pencil
        assert found[f"Thing of {kind}"].startswith("is ") and kind in found[f"Thing of {kind}"]


def test_points_that_a_modifier_makes_of_a_medium_are_named():
    new_scene()
    obj = add_box("Foam", (-1, -1, -1), (1, 1, 1), nd.new_material("Water", ior=1.33))
    tree = bpy.data.node_groups.new("Points", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    source, sink = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    points = tree.nodes.new("GeometryNodeMeshToPoints")
    tree.links.new(source.outputs[0], points.inputs[0])
    painted = tree.nodes.new("GeometryNodeSetMaterial")
    painted.inputs["Material"].default_value = obj.active_material
    tree.links.new(points.outputs[0], painted.inputs[0])
    tree.links.new(painted.outputs[0], sink.inputs[0])
    obj.modifiers.new("Points", "NODES").node_group = tree
    assert any("'Foam' makes a point cloud of a nested dielectric" in each for each in problems())


def test_strands_of_a_nested_dielectric_are_named():
    new_scene()
    obj = add_box("Brush", (-1, -1, -1), (1, 1, 1), nd.new_material("Water", ior=1.33))
    obj.data.materials.append(diffuse())
    obj.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = obj.particle_systems[0].settings
    settings.type, settings.render_type, settings.material = "HAIR", "PATH", 2
    assert problems() == []
    settings.material = 1
    assert any("'Brush' makes hair curves of a nested dielectric" in each for each in problems())


def two_boxes(name: str, first: bpy.types.Material, second: bpy.types.Material) -> bpy.types.Object:
    """An object of two boxes that overlap, each of its own material."""
    obj = add_box(name, (-1, -1, -1), (1, 1, 0), first)
    other = add_box("Other", (-0.9, -0.9, -0.1), (0.9, 0.9, 1), second)
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    count = len(bm.faces)
    bm.from_mesh(other.data)
    for face in list(bm.faces)[count:]:
        face.material_index = 1
    bm.to_mesh(obj.data)
    bm.free()
    bpy.data.objects.remove(other)
    obj.data.materials.append(second)
    return obj


def test_two_media_in_one_mesh_are_named_with_the_remedy():
    new_scene()
    obj = two_boxes("Both", nd.new_material("Glass", ior=1.5), nd.new_material("Water", ior=1.33))
    (found,) = nd.prepare(bpy.context.scene).problems
    assert "'Both' has 2 media in one object, 'Glass' and 'Water'" in str(found) and "By Material" in found.remedy
    obj.data.polygons.foreach_set("material_index", [0] * len(obj.data.polygons))
    assert wrong() == []


def test_a_medium_whose_faces_differ_in_what_concerns_no_neighbour_is_one():
    new_scene()
    two_boxes("Etched", nd.new_material("Glass", ior=1.5), nd.new_material("Frosted", ior=1.5, roughness=0.3))
    assert wrong() == []
    bpy.data.objects.remove(bpy.data.objects["Etched"])
    two_boxes("Labelled", nd.new_material("Bottle", ior=1.5), diffuse())
    assert wrong() == []


def test_two_media_in_one_curve_are_named_with_the_remedy():
    new_scene()
    obj = curve(nd.new_material("Glass", ior=1.5))
    obj.data.materials.append(nd.new_material("Water", ior=1.33))
    assert problems() == []
    spline = obj.data.splines.new("POLY")
    spline.points.add(1)
    spline.points[1].co = (0, 0, 3, 1)
    spline.material_index = 1
    (found,) = problems()
    assert "2 media in one object" in found and "Convert" in found
