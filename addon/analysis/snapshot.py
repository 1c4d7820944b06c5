"""Media and other objects of a scene, as they are evaluated at one moment."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property

import bpy
import numpy as np

from ..geometry.contacts import Contact
from ..geometry.solids import Body
from ..nodes.lookups import caching_nodes
from ..scene.media import SOLID_TYPES, is_cut_surface, is_rendered, media, own_priority
from . import solid_cache
from .extents import EVERYWHERE, SHAPE_MARGIN, SHAPED, corners_of, with_margin
from .material_facts import MaterialFacts, all_material_facts
from .stability import (
    VELOCITY,
    Unstable,
    has_velocity,
    instancing_instability,
    is_exact,
    require_stable,
    scene_instabilities,
)


@dataclass(frozen=True, eq=False)
class Instance:
    """An instance of an object.

    :param box: (2, 3) lowest and highest corner of where it may be, in the world.
    :param medium: it is a nested dielectric.
    :param body: the medium's exact shape and place; None if a render may show it with another in the same box.
    :param instability: empty, or why it may be anywhere.
    """

    obj: bpy.types.Object
    box: np.ndarray
    medium: bool = False
    body: Body | None = None
    instability: str = ""

    def is_same(self, other: Instance) -> bool:
        """Return whether the same follows from another instance."""
        return self is other or (
            (self.obj, self.instability, self.body is None) == (other.obj, other.instability, other.body is None)
            and np.array_equal(self.box, other.box)
            and (self.body is None or self.body.is_same(other.body))
        )


@dataclass(frozen=True, eq=False)
class SceneSnapshot:
    """Every instance in a scene, and how the bodies among them touch.

    :param instances: in the order of the depsgraph.
    :param facts: of the materials.
    :param instabilities: names and reasons.
    :param places: of instances that may be looked at one by one, by the session's number of their objects; empty where
        objects are instanced.
    :param contacts: of the bodies; empty before they are found.
    """

    scene: bpy.types.Scene
    instances: list[Instance]
    facts: dict[bpy.types.Material, MaterialFacts]
    instabilities: tuple[tuple[str, str], ...]
    places: dict[int, int]
    contacts: list[Contact]

    def has_same_media(self, other: SceneSnapshot) -> bool:
        """Return whether the media of another snapshot have the same places, shapes and values."""
        first, second = ([instance for instance in snapshot.instances if instance.medium] for snapshot in (self, other))
        return (self.instabilities, len(first)) == (other.instabilities, len(second)) and all(
            map(Instance.is_same, first, second)
        )

    @cached_property
    def bodies(self) -> list[Instance]:
        """Return the media whose exact shape is known."""
        return [instance for instance in self.instances if instance.body is not None]

    @cached_property
    def ambiguous_priorities(self) -> set[int]:
        """Return the priorities of which bodies overlap that are filled with different media: either may be found."""
        return {
            instance.body.priority
            for instance, contact in zip(self.bodies, self.contacts)
            for other in (self.bodies[partner].body for partner in contact.partners)
            if other.priority == instance.body.priority and other.medium != instance.body.medium
        }

    @cached_property
    def uncertain_media(self) -> list[Instance]:
        """Return the media whose exact shape is not known."""
        return [instance for instance in self.instances if instance.medium and instance.body is None]


@caching_nodes()
def take_snapshot(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> SceneSnapshot:
    """Look at all instances of a scene, as a depsgraph has evaluated them."""
    facts = all_material_facts()
    instances: list[Instance] = []
    plain = True
    reason = cache(instancing_instability)
    for instance in depsgraph.object_instances:
        if instance.object.type != instance.object.original.type:
            continue  # the mesh of a text, a curve or a metaball, which stands before it
        if is_cut_surface(instance.object):
            continue  # what it shows is looked at where it is cut from
        if instance.object.type in SHAPED:
            found = _instance(scene, facts, instance.object, np.array(instance.matrix_world))
            instability = instance.is_instance and (reason() or reason(instance.parent.original))
            instances.append(
                replace(found, box=EVERYWHERE, body=None, instability=instability) if instability else found
            )
        plain = plain and not instance.is_instance
    seen = {instance.obj for instance in instances}
    instances += [
        Instance(obj, EVERYWHERE)
        for obj in {obj for each in bpy.data.scenes for obj in each.objects} - seen
        if obj.type in SHAPED
        and is_rendered(obj)
        and not is_cut_surface(obj)
        and not any(slot.material in facts for slot in obj.material_slots)
    ]
    places = {instance.obj.session_uid: index for index, instance in enumerate(instances)} if plain else {}
    instabilities = dict(scene_instabilities(scene, facts))
    seen = {instance.obj for instance in instances}
    instabilities.update(
        (obj.name, "is hidden in the viewport alone") for obj in media(scene) if obj not in seen and is_rendered(obj)
    )
    return SceneSnapshot(scene, instances, facts, tuple(instabilities.items()), places, [])


def _instance(
    scene: bpy.types.Scene,
    facts: dict[bpy.types.Material, MaterialFacts],
    evaluated: bpy.types.Object,
    matrix: np.ndarray,
) -> Instance:
    """Look at one evaluated object.

    :param matrix: (4, 4) from its space to the world's.
    """
    obj = evaluated.original
    corners = corners_of(evaluated) @ matrix[:3, :3].T + matrix[:3, 3]
    box = np.array([corners.min(axis=0), corners.max(axis=0)])
    dielectric = {
        slot.material.original for slot in evaluated.material_slots if slot.material and slot.material.original in facts
    }
    try:
        require_stable(obj)
        if has_velocity(evaluated):
            raise Unstable(f"has the attribute {VELOCITY!r}, by which motion blur moves its points")
        if not dielectric:
            displaced = any(
                slot.material and slot.material.displacement_method != "BUMP" for slot in obj.material_slots
            )
            return Instance(obj, box if is_exact(scene, obj) and not displaced else EVERYWHERE)
        exact = is_exact(scene, obj) and dielectric == {slot.material for slot in obj.material_slots} & facts.keys()
        if len(dielectric) == 1:
            (material,) = dielectric
            exact = exact and facts[material].can_be_told
            body = _exact_body(obj, evaluated, matrix, facts[material], exact)
            if body is not None:
                return Instance(obj, box, True, body)
        return Instance(obj, with_margin(box, SHAPE_MARGIN), True)
    except Unstable as instability:
        return Instance(obj, EVERYWHERE, bool(dielectric), instability=str(instability))


def _exact_body(
    obj: bpy.types.Object, evaluated: bpy.types.Object, matrix: np.ndarray, facts: MaterialFacts, exact: bool
) -> Body | None:
    """Return the exact medium, or None where a render may show another shape; raise `Unstable` if it may be without bounds."""
    if facts.displaces:
        raise Unstable("is displaced by its material")
    own = own_priority(obj)
    priority = facts.priority if own is None else own
    if priority is None:
        raise Unstable("has a priority that may change")
    if evaluated.type not in SOLID_TYPES or obj.type == "META":
        return None  # the shape of metaballs is that of a whole family
    solid = solid_cache.solid_of(obj, evaluated)
    if not solid.closed:
        raise Unstable("is not closed")
    medium = (obj.name_full,) if facts.values is None else facts.values
    return Body(solid, matrix, priority, medium) if exact else None


_CONCERNED = (
    bpy.types.Object,
    bpy.types.Mesh,
    bpy.types.Material,
    bpy.types.ShaderNodeTree,
    bpy.types.GeometryNodeTree,
    bpy.types.Collection,
)
"""Types of data whose updates may concern media."""

_SHADING = (bpy.types.Material, bpy.types.ShaderNodeTree)
"""Those whose updates may change the facts of materials."""


def changed_data(depsgraph: bpy.types.Depsgraph) -> set[bpy.types.ID]:
    """Return what has changed, as far as media may be concerned; solids of another shape are forgotten."""
    changed = {
        update.id.original: update
        for update in depsgraph.updates
        if isinstance(update.id, _CONCERNED)
        and not (isinstance(update.id, bpy.types.Object) and is_cut_surface(update.id))
    }
    for data, update in changed.items():
        if update.is_updated_geometry or isinstance(data, bpy.types.Mesh):
            solid_cache.forget(data)
    return set(changed)


def updated_snapshot(
    snapshot: SceneSnapshot | None, scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph, changed: set[bpy.types.ID]
) -> SceneSnapshot:
    """Return the snapshot of a scene after an update, without contacts, from the one before."""
    if snapshot is None or not all(_is_known(snapshot, data) for data in changed):
        return take_snapshot(scene, depsgraph)
    if any(isinstance(data, _SHADING) for data in changed) and snapshot.facts != all_material_facts():
        return take_snapshot(scene, depsgraph)
    instances = list(snapshot.instances)
    for obj in (data for data in changed if isinstance(data, bpy.types.Object)):
        evaluated = obj.evaluated_get(depsgraph)
        instances[snapshot.places[obj.session_uid]] = _instance(
            scene, snapshot.facts, evaluated, np.array(evaluated.matrix_world)
        )
    return SceneSnapshot(scene, instances, snapshot.facts, snapshot.instabilities, snapshot.places, [])


def _is_known(snapshot: SceneSnapshot, data: bpy.types.ID) -> bool:
    """Return whether an update of some data concerns the instances of updated objects alone, if the facts stay as they are."""
    if isinstance(data, bpy.types.Object):
        return data.session_uid in snapshot.places
    if isinstance(data, bpy.types.Material):
        return data in snapshot.facts
    return isinstance(data, (bpy.types.Mesh, bpy.types.ShaderNodeTree))
