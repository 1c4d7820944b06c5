"""Priorities that are suggested for the media of a scene, from what they are and how they overlap; and accepting them."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator
from dataclasses import dataclass

import bpy
import numpy as np

from ..analysis import solid_cache
from ..analysis.material_facts import MaterialFacts, all_material_facts
from ..analysis.session import forget_unused
from ..geometry import meshes
from ..geometry.pairs import candidate_pairs, relate_pairs
from ..geometry.solids import PlacedSolid
from ..model.media_kinds import Kind, density_of, kind_of
from ..model.priority_suggestion import suggested
from ..model.winning_rules import Overlap, Placed
from ..nodes.lookups import caching_nodes
from ..scene.materials import dielectric_node, medium_material
from ..scene.media import SOLID_TYPES, all_objects, get_priority, is_cut_surface, is_rendered, material_priority
from ..scene.preset_materials import preset_of
from ..scene.priorities import Owner, Row, hindrance, priority_rows, set_number


@dataclass(frozen=True)
class Suggestion:
    """One number that is suggested.

    :param owner: the material, or the object that has or gets a number of its own.
    :param before: the number that it has; after: the one that is suggested.
    :param reason: the rest of a sentence that goes on after "because".
    """

    owner: Owner
    before: int
    after: int
    reason: str

    def __str__(self) -> str:
        return f"{self.owner.name}: {self.before} -> {self.after}, because {self.reason}"


@caching_nodes()
def suggest_priorities(scene: bpy.types.Scene) -> tuple[Suggestion, ...]:
    """Suggest priorities for the media of a scene as they are evaluated now; change nothing.

    What :func:`~nested_dielectric.model.priority_suggestion.suggested` says of them. Media that are not closed, that renders do
    not show or that are not in the first view layer overlap nothing here. What cannot be changed stays, and others go by it.
    """
    rows = _rows(scene)
    objects = [obj for row in rows for obj in row.objects]
    instances = list(_instances(scene))
    overlaps, held = _overlaps(instances, {obj: index for index, obj in enumerate(objects)})
    volumes = {obj: _volume(place) for obj, place in reversed(instances)}
    forget_unused()
    materials_held = {medium_material(objects[index]) for index in held}
    natures = {
        material: _nature(material, facts, material in materials_held)
        for material, facts in all_material_facts().items()
    }
    bodies = [
        _placed(row, obj, natures[medium_material(obj)], volumes.get(obj, 0.0)) for row in rows for obj in row.objects
    ]
    return tuple(
        Suggestion(
            objects[change.body] if change.owner is None else change.owner, change.before, change.after, change.reason
        )
        for change in suggested(bodies, overlaps)
    )


def accept_priorities(scene: bpy.types.Scene, suggestions: Iterable[Suggestion]) -> tuple[list[str], list[str]]:
    """Give the media of a scene the numbers that were suggested for them.

    :return: what was changed and what could not be, in sentences.
    """
    changes, kept = [], []
    owners = {owner for row in _rows(scene) for owner in (row.owner, *row.objects)}
    for each in suggestions:
        try:
            name, reason = each.owner.name, _obstacle(each, owners)
        except ReferenceError:
            kept.append("A medium has been deleted; ask for suggestions again")
            continue
        if reason:
            kept.append(f"{name!r} {reason}")
        else:
            set_number(each.owner, each.after)
            changes.append(f"{name}: {each.before} -> {each.after}")
    return changes, kept


def _rows(scene: bpy.types.Scene) -> tuple[Row, ...]:
    """Return the places that all media of a scene have in its order, with those that only nodes instance."""
    layer = scene.view_layers[0]
    layer.update()
    shown = {instance.object.original for instance in layer.depsgraph.object_instances}
    return priority_rows(all_objects(scene) | {obj for obj in shown if not is_cut_surface(obj)})


def _obstacle(suggestion: Suggestion, owners: set[Owner]) -> str:
    """Return why a suggestion cannot be accepted, and the remedy; empty if it can."""
    owner = suggestion.owner
    if owner not in owners:
        return "is no medium of this scene any more; ask for suggestions again"
    number = get_priority(owner) if isinstance(owner, bpy.types.Object) else material_priority(owner)
    if number != suggestion.before:
        return f"has another priority by now, {number}; ask for suggestions again"
    reason = hindrance(owner)
    return f"keeps {number}, because it {reason}" if reason else ""


@dataclass(frozen=True)
class _Nature:
    """What a material fills its objects with, as :class:`Placed` has it."""

    medium: Hashable
    kind: Kind | None
    density: float | None


def _nature(material: bpy.types.Material, facts: MaterialFacts, is_held: bool) -> _Nature:
    """Return what a material fills its objects with.

    :param is_held: one of them stands within the box of something that it touches.
    """
    socket = dielectric_node(material).inputs["IOR"]
    index = None if socket.is_linked else socket.default_value
    preset = preset_of(material)
    medium = material.session_uid if facts.values is None else facts.values
    return _Nature(medium, kind_of(preset, index, is_held), density_of(preset, index))


def _placed(row: Row, obj: bpy.types.Object, nature: _Nature, volume: float) -> Placed:
    """Return what matters of a medium for its priority."""
    # Objects may leave a material whose number cannot be changed.
    owner = obj if hindrance(row.owner) else row.owner
    return Placed(
        obj.name_full,
        owner,
        row.priority,
        nature.medium,
        nature.kind,
        nature.density,
        volume,
        bool(hindrance(owner)),
    )


def _instances(scene: bpy.types.Scene) -> Iterator[tuple[bpy.types.Object, PlacedSolid]]:
    """Yield the closed media of a scene, with each of their places, once its first view layer is up to date.

    What an object's nodes instance that is no object is left out: it may be another mesh of another medium each time.
    """
    solid_cache.forget_all()
    for instance in scene.view_layers[0].depsgraph.object_instances:
        evaluated = instance.object
        obj = evaluated.original
        if evaluated.type not in SOLID_TYPES or evaluated.type != obj.type or is_cut_surface(obj):
            continue
        if not is_rendered(obj) or medium_material(obj) is None:
            continue
        if instance.is_instance and instance.parent.original == obj:
            continue
        matrix = np.array(instance.matrix_world, dtype=np.float64)
        if not np.isfinite(matrix).all():
            continue
        place = PlacedSolid(solid_cache.solid_of(obj, evaluated), matrix)
        if place.solid.closed and not place.flat:
            yield obj, place


def _overlaps(
    instances: list[tuple[bpy.types.Object, PlacedSolid]], indices: dict[bpy.types.Object, int]
) -> tuple[list[Overlap], set[int]]:
    """Find which media overlap and how, and which stand within the box of something that they touch.

    :param indices: of all media.
    """
    objects = [indices[obj] for obj, _ in instances]
    places = [place for _, place in instances]
    pairs = [(i, j) for i, j in candidate_pairs(places) if objects[i] != objects[j]]
    overlaps, held = set(), set()
    for (i, j), relations in zip(pairs, relate_pairs([(places[i], places[j]) for i, j in pairs])):
        for one, other, relation in zip((i, j), (j, i), relations):
            if relation.is_inside:
                overlaps.add(Overlap(objects[one], objects[other], True))
            elif relation.crosses and not relations[0].is_inside and not relations[1].is_inside:
                overlaps.add(Overlap(*sorted((objects[one], objects[other]))))
                if _stands_in(places[one].box, places[other].box):
                    held.add(objects[one])
    return sorted(overlaps, key=lambda each: (each.one, each.other, each.is_inside)), held


def _stands_in(box: tuple[np.ndarray, np.ndarray], other: tuple[np.ndarray, np.ndarray]) -> bool:
    """Return whether a box stands in another, beyond whose top it may reach."""
    return bool((box[0] >= other[0]).all() and (box[1][:2] <= other[1][:2]).all())


def _volume(place: PlacedSolid) -> float:
    """Return the volume of a solid in the world, cubic scene units."""
    return abs(meshes.signed_volume(place.solid.vertices, place.solid.triangles) * np.linalg.det(place.matrix[:3, :3]))
