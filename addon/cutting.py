"""Rendering media as surfaces that are cut where they cross, while the artist's own objects stay as they are.

Beside each medium that may cross others stands an object that shows its surface as far as it exists
(:mod:`nested_dielectric.cutting_nodes`). It reads the artist's object, which is hidden from renders only, and is evaluated
with the scene: what moves, deforms or is exchanged is cut as it is then. All of these objects live in one collection.

Media that cannot be cut, and all that they may meet, are rendered as ever: they ask the scene.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256

import bpy
import numpy as np
from mathutils import Matrix

from . import analysis
from .animation import curves, is_animated
from .contacts import AIR, MEDIUM, NEVER
from .cutting_nodes import (
    BODY_INPUT,
    CUT_GROUP,
    CUT_INPUT,
    END_INPUT,
    FRAME_INPUT,
    HIDDEN,
    KEPT_INPUT,
    OWN_INPUT,
    PART,
    Layer,
    Plan,
    ensure_part_tree,
    ensure_surface_tree,
    make_cut_tree,
    told_layers,
    value_name,
    values_of,
)
from .foreign import RAY_KINDS, lamp_box
from .lights import lamps
from .materials import dielectric_node, dielectrics, medium_material, unchanged_nodes
from .media import CUT_OF, HIDDEN_BY_CUT, get_priority, is_cut_surface, is_rendered, media
from .node_group import CUT, has_analysis
from .parameters import PRIORITY_PROPERTY
from .shapes import content_of
from .trees import (
    is_plugged,
    read_attributes,
    reads_generated,
    reads_whole_mesh,
    shows_other_volume,
    shows_others,
    shows_others_blindly,
)

COLLECTION = "Nested Dielectric Cut"
SUFFIX = " (cut)"
"""Behind a medium's name: the object that shows its surface."""

KEPT = "nd_kept"
"""The same of the cut that is kept: what it was made from."""

HOLDER = "all"
"""In place of a medium: an object that shows none."""

CUT_SETTING = "nd_cut_surfaces"
"""Custom property of a scene: whether its surfaces are to be cut."""

PLAN = "nd_plan"
"""Custom property of the object that holds the cut: what its nodes were made from."""

MOST_LAYERS = 32
"""That may cross in any combination: each pair is looked at in every frame."""

ALIKE = (
    *(f"visible_{ray}" for ray in RAY_KINDS),
    "visible_raycast",
    "is_holdout",
    "is_shadow_catcher",
    "pass_index",
    "color",
    "lightgroup",
    "shadow_terminator_normal_offset",
    "shadow_terminator_geometry_offset",
    "shadow_terminator_shading_offset",
)
ALIKE_IN_CYCLES = (
    "use_motion_blur",
    "motion_steps",
    "use_camera_cull",
    "use_distance_cull",
    "ao_distance",
    "is_caustics_caster",
    "is_caustics_receiver",
)
"""What a render makes of an object beside its shape."""


@dataclass(frozen=True)
class Cut:
    """Which media of a scene are rendered cut, by name, and which are not and why."""

    media: tuple[str, ...] = ()
    asking: tuple[tuple[str, str], ...] = ()

    def __str__(self) -> str:
        lines = [f"cut where they cross: {analysis.listed(self.media)}"] if self.media else []
        return "\n".join(lines + [f"{name!r} is not cut: it {reason}" for name, reason in self.asking])


def is_cut(scene: bpy.types.Scene) -> bool:
    """Tell whether a scene's surfaces are cut where media cross: a setting of the scene."""
    return bool(scene.get(CUT_SETTING))


def set_cut(scene: bpy.types.Scene, cut: bool) -> None:
    """Render the media of a scene as surfaces that are cut where they cross, or as they are.

    Nothing of the artist's is changed but that media are hidden from renders, which goes back.
    """
    if cut:
        scene[CUT_SETTING] = True
    else:
        show_whole(scene)


def cut_surfaces(scene: bpy.types.Scene, scripted: bool = False) -> Cut:
    """Make what renders show of a scene that is cut, or bring it up to date; return what was found.

    :param scripted: a script may change any object on any frame.
    """
    plan, found = make_plan(scene, scripted)
    _show(scene, plan)
    _drop_if_changed(scene, plan)
    show_strays()
    _last[scene.session_uid] = found
    return found


_last: dict[int, Cut] = {}
"""What was found of each scene in this session, by its number."""


