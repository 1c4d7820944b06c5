"""Media that may have another shape in renders leave their neighbours to rays."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import pytest
from doubted import doubted
from mathutils import Matrix
from scenes import add, add_mesh, diffuse
from told import ball, codes, fresh, inputs, instance, into_collection, medium, ordinary_scene, told_code

import nested_dielectric as nd
from nested_dielectric.model.contract import Exterior


def with_a_modifier_in_the_viewport_alone(obj) -> None:
    obj.modifiers.new("Bevel", "BEVEL").show_render = False


def subdivided_otherwise_in_renders(obj) -> None:
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 1, 2


def subdivided_and_simplified(obj) -> None:
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 1
    bpy.context.scene.render.use_simplify = True
    bpy.context.scene.render.simplify_subdivision_render = 0


def with_other_steps_in_renders(obj) -> None:
    mesh = bpy.data.meshes.new("Profile")
    corners = [(0.2, 0, -0.2), (0.4, 0, -0.2), (0.4, 0, 0.2), (0.2, 0, 0.2)]
    mesh.from_pydata(corners, [(0, 1), (1, 2), (2, 3), (3, 0)], [])
    mesh.materials.append(obj.active_material)
    obj.data = mesh
    modifier = obj.modifiers.new("Screw", "SCREW")
    modifier.steps, modifier.render_steps = 8, 32
    modifier.use_merge_vertices = modifier.use_normal_flip = True


def instanced_with_a_collection_hidden_from_renders(obj) -> tuple[str, ...]:
    inner, outer = into_collection(obj), bpy.data.collections.new("Outer")
    outer.children.link(inner)
    inner.hide_render = True
    instance(outer)
    return obj.name, inner.name


def seen_by_no_ray(obj) -> None:
    for kind in ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
        setattr(obj, f"visible_{kind}", False)


def culled_by_its_distance(obj) -> None:
    scene = bpy.context.scene
    scene.render.use_simplify = scene.cycles.use_distance_cull = obj.cycles.use_distance_cull = True
    scene.cycles.distance_cull_margin = 0.1


def culled_by_the_camera(obj) -> None:
    scene = bpy.context.scene
    scene.render.use_simplify = scene.cycles.use_camera_cull = obj.cycles.use_camera_cull = True


def of_two_media(obj) -> None:
    obj.data.materials.append(bpy.data.materials["Water"])


def instanced_by_what_is_hidden_from_renders(obj) -> tuple[str, ...]:
    instancer = instance(into_collection(obj))
    instancer.hide_render = True
    return obj.name, instancer.name


def curved(obj) -> str:
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.splines.new("POLY").points.add(1)
    curve.materials.append(obj.active_material)
    return add("Curve", curve).name


@pytest.mark.parametrize(
    "doubtful",
    [
        with_a_modifier_in_the_viewport_alone,
        subdivided_otherwise_in_renders,
        subdivided_and_simplified,
        with_other_steps_in_renders,
        seen_by_no_ray,
        culled_by_its_distance,
        culled_by_the_camera,
        of_two_media,
        curved,
        instanced_by_what_is_hidden_from_renders,
        instanced_with_a_collection_hidden_from_renders,
    ],
    ids=lambda doubtful: doubtful.__name__,
)
def test_a_medium_that_may_have_another_shape_leaves_its_neighbours_to_rays(doubtful):
    named, found = doubted(doubtful)
    assert named & ({name for name, _ in found.doubts} | set(found.asking)), found
    assert {codes()[name] for name in ("Water", "Crossing")} == {Exterior.UNKNOWN}
    assert all(
        inputs(bpy.data.materials[name])["Outside Priority"].default_value < 0.0 for name in ("Water", "Crossing")
    )
    assert all(
        inputs(material)["Outside"].default_value in (Exterior.UNKNOWN, Exterior.BY_OBJECT)
        for material in bpy.data.materials
        if material.name != "Bystander"
    )


def subdivided_in_the_viewport_alone(obj) -> None:
    """A needle, whose surface in the viewport is a fraction as long."""
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels, modifier.render_levels = 4, 0


def repeated_in_renders_alone(obj) -> None:
    modifier = obj.modifiers.new("Array", "ARRAY")
    modifier.use_relative_offset, modifier.use_constant_offset = False, True
    modifier.constant_offset_displace = (0.0, 0.0, 3.0)
    modifier.show_viewport = False


def mirrored_in_renders_alone(obj) -> None:
    obj.data.transform(Matrix.Translation((0, 0, -3.0)))
    obj.location.z = 3.0
    modifier = obj.modifiers.new("Mirror", "MIRROR")
    modifier.use_axis = (False, False, True)
    modifier.show_viewport = False


@pytest.mark.parametrize(
    "reach",
    [subdivided_in_the_viewport_alone, repeated_in_renders_alone, mirrored_in_renders_alone],
    ids=lambda reach: reach.__name__,
)
def test_what_a_medium_reaches_in_renders_alone_is_not_told_of_air(reach):
    scene = fresh()

    def needle(bm) -> None:
        bmesh.ops.create_cone(bm, cap_ends=True, segments=3, radius1=0.1, radius2=0.0, depth=5.0)

    long = add_mesh("Needle", needle, medium("Needle", 1.5), 1)
    reached = ball("Reached", 0.1, medium("Reached", 1.33), 2)
    reached.location.z = 2.4
    if reach is not subdivided_in_the_viewport_alone:
        long.data.transform(Matrix.Scale(0.1, 4))
        reached.location.z = 3.0
        assert nd.analyse(scene).known == ("Needle", "Reached")
    reach(long)
    nd.analyse(scene)
    assert told_code(reached) == Exterior.UNKNOWN


def test_what_is_the_same_in_renders_is_not_doubted():
    scene, bead = ordinary_scene()
    bead.parent = add("Parent", None)
    bead.modifiers.new("Hidden", "BUILD").show_viewport = False
    bead.modifiers["Hidden"].show_render = False
    subdivision = bead.modifiers.new("Subdivision", "SUBSURF")
    subdivision.levels = subdivision.render_levels = 1
    bead.shape_key_add(name="Basis")
    hidden = ball("Hidden", 1.0, medium("Hidden", 1.2), 0)
    hidden.hide_viewport = hidden.hide_render = True
    ball("Foreign", 0.3, diffuse(), None, (0.0, 0.0, 9.0)).keyframe_insert("location", frame=1)
    assert not nd.analyse(scene).doubts
    assert told_code(bead) == Exterior.MEDIUM
