"""What is wrong with a scene's media, object by object, and what to do about it."""

from __future__ import annotations

import bpy
import numpy as np

from ..nodes.lookups import caching_nodes
from ..scene.media import dispersing_materials, media
from .absorption_checks import tint_problems, volume_problems
from .evaluated_shapes import EvaluatedMesh, evaluated_shape
from .finding import Problem
from .light_checks import dispersion_problems, light_problems
from .material_checks import mask_problems, material_problems, value_problems
from .mesh_checks import mesh_problems, mixture_problems
from .object_checks import kind_problems, object_problems
from .overlap_checks import foreign_contact_problems, overlap_problems


@caching_nodes()
def find_problems(scene: bpy.types.Scene) -> list[Problem]:
    """Look at every medium of a scene as it is evaluated now; change nothing."""
    depsgraph = _depsgraph(scene)
    objects = media(scene)
    evaluated = [obj.evaluated_get(depsgraph) for obj in objects]
    known: dict[int, EvaluatedMesh] = {}
    shapes = [
        shape for obj in evaluated if (shape := evaluated_shape(obj, np.array(obj.matrix_world), known)) is not None
    ]
    problems = material_problems(scene)
    problems += kind_problems(depsgraph)
    problems += [problem for obj in objects for problem in object_problems(obj)]
    problems += value_problems(objects)
    for shape in shapes:
        problems += mesh_problems(shape, shapes) + mixture_problems(shape)
    problems += overlap_problems(shapes)
    problems += mask_problems(shapes)
    problems += foreign_contact_problems(shapes, objects, depsgraph)
    if dispersing_materials(scene):
        problems += dispersion_problems(scene)
    if objects:
        problems += light_problems(scene)
    problems += tint_problems(scene, depsgraph, shapes)
    problems += volume_problems(shapes)
    return problems


def _depsgraph(scene: bpy.types.Scene) -> bpy.types.Depsgraph:
    """Return the evaluated state of a scene, which need not be the one in the window."""
    layer = scene.view_layers[0]
    layer.update()
    return layer.depsgraph
