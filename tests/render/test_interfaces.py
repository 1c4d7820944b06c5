"""Nested and overlapping media, against the same interfaces split by hand in Cycles' own Glass."""

import bpy  # before bmesh, which lives inside it

import bmesh  # isort: skip
import numpy as np
import pytest
from mathutils import Matrix
from references import reference_batches
from scenes import add_camera, add_mesh, add_sphere, batches, cycles_glass, mostly_again, new_scene, set_striped_world
from significance import assert_same_picture

import nested_dielectric as nd

SAMPLES = 1024
BATCHES = 16


def test_nested_spheres_match_interfaces_split_by_hand():
    """Glass around water around air, and the pictures of the interfaces glass-air, water-glass and air-water."""

    def scene() -> None:
        new_scene(64)
        set_striped_world()
        add_camera((0, -5, 0.3), (0, 0, 0), angle=28)

    scene()
    for name, radius, ior, priority in (("Glass", 1.0, 1.5, 2), ("Water", 0.8, 1.33, 1), ("Air", 0.5, 1.0, 0)):
        add_sphere(name, radius, nd.new_material(name, ior=ior, shadow_mode="BLACK"), priority)
    ours = batches(SAMPLES, BATCHES)

    scene()
    for name, radius, ratio in (("Glass", 1.0, 1.5), ("Water", 0.8, 1.33 / 1.5), ("Air", 0.5, 1 / 1.33)):
        add_sphere(name, radius, cycles_glass(ratio))
    assert_same_picture(ours, reference_batches(SAMPLES, BATCHES))


INDICES = {"X": 1.5, "Y": 1.33, "Z": 1.8}
"""Index of refraction of three cylinders that cross at the origin, named by their axes."""

RADII = {"X": 0.5, "Y": 0.6, "Z": 0.7}
LENGTH = 2.4
SIDES = 24


def cylinder_frame(axis: str) -> Matrix:
    """Turns the z axis to the cylinder's own, and about it so that no faces of two cylinders are coincident."""
    turn = {"X": Matrix.Rotation(np.pi / 2, 4, "Y"), "Y": Matrix.Rotation(np.pi / 2, 4, "X"), "Z": Matrix.Identity(4)}[
        axis
    ]
    return turn @ Matrix.Rotation(0.1 + 0.37 * "XYZ".index(axis), 4, "Z")


def build_cylinder(bm: bmesh.types.BMesh, axis: str) -> None:
    bmesh.ops.create_cone(
        bm,
        cap_ends=True,
        segments=SIDES,
        radius1=RADII[axis],
        radius2=RADII[axis],
        depth=LENGTH,
        matrix=cylinder_frame(axis),
    )


def boolean(axis: str, operation: str, others: tuple[str, ...]) -> bpy.types.Mesh:
    """A cylinder and others, by exact booleans."""
    own = add_mesh(axis, lambda bm: build_cylinder(bm, axis))
    operands = [add_mesh(other, lambda bm, other=other: build_cylinder(bm, other)) for other in others]
    for operand in operands:
        modifier = own.modifiers.new("Boolean", "BOOLEAN")
        modifier.solver, modifier.operation, modifier.object = "EXACT", operation, operand
    mesh = bpy.data.meshes.new_from_object(own.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    for obj in (own, *operands):
        bpy.data.objects.remove(obj)
    return mesh


def surface_distance(axis: str, point) -> float:
    """Signed distance from the planes of the prism with as many sides: 0 on its surface, less inside."""
    x, y, z = cylinder_frame(axis).inverted() @ point
    step = 2 * np.pi / SIDES
    middle = (np.arange(SIDES) + 0.5) * step
    sides = x * np.sin(middle) + y * np.cos(middle) - RADII[axis] * np.cos(step / 2)
    return max(sides.max(), abs(z) - LENGTH / 2)


def lies_on(axis: str, face: bmesh.types.BMFace) -> bool:
    return abs(surface_distance(axis, face.calc_center_median())) < 1e-5


def add_patch(name: str, mesh: bpy.types.Mesh, axis: str, ratio: float) -> None:
    """The faces of a mesh that lie on a cylinder's surface, as an interface of that ratio of indices (inside /
    outside).
    """

    def build(bm: bmesh.types.BMesh) -> None:
        bm.from_mesh(mesh)
        elsewhere = [face for face in bm.faces if not lies_on(axis, face)]
        bmesh.ops.delete(bm, geom=elsewhere, context="FACES")
        assert bm.faces, f"no face of {name} lies on {axis}"

    add_mesh(name, build, cycles_glass(ratio))


def add_split_cylinders(order: tuple[str, str, str]) -> None:
    """Every interface of the cylinders, the first of the order winning over the others: outside, and between each
    two.
    """
    union = boolean(order[0], "UNION", order[1:])
    for axis in order:
        add_patch(f"{axis} in air", union, axis, INDICES[axis])
    for place in (1, 2):
        loser = order[place]
        left = boolean(loser, "DIFFERENCE", order[:place])
        for winner in order[:place]:
            add_patch(f"{loser} in {winner}", left, winner, INDICES[loser] / INDICES[winner])


@pytest.mark.parametrize("order", mostly_again([("X", "Y", "Z"), ("Y", "Z", "X"), ("Z", "X", "Y")]))
def test_overlapping_cylinders_match_exact_booleans(order):
    """The scene of the original paper: three cylinders cross, and priorities alone decide which is whole."""

    def scene() -> None:
        new_scene(48)
        set_striped_world()
        add_camera((3, -5, 3.5), (0, 0, 0), angle=26)

    scene()
    for axis in order:
        material = nd.new_material(axis, ior=INDICES[axis], shadow_mode="BLACK")
        add_mesh(axis, lambda bm, axis=axis: build_cylinder(bm, axis), material, priority=order.index(axis))
    ours = batches(SAMPLES, BATCHES)

    scene()
    add_split_cylinders(order)
    assert_same_picture(ours, reference_batches(SAMPLES, BATCHES))
