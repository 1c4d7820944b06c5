"""What of a scene is cut where media cross, in which layers, and what cannot be and why (:mod:`nested_dielectric.cutting`)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache

import bpy
import numpy as np
from mathutils import Matrix

from ..analysis import analysis
from ..geometry.contacts import AIR, MEDIUM, NEVER
from ..model.parameters import PRIORITY_PROPERTY
from ..nodes.animation import curves, is_animated
from ..nodes.cutting_nodes import HIDDEN, Layer, Plan
from ..nodes.lookups import unchanged_nodes
from ..nodes.node_group import has_analysis
from ..nodes.trees import (
    is_plugged,
    read_attributes,
    reads_generated,
    reads_whole_mesh,
    shows_other_volume,
    shows_others,
    shows_others_blindly,
)
from ..scene.foreign import lamp_box
from ..scene.lights import lamps
from ..scene.materials import dielectric_node, dielectrics, medium_material
from ..scene.media import get_priority, is_cut_surface, is_rendered, media

MOST_LAYERS = 32
"""That may cross in any combination: each pair is looked at in every frame."""


@dataclass(frozen=True)
class Cut:
    """Which media of a scene are rendered cut, by name, and which are not and why."""

    media: tuple[str, ...] = ()
    asking: tuple[tuple[str, str], ...] = ()

    def __str__(self) -> str:
        lines = [f"cut where they cross: {analysis.listed(self.media)}"] if self.media else []
        return "\n".join(lines + [f"{name!r} is not cut: it {reason}" for name, reason in self.asking])


@unchanged_nodes()
def make_plan(scene: bpy.types.Scene, scripted: bool = False, native: bool = False) -> tuple[Plan, Cut]:
    """Tell what to cut of a scene.

    :param scripted: a script may change any object on any frame.
    :param native: no medium may ask: those of which the analysis knows nothing are cut, too, so that their faces tell what
        they are in, alone or not.
    """
    hidden = set(scene.objects) - _in_shown_collections(scene.collection)
    objects = [obj for obj in media(scene) if is_rendered(obj) and obj not in hidden]
    hindered = _hindrances(scene, objects)
    moving = set(objects) if scripted else {obj for obj in objects if analysis.may_change(obj)}
    known = None if moving else _surroundings(scene, objects)
    touching = touching_media(objects, moving, known)
    whole = _needed_whole(scene, objects, touching)
    melting = {obj for obj in objects if any(_layer_of(other) == _layer_of(obj) for other in touching[obj])}
    for obj in (whole & melting) - hindered.keys():
        hindered[obj] = (
            "overlaps another of its medium, and its surface is needed whole: it has colour, labels or other shaders"
        )
    if native:  # volumes may have to take from shadow rays what media absorb
        whole |= {obj for obj in objects if obj not in melting and may_absorb(medium_material(obj))}
    for obj in known or ():
        if known[obj].coincides:
            hindered.setdefault(obj, "has faces in the same place as another; press Prepare Scene, or let them overlap")
    asking: list[tuple[str, str]] = []
    chosen: list[bpy.types.Object] = []
    for group in components(objects, touching):
        bad = [obj for obj in group if obj in hindered]
        asking += [(obj.name, hindered[obj]) for obj in bad]
        if bad:
            asking += [
                (obj.name, f"may meet {bad[0].name!r}, which is not cut") for obj in group if obj not in hindered
            ]
        elif _has_to_be_cut(group, known) if native else len(group) > 1 and _may_cross(group, known):
            chosen += group
    layers, pairs = _layers(chosen, whole, touching, known)
    if moving and len(layers) > MOST_LAYERS:
        reason = f"moves among media of more than {MOST_LAYERS} priorities and materials"
        return Plan(), Cut((), (*asking, *((obj.name, reason) for obj in chosen)))
    plan = Plan(layers, pairs, bool(moving), _attributes(scene, chosen))
    return plan, Cut(tuple(obj.name for obj in chosen), tuple(asking))


def _may_cross(group: Sequence[bpy.types.Object], known: dict[bpy.types.Object, _Surroundings] | None) -> bool:
    """Whether surfaces of media that hang together may have more than one outside each."""
    return known is None or any(known[obj].may_cross for obj in group)


def _has_to_be_cut(group: Sequence[bpy.types.Object], known: dict[bpy.types.Object, _Surroundings] | None) -> bool:
    """Whether only their faces can tell some of these media what they are in."""
    return _may_cross(group, known) or not all(known[obj].is_told for obj in group)


def _layer_of(obj: bpy.types.Object) -> tuple[int, bpy.types.Material]:
    return get_priority(obj), medium_material(obj)


def _in_shown_collections(collection: bpy.types.Collection) -> set[bpy.types.Object]:
    """Objects that no collection hides from renders."""
    if collection.hide_render:
        return set()
    return set(collection.objects).union(*map(_in_shown_collections, collection.children))


def _hindrances(scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]) -> dict[bpy.types.Object, str]:
    """Why media cannot be cut."""
    layer = scene.view_layers[0]
    layer.update()
    depsgraph = layer.depsgraph
    instanced = {instance.object.original for instance in depsgraph.object_instances if instance.is_instance}
    shown_otherwise = _shown_otherwise(scene, objects)
    own = set(scene.objects)
    elsewhere = {obj for other in bpy.data.scenes if other != scene for obj in other.objects}
    of_materials = {
        material: _material_hindrance(material)
        for material in {slot.material for obj in objects for slot in obj.material_slots}
    }
    blurs = scene.render.use_motion_blur and scene.render.motion_blur_shutter > 0.0
    found = {}
    for obj in objects:
        if obj not in own or obj in instanced:
            reason = "is instanced"
        elif obj in elsewhere:
            reason = "is in another scene, too"
        elif blurs and analysis.may_change(obj):
            reason = "may move while the shutter is open"
        else:
            reason = (
                _hindrance(obj)
                or next(filter(None, (of_materials[slot.material] for slot in obj.material_slots)), "")
                or shown_otherwise.get(obj, "")
                or analysis.is_one_closed_surface(obj.evaluated_get(depsgraph))
            )
        if reason:
            found[obj] = reason
    return found


def _hindrance(obj: bpy.types.Object) -> str:
    """What an object or its materials have that cannot be cut."""
    found = {material for _, material in dielectrics(obj)}
    if obj.type != "MESH":
        return "is no mesh: Object > Convert > Mesh"
    if obj.library is not None:
        return "is linked from another file"
    if obj.mode == "EDIT":
        return "is being edited"
    if _is_keyed(obj, "hide_render"):
        return "is shown and hidden by keyframes"
    if obj.instance_type != "NONE" or obj.particle_systems:
        return "has instances or particles"
    if len(found) > 1:
        return "has several media"
    if _is_keyed(obj, f'["{PRIORITY_PROPERTY}"]'):
        return "has a priority that may change"
    if any(modifier.type == "SUBSURF" and modifier.use_adaptive_subdivision for modifier in obj.modifiers):
        return "is subdivided adaptively"
    if len(set(obj.data.materials)) < len(obj.data.materials):
        return "has one material in several slots"
    deformed = obj.data.shape_keys is not None or not all(map(analysis.keeps_mesh, obj.modifiers))
    if deformed and any(
        slot.material and slot.material.node_tree and reads_generated(slot.material) for slot in obj.material_slots
    ):
        return "has Generated coordinates, which are lost on a mesh that modifiers or shape keys change"
    return ""


def _is_keyed(obj: bpy.types.Object, path: str) -> bool:
    return any(curve.data_path == path for curve in curves(obj.animation_data))


def _material_hindrance(material: bpy.types.Material | None) -> str:
    """What keeps objects that show a material from being cut."""
    if material is None or material.node_tree is None:
        return ""
    output = material.node_tree.get_output_node("CYCLES")
    if output is not None and output.inputs["Displacement"].is_linked and material.displacement_method != "BUMP":
        return "is displaced by its material"
    node = dielectric_node(material)
    if node is None:
        return ""
    if not has_analysis(node) or not is_plugged(node):
        return f"has its medium in a group of {material.name!r}"
    priority = node.inputs["Priority"]
    if priority.is_linked or is_animated(material.node_tree, priority):
        return "has a priority that may change"
    if shows_other_volume(material):
        return "has a volume of its own"
    whole = reads_whole_mesh(material)
    return f"has {whole} in {material.name!r}, which is another on part of a mesh" if whole else ""


def _shown_otherwise(scene: bpy.types.Scene, objects: Iterable[bpy.types.Object]) -> dict[bpy.types.Object, str]:
    """How collections show objects in view layers otherwise than a collection of ours would."""
    found = {}
    for layer in scene.view_layers:
        found |= {obj: f"is not in the view layer {layer.name!r}" for obj in set(objects) - set(layer.objects)}
        pending = [layer.layer_collection]
        while pending:
            each = pending.pop()
            pending += each.children
            if each.holdout or each.indirect_only:
                reason = f"is in the collection {each.name!r}, a holdout or indirect in the view layer {layer.name!r}"
                found |= dict.fromkeys(each.collection.all_objects, reason)
    return found


@dataclass(frozen=True)
class _Surroundings:
    """What is known of a medium that stays where it is, among others that do.

    :param code: as of a :class:`~nested_dielectric.contacts.Contact`; around: the medium outside of code MEDIUM.
    :param partners: media whose surfaces cross its own or that hold part of it.
    :param is_simple: its surface is in one piece; coincides: some of it is in the same place as another's.
    :param is_told: it knows by the analysis alone what lies outside it.
    """

    code: int
    around: bpy.types.Object | None
    partners: tuple[bpy.types.Object, ...]
    is_simple: bool
    coincides: bool
    is_told: bool

    @property
    def may_cross(self) -> bool:
        """Whether not all of its surface has the same outside."""
        return self.code not in (AIR, MEDIUM, NEVER)


def _surroundings(
    scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]
) -> dict[bpy.types.Object, _Surroundings] | None:
    """What the analysis of a scene found of each medium; None if it does not know all of them."""
    found = analysis.last_found(scene)
    rows, contacts = analysis.looked_at(scene)
    if found is None or found.doubts or len(rows) != len(objects) or {obj for obj, _ in rows} != set(objects):
        return None
    told = set(found.known)
    return {
        obj: _Surroundings(
            contact.code,
            None if contact.around is None else rows[contact.around][0],
            tuple(rows[partner][0] for partner in contact.partners),
            len(body.solid.by_island[1]) == 2,
            bool(contact.coincident),
            obj.name in told,
        )
        for (obj, body), contact in zip(rows, contacts)
    }


def touching_media(
    objects: Sequence[bpy.types.Object], moving: set[bpy.types.Object], known: dict | None = None
) -> dict[bpy.types.Object, list[bpy.types.Object]]:
    """Return which media may meet: those that do, or where nothing is known those whose boxes do; what moves may meet all."""
    if known is not None:
        pairs = {
            frozenset((obj, other)) for obj in objects for other in (*known[obj].partners, known[obj].around) if other
        }
    else:
        boxes = np.array([analysis.EVERYWHERE if obj in moving else _box(obj) for obj in objects]).reshape(-1, 2, 3)
        pairs = set()
        for obj, box in zip(objects, boxes):
            pairs |= {frozenset((obj, objects[other])) for other in np.flatnonzero(analysis.meets(boxes, [box]))}
    touching: dict[bpy.types.Object, list[bpy.types.Object]] = {obj: [] for obj in objects}
    for pair in pairs:
        if len(pair) == 2:
            first, second = pair
            touching[first].append(second)
            touching[second].append(first)
    return touching


def _box(obj: bpy.types.Object, matrix: Matrix | None = None) -> np.ndarray:
    """(2, 3) lowest and highest corner of an object in the world, or where a matrix places it."""
    corners = np.array([tuple(corner) for corner in obj.bound_box])
    matrix = np.array(obj.matrix_world if matrix is None else matrix)
    corners = corners @ matrix[:3, :3].T + matrix[:3, 3]
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def components(objects: Iterable[bpy.types.Object], touching: dict) -> Iterable[list[bpy.types.Object]]:
    """Yield sets of media that hang together."""
    left = dict.fromkeys(objects)
    while left:
        pending = [next(iter(left))]
        group = dict.fromkeys(pending)
        while pending:
            for other in touching[pending.pop()]:
                if other not in group:
                    group[other] = None
                    pending.append(other)
        yield [obj for obj in left if obj in group]
        for obj in group:
            left.pop(obj, None)


def _layers(
    objects: Sequence[bpy.types.Object], whole: set[bpy.types.Object], touching: dict, known: dict | None
) -> tuple[tuple[Layer, ...], frozenset[tuple[int, int]]]:
    """The layers of media that are cut, and which of them may cross."""
    grouped: dict[tuple, list[bpy.types.Object]] = {}
    for obj in sorted(objects, key=lambda obj: (get_priority(obj), medium_material(obj).name_full, obj.name_full)):
        grouped.setdefault(_layer_of(obj), []).append(obj)
    place = {obj: index for index, members in enumerate(grouped.values()) for obj in members}
    crossing = set(objects)
    if known is not None:
        odd = {obj for obj in objects if known[obj].may_cross}
        crossing = odd | {
            other for obj in odd for other in known[obj].partners if not _lies_within(other, known, grouped)
        }
    pairs = {
        tuple(sorted((place[obj], place[other])))
        for obj in crossing
        for other in touching[obj]
        if other in crossing and place[obj] != place[other]
    }
    layers = []
    for (priority, material), members in grouped.items():
        constant = tuple((obj, _around(obj, known, place)) for obj in members if obj not in crossing)
        layers.append(
            Layer(
                priority,
                material,
                tuple(obj for obj in members if obj in crossing),
                constant,
                overlapping=not set(members).isdisjoint(other for obj in members for other in touching[obj]),
                tells_more=_tells_more(material),
                keeps_hidden=not whole.isdisjoint(members),
            )
        )
    return tuple(layers), frozenset(pairs)


def _lies_within(obj: bpy.types.Object, known: dict[bpy.types.Object, _Surroundings], layers: dict) -> bool:
    """Whether another medium, in one piece without a hollow, holds all of a medium: what that one leaves of others has no
    part in it.
    """
    around = known[obj].around
    if known[obj].code != MEDIUM:
        return False
    return all(known[each].is_simple for each in layers[_layer_of(around)])


def _around(obj: bpy.types.Object, known: dict, place: dict[bpy.types.Object, int]) -> int | None:
    """The layer that lies outside a medium everywhere, None in air."""
    if known[obj].code == MEDIUM:
        return place[known[obj].around]
    return HIDDEN if known[obj].code == NEVER else None


def _tells_more(material: bpy.types.Material) -> bool:
    """Whether faces in a medium have to carry more than its index."""
    node = dielectric_node(material)
    model = node.inputs["Dispersion Model"]
    return (
        may_absorb(material)
        or is_in_use(node, "Disperse")
        or model.default_value == 2
        or model.is_linked
        or is_animated(material.node_tree, model)
    )


def is_in_use(node: bpy.types.ShaderNodeGroup, name: str) -> bool:
    """Tell whether a switch of a medium is on, or may be on some frame or hit."""
    socket = node.inputs[name]
    return bool(socket.default_value) or socket.is_linked or is_animated(node.id_data, socket)


def may_absorb(material: bpy.types.Material) -> bool:
    """Tell whether a medium has colour, now or on some frame."""
    socket = dielectric_node(material).inputs["Transmittance"]
    return min(socket.default_value[:3]) < 1.0 or socket.is_linked or is_animated(material.node_tree, socket)


def _needed_whole(scene: bpy.types.Scene, objects: Sequence[bpy.types.Object], touching: dict) -> set[bpy.types.Object]:
    """Media whose surfaces are needed inside winners, too: they show what is no medium, or their volumes are entered and left
    by them where light may start or end inside.
    """
    labelled = {obj for obj in objects if any(slot.material != medium_material(obj) for slot in obj.material_slots)}
    mixed = {material: shows_others(material) for material in set(map(medium_material, objects))}
    dirty = {obj for obj in objects if mixed[medium_material(obj)]} | labelled
    near = _others_near(scene, objects) | dirty.union(*(touching[obj] for obj in dirty))
    blind = {obj for obj in dirty if shows_others_blindly(medium_material(obj))}
    return labelled | blind | {obj for obj in near if may_absorb(medium_material(obj))}


def _others_near(scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]) -> set[bpy.types.Object]:
    """Media in whose boxes things that are no media, lamps or the camera may be."""
    if not objects:
        return set()
    own = set(objects)
    boxes = np.array([analysis.EVERYWHERE if analysis.may_change(obj) else _box(obj) for obj in objects])
    others = [analysis.EVERYWHERE if analysis.may_change(lamp) else lamp_box(lamp) for lamp in lamps(scene)]
    shown = set()
    for instance in scene.view_layers[0].depsgraph.object_instances:
        obj = instance.object.original
        shown.add(obj)
        if obj.type in analysis.SHAPED and obj not in own and not is_cut_surface(obj):
            moves = analysis.may_change(instance.parent.original if instance.is_instance else obj)
            others.append(analysis.EVERYWHERE if moves else _box(instance.object, instance.matrix_world))
    for obj in scene.objects:
        if obj.type == "CAMERA":
            place = np.array(obj.matrix_world)[:3, 3]
            others.append(analysis.EVERYWHERE if analysis.may_change(obj) else np.array([place, place]))
        elif obj.type in analysis.SHAPED and obj not in shown | own and not obj.hide_render and not is_cut_surface(obj):
            others.append(analysis.EVERYWHERE)
    return {obj for obj, near in zip(objects, analysis.meets(boxes, others)) if near}


def _attributes(scene: bpy.types.Scene, objects: Iterable[bpy.types.Object]) -> dict[bpy.types.Object, tuple[str, ...]]:
    """Attributes of media that their materials read and that are not of corners."""
    depsgraph = scene.view_layers[0].depsgraph
    names = cache(read_attributes)
    found = {}
    for obj in objects:
        mesh = obj.evaluated_get(depsgraph).data
        wanted = set().union(
            *(names(slot.material) for slot in obj.material_slots if slot.material and slot.material.node_tree)
        )
        if "" in wanted:
            index = mesh.color_attributes.render_color_index
            wanted |= {each.name for each in mesh.color_attributes[max(index, 0) : index + 1]}
        domains = {each.name: each.domain for each in mesh.attributes} | {
            group.name: "POINT" for group in obj.vertex_groups
        }
        chosen = tuple(
            sorted(name for name in wanted if domains.get(name, "CORNER") != "CORNER" and name != "position")
        )
        if chosen:
            found[obj] = chosen
    return found
