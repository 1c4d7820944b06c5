"""Problems of a nested dielectric in a material's nodes."""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..model.parameter import GROUP_NAME
from ..model.parameters import NEIGHBOUR_PARAMETERS, SETTINGS
from .animation import is_animated
from .links import Place, reaches_output
from .material_version import DAMAGED, group_version, is_dielectric
from .names import CYCLES_OUTPUT, PREVIEW_OUTPUT, VOLUME_OUTPUT
from .places import dielectric_places, lacks_preview, socket_value, value_socket

PREPARE = "press Prepare Scene"


def node_problems(material: bpy.types.Material) -> Iterator[tuple[str, str]]:
    """Yield what is wrong with the nested dielectric in a material's nodes, after "has ", and the remedies."""
    tree = material.node_tree
    where = f"material {material.name!r}"
    if has_lost_group(material):
        yield (
            f"a node {GROUP_NAME!r} in {where} whose group was deleted, and the values with it",
            "undo that, or assign a preset again",
        )
        return
    if tree is None or not _holds_dielectric(tree, set()):
        return
    prepare = PREPARE if material.library is None else f"{PREPARE} in {material.library.filepath!r}"
    places = dielectric_places(material)
    unreadable = _place_problem(tree, places, where, prepare)
    if unreadable is not None:
        yield unreadable
        return
    yield from _value_problems(places[0], tree.nodes[GROUP_NAME], where, prepare)
    yield from _output_problems(material, places[0], where, prepare)


def has_lost_group(material: bpy.types.Material) -> bool:
    """Return whether the group of a nested dielectric was deleted from the file: an empty node and settings are left."""
    node = None if material.node_tree is None else material.node_tree.nodes.get(GROUP_NAME)
    if node is None or node.bl_idname != "ShaderNodeGroup" or node.node_tree is not None:
        return False
    return any(setting.keyword in material for setting in SETTINGS)


def _place_problem(tree: bpy.types.NodeTree, places: list[Place], where: str, prepare: str) -> tuple[str, str] | None:
    """Return why no neighbour can read the nested dielectric of a tree, with the remedy; None if they can."""
    damaged = next((place[-1].node_tree for place in places if group_version(place[-1].node_tree) == DAMAGED), None)
    if damaged is not None:
        return f"a nested dielectric in {where} whose group {damaged.name!r} is damaged", prepare
    if not places:
        return (
            f"a nested dielectric in {where} that does not reach the output",
            f"plug its {CYCLES_OUTPUT} into the output that Cycles renders and unmute both, or delete it",
        )
    if len(places) > 1:
        return (
            f"{len(places)} nested dielectrics plugged into {where}, of which its neighbours see one",
            "leave one; mix other shaders with it, or vary its sockets",
        )
    (place,) = places
    readable = tree.nodes.get(GROUP_NAME)
    if len(place) == 1 and readable != place[-1]:
        return (
            f"a nested dielectric in {where} whose node is named {place[-1].name!r}, where its neighbours do not look",
            f"rename the node to {GROUP_NAME!r}, or {prepare}",
        )
    if not is_dielectric(readable):
        return (
            f"a nested dielectric in the group {place[0].name!r} of {where}, where its neighbours do not look",
            f"{prepare}, or take it out of the group (Node > Ungroup)",
        )
    return None


def _value_problems(place: Place, readable: bpy.types.Node, where: str, prepare: str) -> Iterator[tuple[str, str]]:
    """Yield the values of a nested dielectric that its neighbours read otherwise, and the remedies."""
    for name in NEIGHBOUR_PARAMETERS:
        if name not in place[-1].inputs or name not in readable.inputs:
            continue
        socket = value_socket(place, name)
        if socket is None:
            yield (
                f"a link into {name!r} of {where}, which its neighbours cannot follow",
                "unlink it; set, keyframe or drive the value itself",
            )
        elif len(place) > 1 and is_animated(socket.id_data, socket):
            yield (
                f"keyframes or a driver of {name!r} in {where}, which its neighbours cannot follow into the group "
                f"{place[0].name!r}",
                "take the node out of the group (Node > Ungroup)",
            )
        elif len(place) > 1 and socket_value(socket) != socket_value(readable.inputs[name]):
            yield f"another {name!r} in {where} than its neighbours read", prepare


def _output_problems(material: bpy.types.Material, place: Place, where: str, prepare: str) -> Iterator[tuple[str, str]]:
    """Yield what of a nested dielectric does not reach a material's outputs, and the remedies."""
    if _may_absorb(place) and not reaches_output(material, "CYCLES", "Volume", VOLUME_OUTPUT):
        yield (
            f"an absorbing medium in {where} whose {VOLUME_OUTPUT} is not plugged in",
            f"plug {VOLUME_OUTPUT} into the output's Volume, with an Add Shader node where something else is there"
            if material.node_tree.get_output_node("CYCLES").inputs["Volume"].is_linked
            else f"plug {VOLUME_OUTPUT} into the output's Volume, or {prepare}",
        )
    if lacks_preview(material):
        yield (
            f"a nested dielectric in {where} that EEVEE does not show",
            f"plug {PREVIEW_OUTPUT} into an output whose target is EEVEE, or {prepare}",
        )
    if not material.use_transparent_shadow:
        yield (
            f"no Transparent Shadows in {where}, so light does not get through surfaces that are not there",
            "switch them on (Material > Settings > Surface); Shadow Mode makes shadows dark",
        )


def _holds_dielectric(tree: bpy.types.NodeTree, seen: set) -> bool:
    """Return whether a nested dielectric stands anywhere in a tree or its groups."""
    if tree in seen:
        return False
    seen.add(tree)
    return any(
        is_dielectric(node) or (node.node_tree is not None and _holds_dielectric(node.node_tree, seen))
        for node in tree.nodes
        if node.type == "GROUP"
    )


def _may_absorb(place: Place) -> bool:
    """Return whether a nested dielectric takes some of the light, or may do so on another frame."""
    transmittance, depth = (value_socket(place, name) for name in ("Transmittance", "Transmittance Depth"))
    return (
        transmittance is None
        or depth is None
        or is_animated(transmittance.id_data, transmittance)
        or (min(transmittance.default_value[:3]) < 1.0 and depth.default_value > 0.0)
    )
