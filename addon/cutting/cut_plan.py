"""Which media of a scene are cut where they cross, and which cannot be and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy

from ..analysis import findings, stability
from ..nodes.cutting.plan import Plan
from ..nodes.lookups import caching_nodes
from ..scene.materials import medium_material
from ..scene.media import is_rendered, media
from .layers import layer_key, make_layers
from .medium_contents import attributes_to_move, may_absorb, media_needed_whole
from .neighbours import Surroundings, connected_groups, known_surroundings, touching_media
from .obstacles import find_obstacles

MOST_LAYERS = 32
"""The most layers that may cross in any combination: each pair is looked at in every frame."""


@dataclass(frozen=True)
class CutReport:
    """Which media of a scene are rendered cut, by name, and which are not and why."""

    media: tuple[str, ...] = ()
    asking: tuple[tuple[str, str], ...] = ()

    def __str__(self) -> str:
        lines = [f"cut where they cross: {findings.listed(self.media)}"] if self.media else []
        return "\n".join(lines + [f"{name!r} is not cut: it {reason}" for name, reason in self.asking])


@caching_nodes()
def make_plan(scene: bpy.types.Scene, scripted: bool = False, native: bool = False) -> tuple[Plan, CutReport]:
    """Tell what to cut of a scene, and what cannot be cut and why.

    :param scripted: a script may change any object on any frame.
    :param native: no medium may ask: those of which the analysis knows nothing are cut, too, so that their faces tell what
        they are in, alone or not.
    """
    hidden = set(scene.objects) - _in_shown_collections(scene.collection)
    objects = [obj for obj in media(scene) if is_rendered(obj) and obj not in hidden]
    obstacles = find_obstacles(scene, objects)
    moving = set(objects) if scripted else {obj for obj in objects if stability.may_change(obj)}
    known = None if moving else known_surroundings(scene, objects)
    touching = touching_media(objects, moving, known)
    whole = media_needed_whole(scene, objects, touching)
    melting = {obj for obj in objects if any(layer_key(other) == layer_key(obj) for other in touching[obj])}
    for obj in (whole & melting) - obstacles.keys():
        obstacles[obj] = (
            "overlaps another of its medium, and its surface is needed whole: it has colour, labels or other shaders"
        )
    if native:  # volumes may have to take from shadow rays what media absorb
        whole |= {obj for obj in objects if obj not in melting and may_absorb(medium_material(obj))}
    for obj in known or ():
        if known[obj].coincides:
            obstacles.setdefault(
                obj, "has faces in the same place as another; press Prepare Scene, or let them overlap"
            )
    asking: list[tuple[str, str]] = []
    chosen: list[bpy.types.Object] = []
    for group in connected_groups(objects, touching):
        bad = [obj for obj in group if obj in obstacles]
        asking += [(obj.name, obstacles[obj]) for obj in bad]
        if bad:
            asking += [
                (obj.name, f"may meet {bad[0].name!r}, which is not cut") for obj in group if obj not in obstacles
            ]
        elif _has_to_be_cut(group, known) if native else len(group) > 1 and _may_cross(group, known):
            chosen += group
    layers, pairs = make_layers(chosen, whole, touching, known)
    if moving and len(layers) > MOST_LAYERS:
        reason = f"moves among media of more than {MOST_LAYERS} priorities and materials"
        return Plan(), CutReport((), (*asking, *((obj.name, reason) for obj in chosen)))
    plan = Plan(layers, pairs, bool(moving), attributes_to_move(scene, chosen))
    return plan, CutReport(tuple(obj.name for obj in chosen), tuple(asking))


def _may_cross(group: Sequence[bpy.types.Object], known: dict[bpy.types.Object, Surroundings] | None) -> bool:
    """Return whether surfaces of media that may meet may have more than one outside each."""
    return known is None or any(known[obj].may_cross for obj in group)


def _has_to_be_cut(group: Sequence[bpy.types.Object], known: dict[bpy.types.Object, Surroundings] | None) -> bool:
    """Return whether only their faces can tell some of these media what they are in."""
    return _may_cross(group, known) or not all(known[obj].is_told for obj in group)


def _in_shown_collections(collection: bpy.types.Collection) -> set[bpy.types.Object]:
    """Return the objects of a collection that no collection in it hides from renders."""
    if collection.hide_render:
        return set()
    return set(collection.objects).union(*map(_in_shown_collections, collection.children))
