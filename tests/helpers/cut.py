"""Bodies that cross, with pictures of them cut and asking."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
from mathutils import Matrix
from scenes import (
    add_box,
    add_camera,
    add_mesh,
    add_plane,
    add_sphere,
    batches,
    diffuse,
    native,
    new_scene,
    set_striped_world,
)
from significance import assert_same_picture

import nested_dielectric as nd

SAMPLES = 128
BATCHES = 16
NODE = "Nested Dielectric"


def now() -> bpy.types.Scene:
    return bpy.context.scene


def stage(resolution: int = 32) -> bpy.types.Scene:
    """Stripes all around, and a camera off all diagonals."""
    scene = new_scene(resolution, with_group=True)
    set_striped_world()
    add_camera((3.03, -5.01, 3.5), (0.01, 0.02, 0), angle=26)
    return scene


def medium(name: str, ior: float, priority: int, **keywords) -> bpy.types.Material:
    return nd.new_material(name, ior=ior, priority=priority, **keywords)


def flatten(obj: bpy.types.Object) -> bpy.types.Object:
    obj.data.polygons.foreach_set("use_smooth", [False] * len(obj.data.polygons))
    return obj


def two_bodies(smooth: bool = False) -> tuple[bpy.types.Object, bpy.types.Object]:
    """A ball that stands half in a block, which it wins over; both turned, the ball stretched."""
    stage()
    ball = add_sphere("Ball", 0.8, medium("Dense", 1.5, 1), segments=72)
    ball.location, ball.rotation_euler, ball.scale = (0.1, 0.2, 0.3), (0.3, 0.5, 0.6), (1.0, 1.1, 0.8)
    if not smooth:
        flatten(ball)
    block = add_box("Block", (-0.8, -0.8, -0.9), (0.8, 0.8, 0.4), medium("Thin", 1.3, 2))
    block.rotation_euler = (0.05, 0.08, 0.3)
    return ball, block


def cut_picture(*names: str) -> np.ndarray:
    """Batches of the current scene, in which these media at least are cut."""
    assert set(names) <= set(nd.prepare(now(), cut=True).cut.media)
    return batches(SAMPLES, BATCHES)


def asking_picture() -> np.ndarray:
    """Batches of the current scene, whose media ask."""
    ask(now())
    return batches(SAMPLES, BATCHES)


def ask(scene: bpy.types.Scene) -> None:
    nd.prepare(scene, cut=False)
    nd.clear_analysis(scene)


def assert_same(ours: np.ndarray, reference: np.ndarray) -> None:
    assert_same_picture(ours, reference, size=8)


def assert_cut_is_right(*names: str) -> None:
    cut = cut_picture(*names)
    assert_same(cut, asking_picture())


def assert_cut_is_as_told(*names: str) -> None:
    """Where light starts inside media, only those that know it absorb on all of its way."""
    cut = cut_picture(*names)
    nd.prepare(now(), cut=False)
    assert_same(cut, batches(SAMPLES, BATCHES))


def boolean(operation: str, first, second) -> bpy.types.Mesh:
    """What an exact boolean makes of two builders' meshes."""
    own, operand = add_mesh("Own", first), add_mesh("Operand", second)
    modifier = own.modifiers.new("Boolean", "BOOLEAN")
    modifier.solver, modifier.operation, modifier.object = "EXACT", operation, operand
    mesh = bpy.data.meshes.new_from_object(own.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    for obj in (own, operand):
        bpy.data.objects.remove(obj)
    return mesh


def cylinder(radius: float, low: float, high: float, segments: int = 48):
    def build(bm: bmesh.types.BMesh) -> None:
        matrix = Matrix.Translation((0.0, 0.0, (low + high) / 2))
        bmesh.ops.create_cone(
            bm, cap_ends=True, segments=segments, radius1=radius, radius2=radius, depth=high - low, matrix=matrix
        )

    return build


def drink() -> tuple[bpy.types.Object, bpy.types.Object, bpy.types.Object]:
    """A tinted tumbler on a table, tinted water that reaches into its wall, ice across the water's surface."""
    scene = stage()
    bpy.data.objects.remove(scene.camera)
    add_camera((1.51, -5, 1.8), (0.01, 0, -0.2), angle=26)
    glass = add_mesh(
        "Glass", lambda bm: None, medium("Glass", 1.5, 0, transmittance=(0.6, 0.9, 0.7), transmittance_depth=0.5)
    )
    material = glass.data.materials[0]
    glass.data = boolean("DIFFERENCE", cylinder(1.0, -1.0, 1.0), cylinder(0.85, -0.85, 1.2))
    glass.data.materials.clear()
    glass.data.materials.append(material)
    water = medium("Water", 1.33, 2, transmittance=(0.3, 0.6, 0.9), transmittance_depth=0.7)
    water = add_mesh("Water", cylinder(0.9, -0.9, 0.5, 44), water)
    water.rotation_euler.z = 0.03
    ice = add_box("Ice", (-0.5, -0.3, 0.1), (0.2, 0.4, 0.8), medium("Ice", 1.31, 1))
    ice.rotation_euler = (0.1, 0.2, 0.3)
    add_plane("Table", 8, (0, 0, -1.01), (0, 0, 1), diffuse(0.7))
    return glass, water, ice


def add_rod() -> None:
    """A spoon that leans against the inside of the glass, through water and into the wall."""
    rod = add_mesh("Rod", cylinder(0.06, -1.2, 1.2, 12), diffuse(0.6))
    rod.location, rod.rotation_euler = (0.5, 0.0, 0.3), (0.1, 0.35, 0.2)


def add_labels(*bodies: bpy.types.Object) -> None:
    red = native("Red", "ShaderNodeBsdfDiffuse", Color=(0.8, 0.1, 0.1, 1.0))
    for body in bodies:
        body.data.materials.append(red)
        body.data.polygons.foreach_set("material_index", [int(face.center.x > 0.4) for face in body.data.polygons])


def key(owner, path: str, *values) -> None:
    """Keyframes on frames 1, 5, 9 and so on."""
    for index, value in enumerate(values):
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=1 + 4 * index)


def inputs_of(body: bpy.types.Object) -> bpy.types.NodeInputs:
    return body.data.materials[0].node_tree.nodes[NODE].inputs


def assert_frame_five_is_right(*names: str) -> None:
    """Prepared on frame 1, where all is otherwise."""
    now().frame_set(1)
    nd.prepare(now(), cut=True)
    now().frame_set(5)
    cut = batches(SAMPLES, BATCHES)
    assert_same(cut, asking_picture())


def shade(body: bpy.types.Object, kind: str, name: str, socket: str = "Refraction Scale", **settings) -> None:
    """A checker in places that a node tells, as how much a surface lets through."""
    tree = body.data.materials[0].node_tree
    source, checker = tree.nodes.new(kind), tree.nodes.new("ShaderNodeTexChecker")
    for setting, value in settings.items():
        setattr(source, setting, value)
    checker.inputs["Scale"].default_value = 4.0
    tree.links.new(source.outputs[name], checker.inputs["Vector"])
    tree.links.new(checker.outputs["Fac"], tree.nodes[NODE].inputs[socket])