def last_cut(scene: bpy.types.Scene) -> Cut | None:
    """Return what was last found of a scene that is cut; None if it is not, or nobody has looked in this session."""
    return _last.get(scene.session_uid) if is_cut(scene) else None


def show_whole(scene: bpy.types.Scene) -> bool:
    """Render the artist's own objects again; return whether they were not."""
    was_cut = is_cut(scene)
    scene.pop(CUT_SETTING, None)
    _clear(scene)
    _last.pop(scene.session_uid, None)
    return was_cut


def _clear(scene: bpy.types.Scene) -> None:
    if CUT in scene:
        del scene[CUT]
        scene.update_tag()
    collection = _find_collection(scene)
    if collection is not None:
        for obj in list(collection.objects):
            _remove(obj)
        bpy.data.collections.remove(collection)
    for obj in scene.objects:
        _unhide(obj)


def keep_in_file(scene: bpy.types.Scene, scripted: bool = False) -> str:
    """Keep the cut of the present frame in the file, so that whoever renders this frame has nothing to cut; other frames are
    cut as ever. :func:`forget_kept` takes it back. Returns why that cannot be, or nothing.
    """
    surfaces = _surfaces(scene)
    plan, _ = make_plan(scene, scripted)
    if not surfaces or _holder(scene).get(PLAN) != _described(plan):
        return "nothing is cut, or something has changed since; press Prepare Scene"
    if scene.render.use_simplify:
        return "Simplify may show other shapes in a render"
    different = [obj.name for obj in surfaces if not all(map(analysis.is_same_in_renders, obj.modifiers))]
    if different:
        return f"{analysis.listed(tuple(different))} has modifiers that do otherwise in renders"
    forget_kept(scene)
    layer = scene.view_layers[0]
    for surface in surfaces.values():
        surface.hide_viewport = False
    layer.update()
    for surface in surfaces.values():
        evaluated = surface.evaluated_get(layer.depsgraph)
        mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=layer.depsgraph)
        mesh.use_auto_texspace = False
        mesh.texspace_location, mesh.texspace_size = evaluated.data.texspace_location, evaluated.data.texspace_size
        _exchange_mesh(surface, mesh)
        _set_inputs(surface.modifiers[0], {KEPT_INPUT: True, FRAME_INPUT: scene.frame_current})
        surface.hide_viewport = True
    _holder(scene)[KEPT] = _state(scene, plan)
    return ""


def is_kept(scene: bpy.types.Scene) -> bool:
    """Tell whether the cut of one frame is kept in the file."""
    holder = _holder(scene)
    return holder is not None and KEPT in holder


def forget_kept(scene: bpy.types.Scene) -> bool:
    """Cut every frame as it is rendered; return whether one was kept."""
    was_kept = is_kept(scene)
    for obj, surface in _surfaces(scene).items() if was_kept else ():
        _set_inputs(surface.modifiers[0], {KEPT_INPUT: False})
        _exchange_mesh(surface, bpy.data.meshes.new(surface.name))
        _liken(surface, obj)
    if was_kept:
        del _holder(scene)[KEPT]
    return was_kept


def _drop_if_changed(scene: bpy.types.Scene, plan: Plan) -> None:
    """Forget what is kept of a scene once it is not what would be cut."""
    if is_kept(scene) and _holder(scene)[KEPT] != _state(scene, plan):
        forget_kept(scene)


def _state(scene: bpy.types.Scene, plan: Plan) -> str:
    """What a plan's cut depends on on the present frame, as a short text: shapes, places and all that faces carry."""
    state = sha256(_described(plan).encode())
    depsgraph = scene.view_layers[0].depsgraph
    for obj in plan.numbers():
        state.update(np.ascontiguousarray(obj.matrix_world))
        state.update(content_of(obj.evaluated_get(depsgraph).data))
    for place in sorted(told_layers(plan)):
        inputs = dielectric_node(plan.layers[place].material).inputs
        state.update(repr([_plain_value(inputs[name].default_value) for name in values_of(plan.layers[place])]).encode())
    return state.hexdigest()


def _plain_value(value):
    return value if isinstance(value, (bool, int, float)) else tuple(value)


def _surfaces(scene: bpy.types.Scene) -> dict[bpy.types.Object, bpy.types.Object]:
    """The objects that show media in renders, by the media."""
    collection = _find_collection(scene)
    found = collection.objects if collection is not None else ()
    return {obj[CUT_OF]: obj for obj in found if isinstance(obj.get(CUT_OF), bpy.types.Object)}


