"""However an object comes into the scene, it is the same medium."""

import math

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from mathutils import Matrix
from scenes import (
    add,
    add_box,
    add_camera,
    add_mesh,
    add_sphere,
    mostly_again,
    native,
    new_scene,
    render,
    set_striped_world,
)
from shapes import SHAPE, egg

import nested_dielectric as nd

SAMPLES = 32

# The same rays meet the same triangles to rounding; where rounding sends single samples another way, pixels differ by
# that sample.
MEAN_TOLERANCE = 2e-3
OUTLIERS = 0.02


def stage() -> None:
    """A glass ball that reaches into the object under test, so that its surface and its interior both depend on it."""
    new_scene(48)
    set_striped_world()
    add_camera((0.3, -5, 0.8), (0, 0, 0), angle=30)
    add_sphere("Partner", 0.7, nd.new_material("Partner", ior=1.5), 1, (0.6, -0.2, 0.1))


def water() -> bpy.types.Material:
    return nd.new_material("Water", ior=1.33, transmittance=(0.9, 0.6, 0.4), transmittance_depth=0.7)


def plain(smooth: bool) -> None:
    """The object under test, its shape applied to the mesh."""
    obj = add_mesh("Object", egg, water(), 2, smooth)
    obj.data.transform(SHAPE)


def mirrored(smooth: bool) -> None:
    """Scaled by -1, its mesh mirrored to match."""
    obj = add_mesh("Object", egg, water(), 2, smooth)
    mirror = Matrix.Diagonal((-1, 1, 1, 1))
    obj.data.transform(mirror)
    obj.data.flip_normals()
    obj.matrix_world = SHAPE @ mirror


def parented(smooth: bool) -> None:
    parent = add("Parent", None, (0.5, 0.5, 0.5))
    parent.scale = (2, 1, 1)
    obj = add_mesh("Object", egg, water(), 2, smooth)
    obj.parent = parent
    bpy.context.view_layer.update()
    obj.matrix_world = SHAPE


def collection_instance(smooth: bool, mirror: Matrix | None = None) -> None:
    obj = add_mesh("Object", egg, water(), 2, smooth)
    if mirror is not None:
        obj.data.transform(mirror)
        obj.data.flip_normals()
    collection = bpy.data.collections.new("Instanced")
    bpy.context.scene.collection.objects.unlink(obj)
    collection.objects.link(obj)
    instance = add("Instance", None)
    instance.instance_type = "COLLECTION"
    instance.instance_collection = collection
    instance.matrix_world = SHAPE if mirror is None else SHAPE @ mirror


def mirrored_collection_instance(smooth: bool) -> None:
    collection_instance(smooth, Matrix.Diagonal((1, 1, -1, 1)))


def geometry_nodes_instance(smooth: bool) -> None:
    source = add_mesh("Object", egg, water(), 2, smooth)
    source.data.transform(SHAPE)
    hidden = bpy.data.collections.new("Hidden")
    bpy.context.scene.collection.objects.unlink(source)
    hidden.objects.link(source)
    tree = bpy.data.node_groups.new("Instance", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    points = tree.nodes.new("GeometryNodeMeshLine")
    points.inputs["Count"].default_value = 1
    info = tree.nodes.new("GeometryNodeObjectInfo")
    info.inputs["Object"].default_value = source
    info.inputs["As Instance"].default_value = True
    place = tree.nodes.new("GeometryNodeInstanceOnPoints")
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(points.outputs["Mesh"], place.inputs["Points"])
    tree.links.new(info.outputs["Geometry"], place.inputs["Instance"])
    tree.links.new(place.outputs["Instances"], output.inputs[0])
    host = add("Host", bpy.data.meshes.new("Host"))
    host.modifiers.new("Nodes", "NODES").node_group = tree


def modified(smooth: bool) -> None:
    """A ball that a shape key turns into the egg and a modifier triangulates."""
    obj = add_mesh("Object", lambda bm: bmesh.ops.create_icosphere(bm, subdivisions=3, radius=1.0), water(), 2, smooth)
    obj.modifiers.new("Triangulate", "TRIANGULATE")
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Egg")
    for point in key.data:
        point.co = SHAPE @ (point.co * (1.0 + 0.15 * point.co.x))
    key.value = 1.0


def other_slot(smooth: bool) -> None:
    """The dielectric sits in the second of three slots, and the active one is another."""
    obj = add_mesh("Object", egg, None, 2, smooth)
    obj.data.transform(SHAPE)
    for material in (native("Red", "ShaderNodeBsdfDiffuse"), water(), native("Blue", "ShaderNodeEmission")):
        obj.data.materials.append(material)
    obj.data.polygons.foreach_set("material_index", [1] * len(obj.data.polygons))
    obj.active_material_index = 2


def object_linked_slot(smooth: bool) -> None:
    """The material is linked to the object, not to its mesh."""
    obj = add_mesh("Object", egg, native("Red", "ShaderNodeBsdfDiffuse"), 2, smooth)
    obj.data.transform(SHAPE)
    obj.material_slots[0].link = "OBJECT"
    obj.material_slots[0].material = water()


def material_priority(smooth: bool) -> None:
    """No priority of its own: the material's holds."""
    material = nd.new_material("Water", ior=1.33, transmittance=(0.9, 0.6, 0.4), transmittance_depth=0.7, priority=2)
    add_mesh("Object", egg, material, None, smooth).data.transform(SHAPE)


VARIANTS = (
    mirrored,
    parented,
    collection_instance,
    mirrored_collection_instance,
    geometry_nodes_instance,
    modified,
    other_slot,
    object_linked_slot,
    material_priority,
)

_references: dict[bool, np.ndarray] = {}


def reference(smooth: bool) -> np.ndarray:
    if smooth not in _references:
        stage()
        plain(smooth)
        _references[smooth] = render(SAMPLES)
    return _references[smooth]


def assert_same_rays(ours: np.ndarray, theirs: np.ndarray) -> None:
    assert abs(ours.mean() / theirs.mean() - 1.0) < MEAN_TOLERANCE
    different = np.abs(ours - theirs).max(axis=2) > 1.5 / SAMPLES
    assert different.mean() < OUTLIERS


@pytest.mark.parametrize("smooth", [True, False], ids=["smooth", "flat"])
@pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: variant.__name__)
def test_an_object_is_the_same_medium_however_it_is_placed(variant, smooth):
    expected = reference(smooth)
    stage()
    variant(smooth)
    assert_same_rays(render(SAMPLES), expected)


