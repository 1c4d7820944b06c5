"""A scene as checks look at it: each mesh evaluated once, and what all of them need to know of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import bpy
import numpy as np

from ..analysis.session import analysis_of
from ..analysis.snapshot import SceneSnapshot, take_snapshot
from ..analysis.solid_cache import EvaluatedMesh, mesh_of
from ..geometry import contacts
from ..geometry.contacts import Contact, PairCache, place_key
from ..geometry.solids import Body, PlacedSolid
from ..scene.materials import medium_material
from ..scene.media import SOLID_TYPES, get_priority, is_cut_surface, is_rendered, media
from ..scene.shapes import evaluated_faces
from .evaluated_shapes import Containment, Shape, evaluated_shape
from .finding import MOST_FACES, Place
from .signatures import medium_signature


@dataclass(frozen=True, eq=False)
class Medium:
    """A closed medium where it stands; an object that is instanced shows several.

    :param place: of its surface in the world; faces: (m,) the polygon of each of its triangles.
    """

    obj: bpy.types.Object
    body: Body
    place: PlacedSolid
    faces: np.ndarray

    def at(self, triangles: np.ndarray) -> Place:
        """Return the place of some triangles of its mesh."""
        corners = self.place.solid.vertices[self.place.solid.triangles[triangles[0]]]
        point = self.place.matrix[:3, :3] @ corners.mean(axis=0) + self.place.matrix[:3, 3]
        return Place(listed_faces(self.faces[triangles]), tuple(point.tolist()))


def listed_faces(faces: np.ndarray) -> tuple[int, ...]:
    """Return polygons, each once, of very many the first."""
    return tuple(np.unique(faces)[:MOST_FACES].tolist())


@dataclass(eq=False)
class Inspection:
    """What checks look at.

    :ivar depsgraph: the evaluated scene.
    :ivar snapshot: of all instances, with the contacts of the bodies among them.
    :ivar pairs: what is known of those bodies, and of pairs of them.
    :ivar objects: media, in winning order.
    :ivar inside: which points lie in which shapes.
    """

    scene: bpy.types.Scene
    depsgraph: bpy.types.Depsgraph
    snapshot: SceneSnapshot
    pairs: PairCache
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

    @property
    def media(self) -> list[Medium]:
        """Return all closed media, instances too, as they stand now; what moves on other frames is among them."""
        return self._media_and_contacts[0]

    @property
    def contacts(self) -> list[Contact]:
        """Return what each of the closed media touches, in their order."""
        return self._media_and_contacts[1]

    @cached_property
    def _media_and_contacts(self) -> tuple[list[Medium], list[Contact]]:
        found, places = self.snapshot.contacts, self.pairs.places
        if any(instance.medium and instance.body is None for instance in self.snapshot.instances):
            rows = list(self._standing())
            pairs = PairCache(dict(places), dict(self.pairs.pairs))
            found = contacts.analyse([body for _, body, _ in rows], pairs)
            places = pairs.places
        else:
            rows = [
                (each.obj, each.body, mesh_of(each.obj, each.obj.evaluated_get(self.depsgraph)).faces)
                for each in self.snapshot.bodies
            ]
        return [
            Medium(obj, body, places.get(place_key(body)) or PlacedSolid(body.solid, body.matrix), faces)
            for obj, body, faces in rows
        ], found

    def _standing(self) -> Iterator[tuple[bpy.types.Object, Body, np.ndarray]]:
        """Yield all closed media where they stand now, and the polygons of their triangles."""
        for instance in self.depsgraph.object_instances:
            obj = instance.object.original
            if obj not in self.among or instance.object.type != obj.type or not is_rendered(obj):
                continue
            matrix = np.array(instance.matrix_world, dtype=np.float64)
            mesh = self._mesh_of_instance(instance)
            if np.isfinite(matrix).all() and mesh.solid.closed:
                yield obj, Body(mesh.solid, matrix, get_priority(obj), medium_signature(obj)), mesh.faces

    def foreign(self, low: np.ndarray, high: np.ndarray) -> Iterator[Shape]:
        """Yield what is no medium and comes near any of some boxes: (n, 3) lowest and highest corners in the world."""
        for instance in self.depsgraph.object_instances if len(low) else ():
            obj = instance.object
            if (
                obj.type not in SOLID_TYPES
                or medium_material(obj.original) is not None
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


def inspect(scene: bpy.types.Scene, just_analysed: bool = False) -> Inspection:
    """Look at a scene as it is evaluated now, and change nothing.

    :param just_analysed: what an analysis in this session knows of it holds, if it is not invalid.
    """
    layer = scene.view_layers[0]
    layer.update()
    known = analysis_of(scene)
    snapshot, pairs = known.snapshot, known.pair_cache
    if snapshot is None or not just_analysed:
        pairs = PairCache()
        snapshot = take_snapshot(scene, layer.depsgraph)
        bodies = [instance.body for instance in snapshot.bodies]
        snapshot = replace(snapshot, contacts=contacts.analyse(bodies, pairs))
    return Inspection(scene, layer.depsgraph, snapshot, pairs, media(scene))
