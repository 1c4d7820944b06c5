"""What media are told, in the sockets of their materials and in properties of objects."""

from __future__ import annotations

import itertools

import bpy
import numpy as np

from ..model.contract import BY_VOLUME_SOCKET, FACTS_HOLDS_NO_OBJECTS, LEAST_TRANSMITTANCE, MATERIAL_SLOTS, Exterior
from ..nodes.identity import NO_SCENE, scene_number
from ..nodes.names import (
    CENTRE,
    EXTERIOR_MEDIUM_SOCKET,
    EXTERIOR_SOCKET,
    EXTERIOR_TRANSMITTANCE_SOCKET,
    FOREIGN_SOCKET,
    GIVES_BACK_SOCKET,
    NATIVE_SOCKET,
    OBJECT_PROPERTIES,
    OVERLAP_SOCKET,
    SCENE_SOCKET,
    SLOTS_SOCKET,
    SOLE_PRIORITY_SOCKET,
)
from ..nodes.native.light import LARGEST_EXPONENT
from ..nodes.sockets import has_analysis
from ..nodes.stored import stored_numbers
from ..scene.materials import absorption_coefficients, dielectric_node
from ..scene.media import CUT_SETTING, is_cut_surface
from .facts import ExteriorFacts, common_facts, packed
from .mesh_modifiers import keeps_mesh
from .snapshot import SceneSnapshot


def write_facts(snapshot: SceneSnapshot, told: dict[bpy.types.Object, ExteriorFacts]) -> None:
    """Write what changed of what media are told. A material speaks for its objects if all of them are told the same."""
    users: dict[bpy.types.Material, list[bpy.types.Object]] = {}
    for obj in told:
        for material in {slot.material for slot in obj.material_slots} & snapshot.facts.keys():
            users.setdefault(material, []).append(obj)
    number = scene_number(snapshot.scene)
    slots = _largest_slot_counts()
    for material in snapshot.facts.keys() - users.keys():
        if has_facts_of(material, number):
            write_material(material, ExteriorFacts(), NO_SCENE)
    for material, objects in users.items():
        if material.library is not None or not snapshot.facts[material].can_be_told:
            continue
        common = common_facts(told[obj] for obj in objects)
        if common is None:
            # What a linked object carries is its own file's. What concerns volumes is the same for all objects: a volume that
            # read it of each would be noisy.
            first = told[objects[0]]
            code = Exterior.UNKNOWN if any(obj.library is not None for obj in objects) else Exterior.BY_OBJECT
            by_object = ExteriorFacts(code, by_volume=first.by_volume, gives_back=first.gives_back)
        write_material(material, common or by_object, number, slots.get(material))
        for obj in objects:
            write_object(obj, None if common else told[obj])


def write_material(material: bpy.types.Material, facts: ExteriorFacts, number: int, slots: int | None = None) -> None:
    """Write what holds for all objects of a material in the scene of that number."""
    node = dielectric_node(material)
    if material.library is not None or not has_analysis(node):
        return
    values = {
        SCENE_SOCKET: number,
        EXTERIOR_SOCKET: facts.code,
        SOLE_PRIORITY_SOCKET: facts.sole_priority,
        OVERLAP_SOCKET: facts.overlaps_itself,
        FOREIGN_SOCKET: facts.may_hold_objects,
        BY_VOLUME_SOCKET: number if facts.by_volume else NO_SCENE,
        GIVES_BACK_SOCKET: facts.gives_back,
        EXTERIOR_MEDIUM_SOCKET: facts.medium,
        EXTERIOR_TRANSMITTANCE_SOCKET: facts.transmittance,
        SLOTS_SOCKET: 1 if slots == 1 else MATERIAL_SLOTS,
    }
    for name, value in values.items():
        socket = node.inputs[name]
        before = socket.default_value
        if not np.array_equal(np.float32(before if np.isscalar(before) else tuple(before)), np.float32(value)):
            socket.default_value = value


def leave_to_shader(material: bpy.types.Material) -> None:
    """Leave a material to the shader, as Cycles' own nodes cannot ask."""
    socket = dielectric_node(material).inputs.get(NATIVE_SOCKET)
    if material.library is None and socket is not None and socket.default_value:
        socket.default_value = False


