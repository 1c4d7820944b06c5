"""Cameras that aim at flat surfaces, and media whose tint has a closed form."""

import math

import bpy  # before bmesh, which lives inside it
import numpy as np
from scenes import add_camera

import nested_dielectric as nd

TINT = (0.8, 0.5, 0.2)
DEPTH = 0.5

# Off the diagonals along which faces are split into triangles: where a ray meets such an edge to the last bit, Cycles'
# own Glass too takes the neighbouring triangle for another surface.
AIM = (0.37, 0.11, 0.0)


def aim_camera(degrees: float = 0.0, distance: float = 3.0, width: float = 0.01) -> None:
    """Look at AIM at an angle to the z axis, in the xz plane."""
    angle = math.radians(degrees)
    x, y, z = AIM
    add_camera((x + distance * math.sin(angle), y, z + distance * math.cos(angle)), AIM, width=width)


def beer_lambert(distance: float) -> np.ndarray:
    return np.power(TINT, distance / DEPTH)


def tinted(name: str, ior: float, **keywords) -> bpy.types.Material:
    """A medium that absorbs as :func:`beer_lambert` says."""
    return nd.new_material(name, ior=ior, transmittance=TINT, transmittance_depth=DEPTH, **keywords)
