"""What a check finds of the current scene."""

import bpy
import numpy as np
from scenes import add_sphere

import nested_dielectric as nd
from nested_dielectric.checking import kinds
from nested_dielectric.checking.check import check
from nested_dielectric.checking.finding import Finding


def findings(kind: kinds.Kind | None = None) -> list[Finding]:
    bpy.context.view_layer.update()
    return [found for found in check(bpy.context.scene) if kind in (None, found.kind)]


def only(kind: kinds.Kind) -> Finding:
    (found,) = findings()
    assert found.kind == kind, found
    return found


def middle_of(obj: bpy.types.Object, face: int) -> np.ndarray:
    return np.array(obj.matrix_world @ obj.data.polygons[face].center)


def ball(name: str = "Ball", location=(0, 0, 0), segments: int = 16) -> bpy.types.Object:
    return add_sphere(name, 1.0, nd.new_material(name, preset="glass"), None, location, segments)
