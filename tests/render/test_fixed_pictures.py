"""What is wrong shows in the picture, and what has been fixed renders as what was right from the start."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from faults import flip, found, mend, open_up
from mathutils import Matrix
from scenes import (
    add,
    add_box,
    add_camera,
    add_mesh,
    add_sphere,
    batches,
    diffuse,
    mostly_again,
    new_scene,
    set_striped_world,
)
from significance import assert_same_picture, deviations, tile_means

import nested_dielectric as nd
from nested_dielectric.checking.finding import Action
from nested_dielectric.model.parameter import PRIORITY_PROPERTY

SAMPLES, BATCHES, SIZE, TILE = 256, 16, 32, 8

SURELY = 1e-6
"""Chance of the largest difference between the wrong picture and the right one, were there none."""


def stage(distance: float = 5.0, target=(0, 0, 0)) -> None:
    new_scene(SIZE, with_group=True)
    set_striped_world()
    x, y, z = target
    add_camera((x + 0.3, y - distance, z + 1.5), target, angle=28)


def picture() -> np.ndarray:
    bpy.context.view_layer.update()
    return batches(SAMPLES, BATCHES)


def glass(ior: float = 1.5) -> bpy.types.Material:
    return nd.new_material("Glass", ior=ior)


def cylinder(name: str, low: float, high: float, radius: float, material, priority=None) -> bpy.types.Object:
    """An upright one; through blocks the world would look as without them."""
    place = Matrix.Translation((0, 0, 0.5 * (low + high)))

    def build(bm):
        bmesh.ops.create_cone(
            bm, cap_ends=True, segments=32, radius1=radius, radius2=radius, depth=high - low, matrix=place
        )

    return add_mesh(name, build, material, priority)


def ball(wrong=None) -> None:
    obj = add_sphere("Ball", 1.0, glass(1.3), segments=32)
    if wrong:
        wrong(obj)


def can(wrong=None) -> None:
    obj = cylinder("Can", -0.7, 0.7, 0.8, glass())
    if wrong:
        wrong(obj)


def _caps(obj: bpy.types.Object) -> list[int]:
    return [polygon.index for polygon in obj.data.polygons if len(polygon.vertices) > 4]


def tube(caps: bool) -> None:
    curve = bpy.data.curves.new("Tube", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.use_fill_caps = "3D", 0.5, caps
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points[0].co, spline.points[1].co = (0, -0.8, 0, 1), (0, 0.8, 0, 1)
    curve.materials.append(glass())
    add("Tube", curve)


def shell(bm) -> None:
    bmesh.ops.create_uvsphere(bm, u_segments=32, v_segments=16, radius=1.0)
    inner = bmesh.ops.create_uvsphere(bm, u_segments=32, v_segments=16, radius=0.7)
    bmesh.ops.reverse_faces(bm, faces=list({face for vertex in inner["verts"] for face in vertex.link_faces}))


def drink(radius: float) -> None:
    add_mesh("Shell", shell, glass(), 1, smooth=True)
    add_sphere("Water", radius, nd.new_material("Water", ior=1.33), 2, segments=32)


def two(low: float, first: int, second: int) -> None:
    """Two different media, one over the other."""
    cylinder("Ice", -0.7, 0.1, 0.8, nd.new_material("Ice", ior=1.31), first)
    cylinder("Dense", low, 0.8, 0.55, nd.new_material("Dense", ior=1.8), second)


def on_table(height: float) -> None:
    add_box("Table", (-3, -3, -1.5), (3, 3, -0.6), diffuse(0.6))
    cylinder("Can", -0.6 + height, 0.6, 0.8, glass())


def nested(bounces: int) -> None:
    for index in range(4):
        add_sphere(
            f"Shell {index}", 1.0 - 0.2 * index, nd.new_material(f"Glass {index}", ior=1.2 + 0.2 * index), 9 - index
        )
    scene = bpy.context.scene
    scene.cycles.max_bounces = scene.cycles.transmission_bounces = bounces


def tinted(depth: float) -> None:
    material = nd.new_material("Wine", ior=1.3, transmittance=(0.5, 0.2, 0.3), transmittance_depth=depth)
    add_sphere("Ball", 0.9, material)


def drop_in_ball() -> bpy.types.Object:
    """A ball and a drop in it that wins, whose surface reads how the ball refracts."""
    add_sphere("Drop", 0.6, nd.new_material("Drop", ior=1.5), 1, segments=32)
    return add_sphere("Ball", 1.0, nd.new_material("Around", ior=1.9), 2, segments=32)


def named(name: str) -> None:
    """A medium whose node has some name."""
    drop_in_ball()
    bpy.data.materials["Around"].node_tree.nodes["Nested Dielectric"].name = name


def slots(index: int) -> None:
    """A medium in some slot."""
    obj = drop_in_ball()
    obj.data.materials.clear()
    for number in range(9):
        obj.data.materials.append(bpy.data.materials.new(f"Paint {number}"))
    obj.data.materials[index] = bpy.data.materials["Around"]
    obj.data.polygons.foreach_set("material_index", [index] * len(obj.data.polygons))


def copies(count: int) -> None:
    """A medium, and others in its place that it wins over."""
    first = cylinder("Can", -0.7, 0.7, 0.8, glass(), 1)
    for _ in range(count - 1):
        nd.set_priority(add("Copy", first.data), 2)


def priorities(own) -> None:
    two(-0.3, 2, 3)
    bpy.data.objects["Dense"].pop(PRIORITY_PROPERTY)
    bpy.data.materials["Dense"].node_tree.nodes["Nested Dielectric"].inputs["Priority"].default_value = 1
    if own is not None:
        bpy.data.objects["Dense"][PRIORITY_PROPERTY] = own


# What is wrong, what mends it, and what is right. Distances that a modifier has moved faces by are those of the right scene.
CASES = {
    Action.RECALCULATE_NORMALS: (lambda: ball(flip), found(Action.RECALCULATE_NORMALS, "Ball"), ball),
    Action.CLOSE_HOLES: (lambda: can(lambda obj: open_up(obj, *_caps(obj))), found(Action.CLOSE_HOLES, "Can"), can),
    Action.FILL_CAPS: (lambda: tube(False), found(Action.FILL_CAPS, "Tube"), lambda: tube(True)),
    Action.PUSH_INTO_WALL: (
        lambda: drink(0.67),
        found(Action.PUSH_INTO_WALL, "Water", "Shell", value=0.06),
        lambda: drink(0.73),
    ),
    Action.PART_FACES: (lambda: two(0.1, 1, 2), found(Action.PART_FACES, "Dense", "Ice"), lambda: two(0.0995, 1, 2)),
    Action.SET_PRIORITY: (
        lambda: two(-0.3, 2, 2),
        found(Action.SET_PRIORITY, "Dense", value=1),
        lambda: two(-0.3, 2, 1),
    ),
    Action.SET_SETTING: (
        lambda: nested(2),
        found(Action.SET_SETTING, "Scene", value=64, path="cycles.max_bounces"),
        lambda: nested(64),
    ),
    Action.SET_DEPTH: (lambda: tinted(0.01), found(Action.SET_DEPTH, "Ball", value=1.2), lambda: tinted(1.2)),
    Action.MERGE_COPIES: (lambda: copies(2), found(Action.MERGE_COPIES, "Copy"), lambda: copies(1)),
    Action.MOVE_APART: (
        lambda: on_table(0.0),
        found(Action.MOVE_APART, "Can", "Table", value=0.002),
        lambda: on_table(0.002),
    ),
    Action.MEND_NODES: (lambda: named("Mine"), found(Action.MEND_NODES, "Around"), lambda: named("Nested Dielectric")),
    Action.MOVE_SLOT: (lambda: slots(8), found(Action.MOVE_SLOT, "Ball"), lambda: slots(0)),
    Action.REMOVE_PROPERTY: (
        lambda: priorities(7),
        found(Action.REMOVE_PROPERTY, "Dense", path=PRIORITY_PROPERTY),
        lambda: priorities(None),
    ),
}


@pytest.mark.parametrize("action", mostly_again(CASES, 3))
def test_what_is_fixed_renders_as_what_was_right_from_the_start(action):
    wrong, finding, right = CASES[action]
    stage()
    right()
    reference = picture()
    stage()
    wrong()
    faulty = picture()
    assert nd.fix(bpy.context.scene, finding)
    if action == Action.SET_SETTING:
        mend(Action.SET_SETTING, "Scene", value=64, path="cycles.transmission_bounces")
    assert_same_picture(picture(), reference, TILE)
    _, chance = deviations(*(tile_means(each, TILE) for each in (faulty, reference)))
    assert chance.min() < SURELY


def tiny_and_turned() -> bpy.types.Object:
    """A block a thousandth as large as the mesh, mirrored and turned."""
    obj = add_box("Box", (-800, -700, -600), (800, 700, 600), glass())
    obj.matrix_basis = Matrix.Rotation(0.4, 4, (1, 2, 3)) @ Matrix.Diagonal((1e-3, -1e-3, 1e-3, 1))
    obj.data.flip_normals()
    flip(obj)
    return obj


def test_an_applied_transform_leaves_the_picture_as_it_is():
    stage()
    tiny_and_turned()
    before = picture()
    assert mend(Action.APPLY_TRANSFORM, "Box")
    assert_same_picture(picture(), before, TILE)


def test_a_scene_brought_to_the_origin_renders_as_one_that_was_built_there():
    stage()
    ball()
    reference, turned = picture(), bpy.context.scene.camera.rotation_euler.copy()
    far = (1e6, -1e6, 1e6)
    stage(target=far)
    ball()
    bpy.data.objects["Ball"].location = far
    faulty = picture()
    assert mend(Action.MOVE_TO_ORIGIN, "Scene")
    # Coordinates of single precision are 0.06 apart there, by which camera and ball stand elsewhere and look elsewhere.
    for name, place in (("Ball", (0, 0, 0)), ("Camera", (0.3, -5.0, 1.5))):
        obj = bpy.data.objects[name]
        assert np.abs(np.array(obj.location) - place).max() < 0.1
        obj.location = place
    bpy.context.scene.camera.rotation_euler = turned
    assert_same_picture(picture(), reference, TILE)
    _, chance = deviations(*(tile_means(each, TILE) for each in (faulty, reference)))
    assert chance.min() < SURELY
