"""Random scenes of media split into interfaces by hand, of Cycles' own Glass: the independent reference."""

from __future__ import annotations

import sys
from pathlib import Path

import bpy  # before mathutils, which lives inside it
import numpy as np
from random_bodies import OUTSIDE, build, stage
from random_media import RandomScene
from scenes import add, cycles_glass

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))

from bench_arrays import Body
from bench_shapes import mesh_arrays, mesh_of
from hand_split import Piece, split, wrong_points

CHECKED = 12
"""Points of each piece at which brute force says which media it must part."""

STEP = 1e-5
"""How far from them it asks: so few points lie nearer to an edge."""


def arrays_of(description: RandomScene) -> list[Body]:
    """Build a scene and return its bodies as arrays in the world, counterclockwise from outside."""
    build(description, glass=True)
    bodies = []
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for index, body in enumerate(description.bodies):
        obj = bpy.data.objects[f"Body {index}"].evaluated_get(depsgraph)
        vertices, triangles = mesh_arrays(obj.data, obj.matrix_world)
        if np.linalg.det(np.array(obj.matrix_world)[:3, :3]) < 0.0:
            triangles = triangles[:, ::-1]
        bodies.append(Body(f"Body{index}", vertices, triangles, body.medium, description.media[body.medium].ior))
    return bodies


def build_split(description: RandomScene) -> list[str]:
    """Build the scene of hand-split pieces; return names of pieces, one for every point where brute force finds other media."""
    bodies = arrays_of(description)
    pieces = split(bodies).pieces
    wrong = wrong_points(bodies, pieces, CHECKED, STEP)
    stage(view=OUTSIDE)
    for piece in pieces:
        add_piece(piece, description)
    return wrong


def add_piece(piece: Piece, description: RandomScene) -> None:
    """Add a piece of Glass, as rough as the medium whose surface it is."""
    body = description.bodies[int(piece.name.split(" ")[0].removeprefix("Body"))]
    mesh = mesh_of(piece.name, piece.vertices, piece.triangles)
    mesh.materials.append(cycles_glass(piece.ior_ratio, description.media[body.medium].roughness))
    add(piece.name, mesh)