def write_object(obj: bpy.types.Object, facts: ExteriorFacts | None) -> None:
    """Write what an object is told into its custom properties, or with None remove them."""
    if obj.library is not None:
        return
    _remove_face_attribute(obj)
    values: tuple = (None, None)
    if facts is not None:
        values = ((packed(facts), *facts.medium), facts.transmittance if facts.absorbs else None)
    for name, value in zip(OBJECT_PROPERTIES, values):
        before = obj.get(name)
        if value is None:
            if before is not None:
                del obj[name]
                obj.update_tag()
        elif stored_numbers(obj, name, 4) != value:
            obj.pop(name, None)  # or it may keep another type
            obj[name] = value
            obj.update_tag()


def may_hold_objects(obj: bpy.types.Object) -> bool:
    """Return whether an object's own properties leave it open that objects that are no media stand in it."""
    values = stored_numbers(obj, OBJECT_PROPERTIES[0], 4)
    return values is None or not int(values[0]) & FACTS_HOLDS_NO_OBJECTS


def _remove_face_attribute(obj: bpy.types.Object) -> None:
    """Remove what older versions told the faces of a mesh."""
    mesh = obj.data
    if isinstance(mesh, bpy.types.Mesh) and mesh.library is None and obj.mode == "OBJECT":
        attribute = mesh.attributes.get(OBJECT_PROPERTIES[0])
        if attribute is not None and (attribute.data_type, attribute.domain) == ("INT8", "FACE"):
            mesh.attributes.remove(attribute)


def has_facts_of(material: bpy.types.Material, number: int | None = None) -> bool:
    """Return whether a material carries what an analysis found, of the scene of that number or with None of any."""
    node = dielectric_node(material)
    if node is None or not has_analysis(node):
        return False
    told_of = node.inputs[SCENE_SOCKET].default_value
    return told_of != NO_SCENE if number is None else told_of == number


def _largest_slot_counts() -> dict[bpy.types.Material, int]:
    """Return the most slots that an object of each material has; many where modifiers may add some, as on cut surfaces."""
    most: dict[bpy.types.Material, int] = {}
    may_be_cut = any(scene.get(CUT_SETTING) for scene in bpy.data.scenes)
    for obj in itertools.filterfalse(is_cut_surface, bpy.data.objects):
        count = len(obj.material_slots)
        if may_be_cut or any(
            modifier.type in ("NODES", "BOOLEAN") and not keeps_mesh(modifier) for modifier in obj.modifiers
        ):
            count = MATERIAL_SLOTS
        for slot in obj.material_slots:
            most[slot.material] = max(most.get(slot.material, 0), count)
    return most


def write_centre(snapshot: SceneSnapshot) -> None:
    """Write a point amid the media, from which shadow rays may measure their way; it stays as long as it is among them.

    There is none where colours may differ from place to place, or are too deep for single precision.
    """
    nodes = [dielectric_node(material) for material in snapshot.facts]
    varies = any(facts.coefficients is None for facts in snapshot.facts.values())
    black = any(min(node.inputs["Transmittance"].default_value[:3]) <= LEAST_TRANSMITTANCE for node in nodes)
    deepest = max((max(absorption_coefficients(node)) for node in nodes), default=0.0)
    boxes = np.array([instance.box for instance in snapshot.bodies]).reshape(-1, 2, 3)
    low, high = boxes[:, 0].min(axis=0, initial=np.inf), boxes[:, 1].max(axis=0, initial=-np.inf)
    before = stored_numbers(snapshot.scene, CENTRE, 3)
    if varies or black or not len(boxes) or deepest * np.linalg.norm(high - low) > LARGEST_EXPONENT:
        if snapshot.scene.pop(CENTRE, None) is not None:
            snapshot.scene.update_tag()
    elif before is None or not np.all((before >= low) & (before <= high)):
        snapshot.scene[CENTRE] = tuple(map(float, (low + high) / 2.0))
        snapshot.scene.update_tag()
