"""Telling media what surrounds them, so that they need not ask the scene while it is rendered.

:func:`analyse` looks at a scene's media as they are evaluated now and writes what holds whenever the file is rendered: into
the sockets of a material where it holds for all of its objects, else into their custom properties. The shader needs nothing
else of the extension. What holds for part of a surface alone is told to nobody: media that cross ask. Whatever may be different
in a render (things that move, modifiers that depend on more than their mesh, what is hidden in the viewport alone) leaves all
media asking the scene, as they do without an analysis; and the shader checks a share of what it is told (osl/exterior.h).

What is told holds in the scene that was looked at, on the frame it showed then, and on all frames while somebody sees to it
that no script changes the scene (:mod:`nested_dielectric.preparation.live`): elsewhere the materials themselves fall back to
asking.
"""

from __future__ import annotations

from dataclasses import replace

import bpy

from ..geometry import contacts
from ..geometry.contacts import Contact
from ..geometry.solids import Body
from ..model.contract import Exterior
from ..nodes.identity import NO_SCENE, known_number
from ..nodes.lookups import caching_nodes
from ..nodes.names import ANALYSED, CENTRE, FACTS_SCENE
from . import solid_cache
from .exteriors import exterior_facts
from .facts import ExteriorFacts
from .findings import Found
from .session import analysis_of, forget_snapshots, forget_unused
from .snapshot import SceneSnapshot, changed_data, take_snapshot, updated_snapshot
from .storage import has_facts_of, leave_to_shader, write_centre, write_facts, write_material, write_object
from .validity import Validity, current_frame, is_analysed, set_native_validity, set_validity, validity_of


def analyse(scene: bpy.types.Scene) -> Found:
    """Look at the media of a scene, and tell each what surrounds it. The scene's media are kept analysed from then on.

    Linked materials and objects are left as they are.
    """
    layer = scene.view_layers[0]
    layer.update()
    solid_cache.forget_all()
    return _analyse_snapshot(take_snapshot(scene, layer.depsgraph))


def clear_analysis(scene: bpy.types.Scene) -> None:
    """Make all media of a scene ask it again while it is rendered, and leave no trace of the analysis on them.

    What another analysed scene shares with it asks there too until that one is analysed again.
    """
    scene.pop(ANALYSED, None)
    for name in (CENTRE, FACTS_SCENE):
        scene.pop(name, None)
    analysis_of(scene).snapshot = None
    number = known_number(scene)
    for material in bpy.data.materials:
        if has_facts_of(material, number):
            write_material(material, ExteriorFacts(), NO_SCENE)
            leave_to_shader(material)
    told = {material for material in bpy.data.materials if has_facts_of(material)}
    for obj in bpy.data.objects:
        if not any(slot.material in told for slot in obj.material_slots):
            write_object(obj, None)


def invalidate(scene: bpy.types.Scene) -> None:
    """Let the media of an analysed scene ask until it is analysed again."""
    set_validity(scene, replace(validity_of(scene), holds=0.0))
    analysis_of(scene).snapshot = None


def is_invalid(scene: bpy.types.Scene) -> bool:
    """Return whether an analysed scene has to be looked at again."""
    return analysis_of(scene).snapshot is None


def update(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    """Analyse again after an update of a scene whose media are kept analysed, as far as the update reaches."""
    changed = changed_data(depsgraph)
    if changed:
        _analyse_snapshot(updated_snapshot(analysis_of(scene).snapshot, scene, depsgraph, changed))


def update_or_invalidate(scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> bool:
    """Let all media ask after an update that changes any of them, which takes little time; return whether they do.

    What else an update changes is looked at and written at once.
    """
    changed = changed_data(depsgraph)
    if not changed:
        return False
    latest = analysis_of(scene).snapshot
    if latest is not None:
        snapshot = updated_snapshot(latest, scene, depsgraph, changed)
        # What was told comes back as an update that changes no medium.
        if snapshot.has_same_media(latest):
            _analyse_snapshot(snapshot)
            return False
    invalidate(scene)
    return True


def forget_shapes() -> None:
    """Look at all meshes anew the next time: after another file, or another state of this one, has been loaded."""
    solid_cache.forget_all()
    forget_snapshots()


def last_contacts(scene: bpy.types.Scene) -> tuple[list[tuple[bpy.types.Object, Body]], list[Contact]]:
    """Return the media of a scene whose exact shape is known, and what the last analysis in this session found of each."""
    snapshot = analysis_of(scene).snapshot
    if snapshot is None:
        return [], []
    return [(instance.obj, instance.body) for instance in snapshot.bodies], snapshot.contacts


def last_found(scene: bpy.types.Scene) -> Found | None:
    """Return what the last analysis of a scene found in this session, or None of a scene that is not analysed."""
    return analysis_of(scene).found if is_analysed(scene) else None


@caching_nodes()
def _analyse_snapshot(snapshot: SceneSnapshot) -> Found:
    """Find the contacts of a snapshot, and tell the media."""
    known = analysis_of(snapshot.scene)
    snapshot = replace(
        snapshot, contacts=contacts.analyse([instance.body for instance in snapshot.bodies], known.pair_cache)
    )
    told = exterior_facts(snapshot)
    write_facts(snapshot, told)
    write_centre(snapshot)
    known.snapshot, known.found = snapshot, findings_of(snapshot, told)
    set_native_validity(snapshot.scene, True)
    forget_unused()
    set_validity(snapshot.scene, Validity(1.0, current_frame(snapshot.scene), validity_of(snapshot.scene).every_frame))
    return known.found


def findings_of(snapshot: SceneSnapshot, told: dict[bpy.types.Object, ExteriorFacts] | None = None) -> Found:
    """Return what an analysis found, by name.

    :param told: what each medium is told; None works it out.
    """
    told = exterior_facts(snapshot) if told is None else told
    pairs = {
        tuple(sorted((instance.obj.name, snapshot.bodies[other].obj.name)))
        for instance, contact in zip(snapshot.bodies, snapshot.contacts)
        for other, *_ in contact.coincident
    }
    unstable = (each for each in snapshot.instances if each.medium and each.instability)
    doubts = dict(snapshot.instabilities) | {each.obj.name: each.instability for each in unstable}
    return Found(
        known=tuple(obj.name for obj, facts in told.items() if facts.code != Exterior.UNKNOWN),
        asking=tuple(obj.name for obj, facts in told.items() if facts.code == Exterior.UNKNOWN),
        overlapping=tuple(obj.name for obj, facts in told.items() if facts.overlaps_itself),
        coincident=tuple(sorted(pairs)),
        doubts=tuple(doubts.items()),
    )
