"""A scene as checks look at it: each mesh evaluated once, and what all of them need to know of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import bpy
import numpy as np

from ..analysis.snapshot import SceneSnapshot, take_snapshot
from ..analysis.solid_cache import EvaluatedMesh, mesh_of
from ..geometry import contacts
from ..geometry.contacts import PairCache
from ..scene.media import SOLID_TYPES, is_cut_surface, media
from ..scene.shapes import evaluated_faces
from .evaluated_shapes import Containment, Shape, evaluated_shape


@dataclass(eq=False)
class Inspection:
    """What checks look at.

    :ivar depsgraph: the evaluated scene.
    :ivar snapshot: of all instances, with the contacts of the bodies among them.
    :ivar objects: media, in winning order.
    :ivar inside: which points lie in which shapes.
    """

    scene: bpy.types.Scene
    depsgraph: bpy.types.Depsgraph
    snapshot: SceneSnapshot
    objects: list[bpy.types.Object]
    inside: Containment = field(default_factory=Containment)
    _instanced: dict[int, EvaluatedMesh] = field(default_factory=dict)

    @cached_property
    def among(self) -> set[bpy.types.Object]:
        """Return the media as a set."""
        return set(self.objects)

    @cached_property
    def shapes(self) -> list[Shape]:
        """Return the media that have a mesh where it stands, in the order of the objects."""
        evaluated = [obj.evaluated_get(self.depsgraph) for obj in self.objects]
        return [
            evaluated_shape(each, np.array(each.matrix_world), mesh_of(obj, each))
            for obj, each in zip(self.objects, evaluated)
        ]

    @cached_property
    def solids(self) -> list[Shape]:
        """Return those with faces that have a place."""
        return [shape for shape in self.shapes if shape.is_solid]

    def foreign(self, low: np.ndarray, high: np.ndarray) -> Iterator[Shape]:
        """Yield what is no medium and comes near any of some boxes: (n, 3) lowest and highest corners in the world."""
        for instance in self.depsgraph.object_instances if len(low) else ():
            obj = instance.object
            if (
                obj.type not in SOLID_TYPES
                or obj.original in self.among
                or obj.original.hide_render
                or is_cut_surface(obj)
            ):
                continue
            matrix = np.array(instance.matrix_world)
            box = np.array([tuple(corner) for corner in obj.bound_box]) @ matrix[:3, :3].T + matrix[:3, 3]
            if ((low <= box.max(axis=0)) & (high >= box.min(axis=0))).all(axis=1).any():
                shape = evaluated_shape(obj, matrix, self._mesh_of_instance(instance))
                if shape.is_solid:
                    yield shape

    def _mesh_of_instance(self, instance: bpy.types.DepsgraphObjectInstance) -> EvaluatedMesh:
        """Return the mesh of an instance, which need not be that of the object that makes it."""
        obj = instance.object
        if not instance.is_instance:
            return mesh_of(obj.original, obj)
        key = obj.data.as_pointer()
        if key not in self._instanced:
            self._instanced[key] = EvaluatedMesh(*evaluated_faces(obj))
        return self._instanced[key]


def inspect(scene: bpy.types.Scene, snapshot: SceneSnapshot | None = None) -> Inspection:
    """Look at a scene as it is evaluated now, and change nothing.

    :param snapshot: what an analysis has just found of it; None looks anew.
    """
    layer = scene.view_layers[0]
    layer.update()
    if snapshot is None:
        snapshot = take_snapshot(scene, layer.depsgraph)
        bodies = [instance.body for instance in snapshot.bodies]
        snapshot = replace(snapshot, contacts=contacts.analyse(bodies, PairCache()))
    return Inspection(scene, layer.depsgraph, snapshot, media(scene))
