"""What faces of a medium have to carry or to show beside its index."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache

import bpy

from ..model.enumerations import DISPERSION_MODELS
from ..nodes.animation import is_animated
from ..nodes.mesh_reads import read_attributes
from ..nodes.places import ignores_masks, shows_others
from ..scene.materials import dielectric_node, medium_material
from .neighbours import near_foreign_objects

_JF_MODEL = next(index for index, model in enumerate(DISPERSION_MODELS) if model.keyword == "JF")
"""The dispersion model of JF, whose curve faces carry even where the medium itself splits no light."""


def needs_all_values(material: bpy.types.Material) -> bool:
    """Return whether faces in a medium have to carry more than its index: colour or dispersion."""
    node = dielectric_node(material)
    model = node.inputs["Dispersion Model"]
    return (
        may_absorb(material)
        or is_in_use(node, "Disperse")
        or model.default_value == _JF_MODEL
        or model.is_linked
        or is_animated(material.node_tree, model)
    )


def is_in_use(node: bpy.types.ShaderNodeGroup, name: str) -> bool:
    """Return whether a switch of a medium is on, or may be on some frame or hit."""
    socket = node.inputs[name]
    return bool(socket.default_value) or socket.is_linked or is_animated(node.id_data, socket)


def may_absorb(material: bpy.types.Material) -> bool:
    """Return whether a medium has colour, now or on some frame."""
    socket = dielectric_node(material).inputs["Transmittance"]
    return min(socket.default_value[:3]) < 1.0 or socket.is_linked or is_animated(material.node_tree, socket)


def media_needed_whole(
    scene: bpy.types.Scene, objects: Sequence[bpy.types.Object], touching: dict
) -> set[bpy.types.Object]:
    """Return media whose surfaces are needed inside winners, too.

    They show what is no medium, or light enters and leaves their volumes by them where it may start or end inside.
    """
    labelled = {obj for obj in objects if any(slot.material != medium_material(obj) for slot in obj.material_slots)}
    mixed = {material: shows_others(material) for material in set(map(medium_material, objects))}
    dirty = {obj for obj in objects if mixed[medium_material(obj)]} | labelled
    near = near_foreign_objects(scene, objects) | dirty.union(*(touching[obj] for obj in dirty))
    blind = {obj for obj in dirty if ignores_masks(medium_material(obj))}
    return labelled | blind | {obj for obj in near if may_absorb(medium_material(obj))}


def attributes_to_move(
    scene: bpy.types.Scene, objects: Iterable[bpy.types.Object]
) -> dict[bpy.types.Object, tuple[str, ...]]:
    """Return the names of attributes of media that their materials read and that are not of corners, sorted."""
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