def test_a_wrong_priority_would_show_in_these_pictures():
    """The comparison above is sensitive: with the two priorities exchanged it fails by far."""
    expected = reference(True)
    stage()
    plain(True)
    nd.set_priority(bpy.data.objects["Object"], 0)
    assert (np.abs(render(SAMPLES) - expected).max(axis=2) > 1.5 / SAMPLES).mean() > 5 * OUTLIERS


@pytest.mark.parametrize("deforming", mostly_again([True, False]), ids=["deforming", "moving"])
def test_media_in_motion_match_the_mean_of_still_frames(deforming):
    """Motion blur over a whole frame, against the mean of 12 instants that split it evenly."""

    def pose(obj, amount: float) -> None:
        if deforming:
            obj.data.shape_keys.key_blocks["Moved"].value = amount
        else:
            obj.location.x = 0.3 * amount

    def build():
        stage()
        plain(True)
        obj = bpy.data.objects["Object"]
        if deforming:
            obj.shape_key_add(name="Basis")
            for point in obj.shape_key_add(name="Moved").data:
                point.co.x += 0.3
        return obj

    instants = 12
    obj = build()
    total = 0.0
    for index in range(instants):
        pose(obj, (index + 0.5) / instants)
        total = total + render(32, seed=index)
    still = total / instants

    obj = build()
    for frame, amount in ((0, -1.0), (1, 0.0), (2, 1.0), (3, 2.0)):
        pose(obj, amount)
        owner = obj.data.shape_keys.key_blocks["Moved"] if deforming else obj
        owner.keyframe_insert("value" if deforming else "location", frame=frame)
    action = (obj.data.shape_keys if deforming else obj).animation_data.action
    for curve in action.layers[0].strips[0].channelbags[0].fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    scene = bpy.context.scene
    scene.frame_set(1)
    scene.render.use_motion_blur = True
    scene.render.motion_blur_position = "START"
    scene.render.motion_blur_shutter = 1.0
    obj.cycles.use_deform_motion = True
    moving = np.mean([render(32, seed=100 + index) for index in range(instants)], axis=0)

    # 384 samples each; a striped world has a standard deviation of 0.3 a sample, so 0.016 a pixel and 0.0003 in the
    # mean of all.
    assert abs(moving.mean() - still.mean()) < 4 * 0.3 / math.sqrt(2 * 384 * moving[..., 0].size) * 2
    blocks = np.abs(moving - still).reshape(6, 8, 6, 8, 3).mean(axis=(1, 3))
    assert blocks.max() < 0.05


def test_thirty_two_media_at_one_point_are_told_apart():
    """Boxes around the camera's aim, one in the other, the innermost the strongest: only the last fills the middle."""
    new_scene(16)
    set_striped_world()
    add_camera((0.31, 0.12, 0.05), (0.31, 5, 0.05), width=0.01)
    for index in range(32):
        half = 1.0 + 0.1 * index
        add_box(f"Box {index}", (-half, -half, -half), (half, half, half), nd.new_material(f"M{index}", ior=1.0), index)
    inside = render(4)
    for obj in [obj for obj in bpy.data.objects if obj.name.startswith("Box")]:
        bpy.data.objects.remove(obj)
    assert np.abs(render(4) - inside).max() < 1e-4


def test_a_keyframed_index_reaches_the_neighbours():
    """What touches an animated medium renders as if its value had been typed in."""

    def build(ior: float):
        stage()
        plain(True)
        socket = bpy.data.materials["Water"].node_tree.nodes["Nested Dielectric"].inputs["IOR"]
        socket.default_value = ior
        return socket

    build(1.45)
    typed = render(SAMPLES)
    socket = build(1.3)
    socket.keyframe_insert("default_value", frame=1)
    socket.default_value = 1.45
    socket.keyframe_insert("default_value", frame=11)
    bpy.context.scene.frame_set(11)
    assert_same_rays(render(SAMPLES), typed)