def _holder(scene: bpy.types.Scene) -> bpy.types.Object | None:
    """The object whose modifier cuts."""
    collection = _find_collection(scene)
    return next((obj for obj in collection.objects if PLAN in obj), None) if collection is not None else None


def _exchange_mesh(surface: bpy.types.Object, mesh: bpy.types.Mesh) -> None:
    before, surface.data = surface.data, mesh
    bpy.data.meshes.remove(before)


def show_strays() -> None:
    """Let renders show media that are hidden in favour of surfaces of a scene that they are not in."""
    shown = {obj for scene in bpy.data.scenes if is_cut(scene) for obj in scene.objects}
    for obj in bpy.data.objects:
        if obj not in shown:
            _unhide(obj)


_CONCERNED = (
    bpy.types.Scene,
    bpy.types.Object,
    bpy.types.Mesh,
    bpy.types.Material,
    bpy.types.ShaderNodeTree,
    bpy.types.Collection,
)


def concerns(depsgraph: bpy.types.Depsgraph) -> bool:
    """Tell whether an update may change which media cross, or how they are shown."""
    return any(isinstance(update.id, _CONCERNED) for update in depsgraph.updates)


# Planning -----------------------------------------------------------------------------------------------------------


@unchanged_nodes()
def make_plan(scene: bpy.types.Scene, scripted: bool = False) -> tuple[Plan, Cut]:
    """Tell what to cut of a scene, as :func:`cut_surfaces` does."""
    hidden = set(scene.objects) - _in_shown_collections(scene.collection)
    objects = [obj for obj in media(scene) if is_rendered(obj) and obj not in hidden]
    hindered = _hindrances(scene, objects)
    moving = set(objects) if scripted else {obj for obj in objects if analysis.may_change(obj)}
    known = None if moving else _surroundings(scene, objects)
    touching = _touching(objects, moving, known)
    whole = _needed_whole(scene, objects, touching)
    for obj in whole - hindered.keys():
        if any(_layer_of(other) == _layer_of(obj) for other in touching[obj]):
            hindered[obj] = "overlaps another of its medium, and its surface is needed whole: it has colour, labels or other shaders"
    asking: list[tuple[str, str]] = []
    chosen: list[bpy.types.Object] = []
    for group in _components(objects, touching):
        bad = [obj for obj in group if obj in hindered]
        asking += [(obj.name, hindered[obj]) for obj in bad]
        if bad:
            asking += [(obj.name, f"may meet {bad[0].name!r}, which is not cut") for obj in group if obj not in hindered]
        elif len(group) > 1 and any(known is None or known[obj].may_cross for obj in group):
            chosen += group
    layers, pairs = _layers(chosen, whole, touching, known)
    if moving and len(layers) > MOST_LAYERS:
        reason = f"moves among media of more than {MOST_LAYERS} priorities and materials"
        return Plan(), Cut((), (*asking, *((obj.name, reason) for obj in chosen)))
    plan = Plan(layers, pairs, bool(moving), _attributes(scene, chosen))
    return plan, Cut(tuple(obj.name for obj in chosen), tuple(asking))


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
    instanced = {
        instance.object.original for instance in depsgraph.object_instances if instance.is_instance
    }
    shown_otherwise = _shown_otherwise(scene, objects)
    own = set(scene.objects)
    elsewhere = {obj for other in bpy.data.scenes if other != scene for obj in other.objects}
    of_materials = {
        material: _material_hindrance(material) for material in {slot.material for obj in objects for slot in obj.material_slots}
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
    if deformed and any(slot.material and slot.material.node_tree and reads_generated(slot.material) for slot in obj.material_slots):
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
    :param is_simple: its surface is in one piece.
    """

    code: int
    around: bpy.types.Object | None
    partners: tuple[bpy.types.Object, ...]
    is_simple: bool

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
    return {
        obj: _Surroundings(
            contact.code,
            None if contact.around is None else rows[contact.around][0],
            tuple(rows[partner][0] for partner in contact.partners),
            len(body.solid.by_island[1]) == 2,
        )
        for (obj, body), contact in zip(rows, contacts)
    }


def _touching(
    objects: Sequence[bpy.types.Object], moving: set[bpy.types.Object], known: dict | None
) -> dict[bpy.types.Object, list[bpy.types.Object]]:
    """Which media may meet: those that do, or whose boxes do; what moves may meet all."""
    if known is not None:
        pairs = {frozenset((obj, other)) for obj in objects for other in (*known[obj].partners, known[obj].around) if other}
    else:
        boxes = np.array([_box(obj) for obj in objects]).reshape(-1, 2, 3)
        pairs = set()
        for index, obj in enumerate(objects):
            meets = np.all((boxes[index, 0] <= boxes[:, 1]) & (boxes[index, 1] >= boxes[:, 0]), axis=1)
            pairs |= {
                frozenset((obj, other)) for other, touches in zip(objects, meets) if touches or {obj, other} & moving
            }
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


def _components(objects: Iterable[bpy.types.Object], touching: dict) -> Iterable[list[bpy.types.Object]]:
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
        crossing = odd | {other for obj in odd for other in known[obj].partners if not _lies_within(other, known, grouped)}
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
    inputs = dielectric_node(material).inputs
    return (
        _may_absorb(material)
        or bool(inputs["Disperse"].default_value)
        or inputs["Dispersion Model"].default_value == 2
        or any(inputs[name].is_linked or is_animated(material.node_tree, inputs[name]) for name in ("Disperse", "Dispersion Model"))
    )


def _may_absorb(material: bpy.types.Material) -> bool:
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
    return labelled | blind | {obj for obj in near if _may_absorb(medium_material(obj))}


def _others_near(scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]) -> set[bpy.types.Object]:
    """Media in whose boxes things that are no media, lamps or the camera may be."""
    if not objects:
        return set()
    own = set(objects)
    boxes = np.array([_box(obj) for obj in objects])
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
    meets = np.zeros(len(boxes), dtype=bool)
    for low, high in others:
        meets |= np.all((boxes[:, 0] <= high) & (boxes[:, 1] >= low), axis=1)
    return {obj for obj, near in zip(objects, meets) if near}


def _attributes(scene: bpy.types.Scene, objects: Iterable[bpy.types.Object]) -> dict[bpy.types.Object, tuple[str, ...]]:
    """Attributes of media that their materials read and that are not of corners."""
    depsgraph = scene.view_layers[0].depsgraph
    names = cache(read_attributes)
    found = {}
    for obj in objects:
        mesh = obj.evaluated_get(depsgraph).data
        wanted = set().union(*(names(slot.material) for slot in obj.material_slots if slot.material and slot.material.node_tree))
        if "" in wanted:
            index = mesh.color_attributes.render_color_index
            wanted |= {each.name for each in mesh.color_attributes[max(index, 0) : index + 1]}
        domains = {each.name: each.domain for each in mesh.attributes} | {group.name: "POINT" for group in obj.vertex_groups}
        chosen = tuple(sorted(name for name in wanted if domains.get(name, "CORNER") != "CORNER" and name != "position"))
        if chosen:
            found[obj] = chosen
    return found


# Showing ------------------------------------------------------------------------------------------------------------


def _find_collection(scene: bpy.types.Scene) -> bpy.types.Collection | None:
    """The collection of the scene's own that holds what renders show in place of media."""
    return next((each for each in scene.collection.children if CUT_OF in each and each.library is None), None)


def _ensure_collection(scene: bpy.types.Scene) -> bpy.types.Collection:
    collection = _find_collection(scene)
    if collection is None:
        collection = bpy.data.collections.new(COLLECTION)
        collection[CUT_OF] = True
        collection.hide_select = True
        scene.collection.children.link(collection)
    shown = [each for layer in scene.view_layers for each in layer.layer_collection.children if each.collection == collection]
    for owner, names in ((collection, ("hide_render",)), *((each, ("exclude", "holdout", "indirect_only")) for each in shown)):
        for name in names:
            if getattr(owner, name):
                setattr(owner, name, False)
    return collection


def _show(scene: bpy.types.Scene, plan: Plan) -> None:
    """Let renders show what a plan cuts in place of the artist's objects."""
    if not plan.layers:
        _clear(scene)
        return
    if scene.get(CUT) != 1.0:
        scene[CUT] = 1.0
        scene.update_tag()
    numbers = plan.numbers()
    collection = _ensure_collection(scene)
    surfaces = {}
    for obj in list(collection.objects):
        source = obj.get(CUT_OF)
        if source in numbers and source not in surfaces:
            surfaces[source] = obj
        elif source != HOLDER:
            _remove(obj)
    for obj in scene.objects:
        if HIDDEN_BY_CUT in obj and obj not in numbers:
            _unhide(obj)
    holder, *parts = _ensure_holders(collection, len(numbers))
    _ensure_nodes(holder, plan)
    for place, part in enumerate(parts):
        part.modifiers[0].node_group = ensure_part_tree()
        _set_inputs(part.modifiers[0], {CUT_INPUT: holder, BODY_INPUT: place * PART, END_INPUT: (place + 1) * PART})
    tree = ensure_surface_tree()
    for obj, number in numbers.items():
        if obj not in surfaces:
            surfaces[obj] = _new_surface(obj, collection, tree)
        surface = surfaces[obj]
        source = parts[number // PART] if parts else holder
        _set_inputs(surface.modifiers[0], {OWN_INPUT: obj, CUT_INPUT: source, BODY_INPUT: number})
        _liken(surface, obj)
        if HIDDEN_BY_CUT not in obj:
            obj[HIDDEN_BY_CUT] = True
        if not obj.hide_render:
            obj.hide_render = True
    _link_lights(surfaces)


def _ensure_holders(collection: bpy.types.Collection, media: int) -> list[bpy.types.Object]:
    """The object whose modifier cuts, and where there are many media one for each part of them. They are nowhere seen."""
    count = 1 + (-(-media // PART) if media > PART else 0)
    holders = sorted((obj for obj in collection.objects if obj.get(CUT_OF) == HOLDER), key=lambda obj: PLAN not in obj)
    for obj in holders[count:]:
        _remove(obj)
    while len(holders) < count:
        holder = bpy.data.objects.new(COLLECTION, bpy.data.meshes.new(COLLECTION))
        holder[CUT_OF] = HOLDER
        holder.hide_render = holder.hide_viewport = holder.hide_select = True
        holder.modifiers.new(CUT_GROUP, "NODES")
        collection.objects.link(holder)
        holders.append(holder)
    return holders[:count]


def _ensure_nodes(holder: bpy.types.Object, plan: Plan) -> None:
    """Give the object that cuts the nodes of a plan, and drivers that bring what materials say now."""
    described = _described(plan)
    modifier = holder.modifiers[0]
    if holder.get(PLAN) == described and modifier.node_group is not None:
        return
    holder.animation_data_clear()
    before, modifier.node_group = modifier.node_group, None
    _remove_tree(before)
    modifier.node_group = make_cut_tree(plan)
    holder[PLAN] = described
    for place in told_layers(plan):
        for name in values_of(plan.layers[place]):
            _drive(holder, modifier, value_name(name, place), plan.layers[place].material, name)


def _described(plan: Plan) -> str:
    """What a plan's nodes depend on, as a short text."""
    text = repr(
        (
            [
                (
                    layer.priority,
                    layer.material.name_full,
                    [obj.name_full for obj in layer.crossing],
                    [(obj.name_full, around) for obj, around in layer.constant],
                    layer.overlapping,
                    layer.tells_more,
                    layer.keeps_hidden,
                )
                for layer in plan.layers
            ],
            sorted(plan.pairs),
            plan.may_part,
            sorted((obj.name_full, names) for obj, names in plan.attributes.items()),
        )
    )
    return sha256(text.encode()).hexdigest()


def _drive(
    holder: bpy.types.Object, modifier: bpy.types.NodesModifier, name: str, material: bpy.types.Material, socket: str
) -> None:
    """Let an input of a modifier be what a material's socket is, without a script."""
    identifier = modifier.node_group.interface.items_tree[name].identifier
    path = f'modifiers["{modifier.name}"].properties.inputs.{identifier}.value'
    value = dielectric_node(material).inputs[socket].default_value
    parts = [-1] if isinstance(value, (bool, int, float)) else range(3)
    for part in parts:
        driver = holder.driver_add(path, part).driver
        driver.type = "SUM"
        target = driver.variables.new().targets[0]
        target.id_type = "MATERIAL"
        target.id = material
        target.data_path = f'node_tree.nodes["{dielectric_node(material).name}"].inputs["{socket}"].default_value'
        if part >= 0:
            target.data_path += f"[{part}]"


def _set_inputs(modifier: bpy.types.NodesModifier, values: dict) -> None:
    for name, value in values.items():
        socket = _input_of(modifier, name)
        if socket.value != value:
            socket.value = value
            modifier.id_data.update_tag()


def _input_of(modifier: bpy.types.NodesModifier, name: str) -> bpy.types.bpy_struct:
    tree = modifier.node_group.interface.items_tree
    socket = next(item for item in tree if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name == name)
    return getattr(modifier.properties.inputs, socket.identifier)


def _new_surface(
    obj: bpy.types.Object, collection: bpy.types.Collection, tree: bpy.types.NodeTree
) -> bpy.types.Object:
    """An object that shows a medium's surface, where the medium is."""
    name = obj.name + SUFFIX
    surface = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    surface[CUT_OF] = obj
    surface.parent = obj
    surface.hide_viewport = surface.hide_select = True
    for slot in obj.material_slots:
        surface.data.materials.append(slot.material)
    collection.objects.link(surface)
    surface.modifiers.new(COLLECTION, "NODES").node_group = tree
    return surface


def _liken(surface: bpy.types.Object, obj: bpy.types.Object) -> None:
    """Make a render treat the surface as the medium itself."""
    animated = {curve.data_path for curve in curves(obj.animation_data)}
    for owner, source, names in ((surface, obj, ALIKE), (surface.cycles, obj.cycles, ALIKE_IN_CYCLES)):
        for name in names:
            if name not in owner.bl_rna.properties:
                continue
            value = getattr(source, name)
            before = getattr(owner, name)
            if value != before and (isinstance(value, (bool, int, float, str)) or tuple(value) != tuple(before)):
                setattr(owner, name, value)
    if not surface.name.startswith(obj.name + SUFFIX):
        surface.name = obj.name + SUFFIX
    while len(surface.data.materials) < len(obj.material_slots):
        surface.data.materials.append(None)
    for own, slot in zip(surface.material_slots, obj.material_slots):
        if own.link != slot.link or own.material != slot.material:
            own.link = slot.link
            own.material = slot.material
    own = {key: _plain(obj[key]) for key in obj.keys() if key != HIDDEN_BY_CUT}
    for key in surface.keys() - own.keys() - {CUT_OF}:
        del surface[key]
    for key, value in own.items():
        if key not in surface or _plain(surface[key]) != value:
            surface[key] = value
    for path in animated:
        if path in ALIKE or path.startswith('["'):
            _follow(surface, obj, path)
    for linking in ("receiver_collection", "blocker_collection"):
        if getattr(surface.light_linking, linking) != getattr(obj.light_linking, linking):
            setattr(surface.light_linking, linking, getattr(obj.light_linking, linking))


def _plain(value):
    """What a custom property holds, to be compared and copied."""
    if hasattr(value, "to_dict"):
        return value.to_dict()
    return value.to_list() if hasattr(value, "to_list") else value


def _follow(surface: bpy.types.Object, obj: bpy.types.Object, path: str) -> None:
    """Let a property of the surface be what the medium's is on each frame."""
    if any(curve.data_path == path for curve in curves(surface.animation_data)):
        return
    value = obj.path_resolve(path)
    for part in [-1] if isinstance(value, (bool, int, float)) else range(len(value)):
        driver = surface.driver_add(path, part).driver
        driver.type = "SUM"
        target = driver.variables.new().targets[0]
        target.id = obj
        target.data_path = path if part < 0 else f"{path}[{part}]"


def _link_lights(surfaces: dict[bpy.types.Object, bpy.types.Object]) -> None:
    """Put the surfaces of media into the collections by which lights single these out."""
    for collection in _linking_collections():
        members = set(collection.objects)
        for obj in members & surfaces.keys():
            if surfaces[obj] not in members:
                collection.objects.link(surfaces[obj])
            states = dict(zip(collection.objects, collection.collection_objects))
            states[surfaces[obj]].light_linking.link_state = states[obj].light_linking.link_state


def _linking_collections() -> set[bpy.types.Collection]:
    roots = {
        collection
        for each in bpy.data.objects
        for collection in (each.light_linking.receiver_collection, each.light_linking.blocker_collection)
        if collection is not None
    }
    return {each for root in roots for each in (root, *root.children_recursive)}


def _unhide(obj: bpy.types.Object) -> None:
    if HIDDEN_BY_CUT in obj:
        del obj[HIDDEN_BY_CUT]
        obj.hide_render = False


def _remove(obj: bpy.types.Object) -> None:
    """Take an object of the collection away, with what is its own."""
    data = obj.data
    trees = [modifier.node_group for modifier in obj.modifiers]
    bpy.data.objects.remove(obj)
    if isinstance(data, bpy.types.Mesh) and not data.users:
        bpy.data.meshes.remove(data)
    for tree in trees:
        _remove_tree(tree)


def _remove_tree(tree: bpy.types.NodeTree | None) -> None:
    """Remove a group that nobody uses, and those in it."""
    if tree is None or tree.users or tree.library is not None:
        return
    inner = [node.node_tree for node in tree.nodes if node.type == "GROUP"]
    bpy.data.node_groups.remove(tree)
    for each in dict.fromkeys(inner):
        _remove_tree(each)
