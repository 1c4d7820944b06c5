"""Bodies that are cut where they cross render the picture of bodies that ask the scene, or are split by hand."""

import random

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from cut import (
    BATCHES,
    SAMPLES,
    asking_picture,
    assert_cut_is_right,
    assert_same,
    boolean,
    cut_picture,
    medium,
    now,
    stage,
    two_bodies,
)
from mathutils import Matrix
from scenes import (
    add,
    add_camera,
    add_mesh,
    add_sphere,
    batches,
    cycles_glass,
    mostly_again,
    new_scene,
    set_striped_world,
)

import nested_dielectric as nd


def build_torus(bm: bmesh.types.BMesh) -> None:
    rings = [
        [
            bm.verts.new(Matrix.Rotation(turn, 3, "Z") @ Matrix.Rotation(way, 3, "Y").col[0] * 0.35)
            for way in np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
        ]
        for turn in np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    ]
    for ring, turn in zip(rings, np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)):
        for vertex in ring:
            vertex.co += Matrix.Rotation(turn, 3, "Z").col[0] * 0.8
    for ring, following in zip(rings, rings[1:] + rings[:1]):
        for i in range(24):
            bm.faces.new((ring[i - 1], ring[i], following[i], following[i - 1]))
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces)


ROUND = {
    "ball": lambda bm: bmesh.ops.create_uvsphere(bm, u_segments=48, v_segments=24, radius=1.0),
    "geodesic": lambda bm: bmesh.ops.create_icosphere(bm, subdivisions=4, radius=1.0),
    "ring": build_torus,
    "head": bmesh.ops.create_monkey,
}
"""Shapes that are shaded smooth or flat."""

ANGULAR = {
    "box": lambda bm: bmesh.ops.create_cube(bm, size=1.6),
    "cone": lambda bm: bmesh.ops.create_cone(bm, cap_ends=True, segments=20, radius1=1.0, radius2=0.3, depth=1.8),
}


def random_material(name: str, priority: int, chance: random.Random) -> bpy.types.Material:
    ior = chance.choice((1.0, 1.1, 1.33, 1.5, 1.8))
    kind = chance.choice(("clear", "clear", "tinted", "rough", "dispersing"))
    if kind == "tinted":
        tint = [chance.uniform(0.3, 1.0) for _ in range(3)]
        return medium(name, ior, priority, transmittance=tint, transmittance_depth=1.0)
    if kind == "rough":
        return medium(name, ior, priority, roughness=chance.choice((0.1, 0.3)))
    if kind == "dispersing":
        return medium(name, 1.5, priority, disperse=True, abbe=chance.choice((20.0, 40.0)))
    return medium(name, ior, priority)


def random_scene(seed: int, mirrored: bool = False) -> bpy.types.Scene:
    """Two to seven closed bodies of two to five materials, one priority each, that cross at random."""
    chance = random.Random(seed)
    scene = new_scene(32, with_group=True)
    set_striped_world()
    add_camera((0.31, -9, 1.13), (0.02, 0.01, 0.03), angle=30)
    materials = [random_material(f"Medium {index}", index, chance) for index in range(chance.randint(2, 5))]
    for index in range(chance.randint(2, 7)):
        kind = chance.choice((*ROUND, *ANGULAR))
        smooth = kind in ROUND and chance.random() < 0.5
        body = add_mesh(f"{kind} {index}", (ROUND | ANGULAR)[kind], chance.choice(materials), smooth=smooth)
        if kind == "head":
            remesh = body.modifiers.new("Closed", "REMESH")
            remesh.voxel_size, remesh.use_smooth_shade = 0.12, smooth
        if chance.random() < 0.3:
            body.parent = add(f"Parent {index}", None, [chance.uniform(-0.3, 0.3) for _ in range(3)])
            body.parent.rotation_euler = [chance.uniform(0.0, 3.0) for _ in range(3)]
            body.parent.scale = [chance.uniform(0.7, 1.2) for _ in range(3)]
        body.location = [chance.uniform(-0.9, 0.9) for _ in range(3)]
        body.rotation_euler = [chance.uniform(0.0, 3.0) for _ in range(3)]
        body.scale = [chance.uniform(0.5, 1.2) for _ in range(3)]
        if mirrored and chance.random() < 0.5:
            body.scale[chance.randrange(3)] *= -1.0
    return scene


@pytest.mark.parametrize("seed", mostly_again((5, 6, 8, 11), 2))
def test_random_bodies_that_are_cut_look_as_those_that_ask(seed):
    random_scene(seed)
    assert_cut_is_right()


