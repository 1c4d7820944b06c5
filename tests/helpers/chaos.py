"""Flawed media on top of each other, at random."""

import random

import bpy  # noqa: F401  before bmesh and mathutils, which live inside it

import bmesh  # isort: skip
from mathutils import Euler, Matrix
from scenes import add_camera, add_mesh, new_scene, set_world

import nested_dielectric as nd


def build_flawed_solid(bm: bmesh.types.BMesh, chance: random.Random) -> None:
    """A solid or a sheet that may be open, inside out or there twice."""
    kind = chance.choice(("cube", "ball", "sheet", "cone", "monkey", "disc"))
    if kind == "cube":
        bmesh.ops.create_cube(bm, size=1.5)
    elif kind == "ball":
        bmesh.ops.create_icosphere(bm, subdivisions=2, radius=0.8)
    elif kind == "sheet":
        bmesh.ops.create_grid(bm, x_segments=3, y_segments=3, size=1.0)
    elif kind == "cone":
        bmesh.ops.create_cone(bm, cap_ends=chance.random() < 0.7, segments=9, radius1=0.8, radius2=0.3, depth=1.5)
    elif kind == "monkey":
        bmesh.ops.create_monkey(bm)
    else:
        bmesh.ops.create_circle(bm, cap_ends=True, radius=1.0, segments=7)
    if chance.random() < 0.3:
        bmesh.ops.reverse_faces(bm, faces=bm.faces[:])
    if chance.random() < 0.3:
        holes = chance.sample(bm.faces[:], max(1, len(bm.faces) // 5))
        bmesh.ops.delete(bm, geom=holes, context="FACES_ONLY")
    if chance.random() < 0.3:
        bmesh.ops.duplicate(bm, geom=bm.verts[:] + bm.edges[:] + bm.faces[:])


def random_curve(chance: random.Random) -> dict:
    """Any dispersion, with resonances in the middle of the spectrum and indices without bounds."""
    return {
        "disperse": chance.random() < 0.7,
        "dispersion_model": chance.choice(("ABBE", "SELLMEIER", "JF")),
        "abbe": chance.choice((0.0, 0.01, 20.0)),
        "sellmeier_b": [chance.uniform(-2.0, 3.0) for _ in range(3)],
        "sellmeier_c": [chance.choice((0.0, 0.01, 0.25, 0.35, 100.0)) for _ in range(3)],
        "dispersion": chance.choice((-10.0, 0.03, 0.5, 10.0)),
    }


def build_chaos(seed: int, roughness: float, split: bool = False) -> None:
    """Up to seven flawed media on top of each other, at a scale from millimetres to kilometres, the camera among or
    before them.
    """
    chance = random.Random(seed)
    new_scene(24, with_group=True)
    set_world()
    scale = 10 ** chance.uniform(-3, 4)
    for index in range(chance.randint(2, 7)):
        keywords = {
            "ior": chance.choice((0.3, 0.9, 1.0, 1.33, 1.5, chance.uniform(0.5, 3.0))),
            "roughness": roughness,
            "shadow_mode": chance.choice(("BLACK", "TRANSMISSION", "OUTSIDE_FRESNEL", "ALL_FRESNEL")),
            "internal_reflections": chance.random() < 0.8,
        }
        if chance.random() < 0.5:
            keywords["transmittance"] = (chance.random(), chance.random(), 0.0)
            keywords["transmittance_depth"] = scale * 10 ** chance.uniform(-2, 1)
        if split:
            keywords |= random_curve(random.Random(f"{seed} {index}"))
        obj = add_mesh(
            f"Object {index}",
            lambda bm: build_flawed_solid(bm, chance),
            nd.new_material("M", **keywords),
            chance.randint(0, 3),
        )
        place = [scale * chance.choice((0.0, 0.0, chance.uniform(-0.7, 0.7))) for _ in range(3)]
        turn = Euler([chance.choice((0.0, chance.uniform(0.0, 3.0))) for _ in range(3)])
        size = [scale * chance.choice((1.0, 1.0, -1.0, 0.5)) for _ in range(3)]
        obj.matrix_world = Matrix.LocRotScale(place, turn, size)
    view = (0.3, -4.0, 0.5) if chance.random() < 0.6 else (0.1, -0.2, 0.05)
    camera = add_camera([scale * value for value in view], (0, 0, 0), angle=50)
    camera.data.clip_start, camera.data.clip_end = scale * 1e-4, scale * 1e4