def add_part(name: str, mesh: bpy.types.Mesh, keeps, ratio: float) -> None:
    """The faces of a mesh whose middles are kept, as an interface of that ratio of indices."""

    def build(bm: bmesh.types.BMesh) -> None:
        bm.from_mesh(mesh)
        bmesh.ops.delete(bm, geom=[face for face in bm.faces if not keeps(face.calc_center_median())], context="FACES")

    add_mesh(name, build, cycles_glass(ratio))


def test_two_boxes_that_are_cut_match_interfaces_split_by_hand():
    """Glass wins over water that it stands in."""
    low, high = (-0.83, -0.71, -0.9), (0.6, 0.55, 0.17)
    place = Matrix.Translation(np.add(low, high) / 2) @ Matrix.Diagonal((*np.subtract(high, low), 1.0))
    turn = Matrix.Rotation(0.4, 4, "Z") @ Matrix.Rotation(0.3, 4, "X")

    def glass(bm):
        bmesh.ops.create_cube(bm, size=1.1, matrix=Matrix.Translation((0.1, 0.05, 0.2)) @ turn)

    def water(bm):
        bmesh.ops.create_cube(bm, size=1.0, matrix=place)

    def on_water(point) -> bool:
        return bool(min(np.abs(np.subtract(point, low)).min(), np.abs(np.subtract(point, high)).min()) < 1e-5)

    stage()
    add_mesh("Glass", glass, medium("Glass", 1.5, 1, shadow_mode="BLACK"))
    add_mesh("Water", water, medium("Water", 1.33, 2, shadow_mode="BLACK"))
    cut = cut_picture("Glass", "Water")
    stage()
    together = boolean("UNION", glass, water)
    add_part("Glass in air", together, lambda point: not on_water(point), 1.5)
    add_part("Water in air", together, on_water, 1.33)
    add_part("Glass in water", boolean("INTERSECT", glass, water), lambda point: not on_water(point), 1.5 / 1.33)
    assert_same(cut, batches(SAMPLES, BATCHES))


def test_media_that_cannot_be_cut_ask_beside_those_that_are():
    """An open shell in a ball of its own, far enough from the others to have nothing to do with them."""
    ball, block = two_bodies()
    ball.location.x, block.location.x = -0.4, -0.5
    shell = add_sphere("Shell", 0.5, bpy.data.materials["Thin"], location=(1.4, 0.0, 0.3), segments=24)
    core = add_sphere("Core", 0.4, bpy.data.materials["Dense"], location=(1.5, -0.1, 0.5), segments=24)
    bm = bmesh.new()
    bm.from_mesh(shell.data)
    bm.faces.ensure_lookup_table()
    bmesh.ops.delete(bm, geom=bm.faces[:3], context="FACES")
    bm.to_mesh(shell.data)
    bm.free()
    found = nd.prepare(now(), cut=True).cut
    assert set(found.media) == {"Ball", "Block"}
    assert dict(found.asking) == {"Shell": "is not closed", "Core": "may meet 'Shell', which is not cut"}
    assert not shell.hide_render and not core.hide_render
    cut = batches(SAMPLES, BATCHES)
    assert_same(cut, asking_picture())


@pytest.mark.parametrize("smooth", mostly_again([True, False]), ids=["smooth", "flat"])
def test_mirrored_bodies_are_cut(smooth):
    ball, _block = two_bodies(smooth)
    ball.scale.x = -1.0
    assert_cut_is_right("Ball", "Block")


def test_mirrored_bodies_of_one_medium_are_one_body():
    ball, block = two_bodies()
    ball.data.materials[0] = block.data.materials[0]
    ball.scale.x = -1.0
    add_sphere("Drop", 0.4, medium("Drop", 1.7, 0), location=(0.6, 0.0, 0.4))
    assert_cut_is_right("Ball", "Block")


@pytest.mark.parametrize("seed", mostly_again(range(2)))
def test_random_bodies_of_which_some_are_mirrored(seed):
    random_scene(seed, mirrored=True)
    assert_cut_is_right()


def test_what_a_collection_hides_from_renders_stays_hidden():
    _ball, block = two_bodies()
    hidden = bpy.data.collections.new("Hidden")
    now().collection.children.link(hidden)
    hidden.hide_render = True
    hidden.objects.link(block)
    now().collection.objects.unlink(block)
    assert_cut_is_right()
