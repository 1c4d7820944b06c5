"""Where a nested dielectric stands in a material's nodes, and what other media can read of it.

They read the sockets of the node `Nested Dielectric` at the top of the material's tree, whatever else is there. So the node
that is plugged in must have that name; and where it stands in a group of the artist's, a node of that name, whose surface is
plugged into nothing, holds its values at the top.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import bpy

from ..model.parameters import GROUP_NAME, NEIGHBOUR_PARAMETERS, SOCKETS
from .animation import is_animated
from .node_group import CYCLES_OUTPUT, DAMAGED, PREVIEW_OUTPUT, VOLUME_OUTPUT, group_version

Place = tuple[bpy.types.Node, ...]
"""A nested dielectric's node behind the nodes of the groups that it stands in, the outermost first."""

PREPARE = "press Prepare Scene"
MASKS = ("Surface Exists", "Is Entrance", "Is Exit")
"""Outputs that tell where a surface exists."""


def is_dielectric(node: bpy.types.Node | None) -> bool:
    """Whether a node shows a group of the extension's, of whichever version."""
    return node is not None and node.type == "GROUP" and group_version(node.node_tree) is not None


def is_plugged(node: bpy.types.Node) -> bool:
    """Whether the surface of a nested dielectric's node goes anywhere: if not, it stands in for one in a group."""
    return any(output.is_linked for output in node.outputs if output.name == CYCLES_OUTPUT)


def shows_dielectric(material: bpy.types.Material) -> bool:
    """Whether the light of a nested dielectric reaches the output that Cycles renders."""
    return any(name == CYCLES_OUTPUT for _, name in _shown(material, "CYCLES", "Surface"))


def dielectric_places(material: bpy.types.Material) -> list[Place]:
    """Return the nested dielectrics whose light reaches the output that Cycles renders: through reroutes, mixes that let it
    through, muted nodes and groups.
    """
    return [place for place, name in _shown(material, "CYCLES", "Surface") if name == CYCLES_OUTPUT]


def shows_others_blindly(material: bpy.types.Material) -> bool:
    """Whether other shaders are mixed with a nested dielectric by nodes that do not ask it where its surface exists."""
    sources = list(_sources(material, "CYCLES", "Surface"))
    dielectrics = [place[-1] for place, name in sources if name == CYCLES_OUTPUT and is_dielectric(place[-1])]
    asked = any(output.is_linked for node in dielectrics for output in node.outputs if output.name in MASKS)
    return bool(dielectrics) and shows_others(material) and not asked


def shows_others(material: bpy.types.Material) -> bool:
    """Whether shaders at which light may end reach the output that Cycles renders beside a nested dielectric."""
    sources = _sources(material, "CYCLES", "Surface")
    return any(not is_dielectric(place[-1]) and place[-1].type != "BSDF_TRANSPARENT" for place, _ in sources)


def own_nodes(tree: bpy.types.NodeTree) -> Iterator[bpy.types.Node]:
    """Yield an artist's nodes of a tree, those in groups too."""
    for node in tree.nodes:
        yield node
        if node.type == "GROUP" and node.node_tree is not None and not is_dielectric(node):
            yield from own_nodes(node.node_tree)


def read_attributes(material: bpy.types.Material) -> set[str]:
    """Return the names of a mesh's attributes that a material reads; empty stands for its active colours."""
    nodes = list(own_nodes(material.node_tree))
    names = {node.attribute_name for node in nodes if node.type == "ATTRIBUTE" and node.attribute_type == "GEOMETRY"}
    return names | {node.layer_name for node in nodes if node.type == "VERTEX_COLOR"}


_WHOLE = {"OBJECT_INFO": {"Random"}, "NEW_GEOMETRY": {"Pointiness", "Random Per Island"}}
"""Outputs of nodes that depend on an object's name, or on all of its mesh."""


def reads_whole_mesh(material: bpy.types.Material) -> str:
    """Return the name of a node or output by which a material looks another way on part of a mesh, or nothing."""
    for node in own_nodes(material.node_tree):
        if node.type in ("BEVEL", "AMBIENT_OCCLUSION", "WIREFRAME"):
            return node.bl_label
        for output in node.outputs if node.type in _WHOLE else ():
            if output.is_linked and output.name in _WHOLE[node.type]:
                return output.name
    return ""


def reads_generated(material: bpy.types.Material) -> bool:
    """Whether a material reads Generated coordinates, as textures do by themselves."""
    return any(
        (node.type == "TEX_COORD" and node.outputs["Generated"].is_linked)
        or (node.type.startswith("TEX_") and "Vector" in node.inputs and not node.inputs["Vector"].is_linked)
        for node in own_nodes(material.node_tree)
    )


def shows_other_volume(material: bpy.types.Material) -> bool:
    """Whether a volume that is no nested dielectric's reaches the output that Cycles renders."""
    return any(not is_dielectric(place[-1]) for place, _ in _sources(material, "CYCLES", "Volume"))


def value_socket(place: Place, name: str) -> bpy.types.NodeSocket | None:
    """Return the socket that holds the value of a nested dielectric's parameter: its own, or one of a group around it; None
    where other nodes make the value.
    """
    *groups, node = place
    first = socket = node.inputs.get(name)
    while links := _links(socket):
        node = links[0].from_node
        if node.type == "REROUTE" and _links(node.inputs[0]):
            socket = node.inputs[0]
        elif node.type == "GROUP_INPUT" and groups:
            socket = _twin(groups.pop().inputs, links[0].from_socket)
        else:
            return None
    return socket if hasattr(socket, "default_value") and socket.type == first.type else None


def mend_nodes(material: bpy.types.Material) -> list[str]:
    """Let other media read the nested dielectric that is plugged in; return what was changed, in sentences.

    Where several are plugged in, or the material belongs to a library, nothing is changed.
    """
    places = dielectric_places(material) if material.node_tree is not None and material.is_editable else []
    if len(places) != 1:
        return []
    (place,) = places
    node = place[-1]
    nodes = material.node_tree.nodes
    readable = nodes.get(GROUP_NAME)
    if len(place) == 1:
        if readable == node:
            return []
        before = node.name
        if readable is not None:
            readable.name = f"{GROUP_NAME} Other"
        node.name = GROUP_NAME
        return [f"{material.name}: the node {before!r}, which is plugged in, is named {GROUP_NAME!r}"]
    changes = []
    if not is_dielectric(readable) or is_plugged(readable):
        if readable is not None:
            readable.name = f"{GROUP_NAME} Other"
        readable = nodes.new("ShaderNodeGroup")
        readable.name = GROUP_NAME
        readable.label = f"Read by neighbours: {place[0].name}"
        readable.location = place[0].location[0], place[0].location[1] + 260.0
        changes = [f"{material.name}: a node {GROUP_NAME!r} lets neighbours read what stands in {place[0].name!r}"]
    if readable.node_tree != node.node_tree:
        readable.node_tree = node.node_tree
    for parameter in SOCKETS:
        source = value_socket(place, parameter.name) if parameter.kind != "SHADER" else None
        target = readable.inputs.get(parameter.name)
        if source is not None and target is not None and socket_value(source) != socket_value(target):
            target.default_value = socket_value(source)
            changes = changes or [f"{material.name}: neighbours read what stands in {place[0].name!r} again"]
    return changes


def complete_nodes(material: bpy.types.Material) -> list[str]:
    """Plug in what a nested dielectric that was added by hand lacks: its absorption and its look in EEVEE. Return what was
    changed, in sentences. What else is plugged in stays.
    """
    if not material.is_editable or len(dielectric_places(material)) != 1:
        return []
    tree = material.node_tree
    node = tree.nodes.get(GROUP_NAME)
    output = tree.get_output_node("CYCLES")
    if not is_dielectric(node) or not {VOLUME_OUTPUT, PREVIEW_OUTPUT} <= set(node.outputs.keys()):
        return []
    changes = []
    if not output.inputs["Volume"].is_linked:
        tree.links.new(node.outputs[VOLUME_OUTPUT], output.inputs["Volume"])
        changes.append(f"{material.name}: {VOLUME_OUTPUT} plugged in")
    if _lacks_preview(material):
        preview = tree.get_output_node("EEVEE")
        if preview in (None, output):
            output.target = "CYCLES"
            preview = tree.nodes.new("ShaderNodeOutputMaterial")
            preview.target = "EEVEE"
            preview.location = output.location[0], output.location[1] - 160.0
        tree.links.new(node.outputs[PREVIEW_OUTPUT], preview.inputs["Surface"])
        changes.append(f"{material.name}: {PREVIEW_OUTPUT} plugged into an output for EEVEE")
    return changes


def node_problems(material: bpy.types.Material) -> Iterator[tuple[str, str]]:
    """Yield what is wrong with the nested dielectric in a material's nodes, after "has ", and the remedies."""
    tree = material.node_tree
    if tree is None or not _holds_dielectric(tree, set()):
        return
    where = f"material {material.name!r}"
    prepare = PREPARE if material.library is None else f"{PREPARE} in {material.library.filepath!r}"
    places = dielectric_places(material)
    damaged = next((place[-1].node_tree for place in places if group_version(place[-1].node_tree) == DAMAGED), None)
    if damaged is not None:
        yield f"a nested dielectric in {where} whose group {damaged.name!r} is damaged", prepare
        return
    if not places:
        yield (
            f"a nested dielectric in {where} that does not reach the output",
            f"plug its {CYCLES_OUTPUT} into the output that Cycles renders and unmute both, or delete it",
        )
        return
    if len(places) > 1:
        yield (
            f"{len(places)} nested dielectrics plugged into {where}, of which its neighbours see one",
            "leave one; mix other shaders with it, or vary its sockets",
        )
        return
    (place,) = places
    node = place[-1]
    readable = tree.nodes.get(GROUP_NAME)
    if len(place) == 1 and readable != node:
        yield (
            f"a nested dielectric in {where} whose node is named {node.name!r}, where its neighbours do not look",
            f"rename the node to {GROUP_NAME!r}, or {prepare}",
        )
        return
    if not is_dielectric(readable):
        yield (
            f"a nested dielectric in the group {place[0].name!r} of {where}, where its neighbours do not look",
            f"{prepare}, or take it out of the group (Node > Ungroup)",
        )
        return
    for name in NEIGHBOUR_PARAMETERS:
        if name not in node.inputs or name not in readable.inputs:
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
    if _may_absorb(place) and not _shows(material, "CYCLES", "Volume", VOLUME_OUTPUT):
        yield (
            f"an absorbing medium in {where} whose {VOLUME_OUTPUT} is not plugged in",
            f"plug {VOLUME_OUTPUT} into the output's Volume, with an Add Shader node where something else is there"
            if tree.get_output_node("CYCLES").inputs["Volume"].is_linked
            else f"plug {VOLUME_OUTPUT} into the output's Volume, or {prepare}",
        )
    if _lacks_preview(material):
        yield (
            f"a nested dielectric in {where} that EEVEE does not show",
            f"plug {PREVIEW_OUTPUT} into an output whose target is EEVEE, or {prepare}",
        )
    if not material.use_transparent_shadow:
        yield (
            f"no Transparent Shadows in {where}, so light does not get through surfaces that are not there",
            "switch them on (Material > Settings > Surface); Shadow Mode makes shadows dark",
        )


def socket_value(socket: bpy.types.NodeSocket) -> Any:
    """Return the value of a socket as numbers, words and tuples that compare."""
    value = socket.default_value
    return value if isinstance(value, (int, float, str)) else tuple(value)


# Following links ------------------------------------------------------------------------------------------------------


def _shows(material: bpy.types.Material, target: str, socket: str, output: str) -> bool:
    """Whether an output of a nested dielectric reaches a socket of a material's output."""
    return any(name == output for _, name in _shown(material, target, socket))


def _shown(material: bpy.types.Material, target: str, socket: str) -> Iterator[tuple[Place, str]]:
    """The nested dielectrics behind a socket of a material's output, with the names of their outputs."""
    return ((place, name) for place, name in _sources(material, target, socket) if is_dielectric(place[-1]))


def _sources(material: bpy.types.Material, target: str, socket: str) -> Iterator[tuple[Place, str]]:
    """The nodes that make what a socket of a material's output gets, with the names of their outputs."""
    output = None if material.node_tree is None else material.node_tree.get_output_node(target)
    if output is not None:
        yield from _behind(output.inputs[socket], (), set())


def _behind(socket: bpy.types.NodeSocket | None, groups: Place, seen: set) -> Iterator[tuple[Place, str]]:
    for link in _links(socket):
        yield from _from(link.from_node, link.from_socket, groups, seen)


def _from(node: bpy.types.Node, output: bpy.types.NodeSocket, groups: Place, seen: set) -> Iterator[tuple[Place, str]]:
    key = *(group.as_pointer() for group in groups), output.as_pointer()
    if key in seen:
        return
    seen.add(key)
    if node.mute:
        for link in node.internal_links:
            if link.to_socket == output:
                yield from _behind(link.from_socket, groups, seen)
    elif is_dielectric(node):
        yield (*groups, node), output.name
    elif node.type == "GROUP":
        sink = _group_output(node.node_tree)
        if sink is not None:
            yield from _behind(_twin(sink.inputs, output), (*groups, node), seen)
    elif node.type == "GROUP_INPUT":
        if groups:
            yield from _behind(_twin(groups[-1].inputs, output), groups[:-1], seen)
    elif inputs := _let_through(node):
        for socket in inputs:
            yield from _behind(socket, groups, seen)
    else:
        yield (*groups, node), output.name


def _let_through(node: bpy.types.Node) -> list[bpy.types.NodeSocket]:
    """The inputs of a node whose light it passes on."""
    if node.type == "MIX_SHADER" and not _links(node.inputs[0]):
        factor, *shaders = node.inputs
        if factor.default_value in (0.0, 1.0):
            return [shaders[int(factor.default_value)]]
    return [socket for socket in node.inputs if socket.type == "SHADER" or node.type == "REROUTE"]


def _links(socket: bpy.types.NodeSocket | None) -> list[bpy.types.NodeLink]:
    """The links into a socket that count."""
    if socket is None or not socket.is_linked:
        return []
    return [link for link in socket.links if not link.is_muted]


def _group_output(tree: bpy.types.NodeTree | None) -> bpy.types.Node | None:
    nodes = () if tree is None else tree.nodes
    return next((node for node in nodes if node.type == "GROUP_OUTPUT" and node.is_active_output), None)


def _twin(sockets: Iterator[bpy.types.NodeSocket], other: bpy.types.NodeSocket) -> bpy.types.NodeSocket | None:
    """The socket of a group's node that is one of the group's own ends inside, or the other way round."""
    return next((socket for socket in sockets if socket.identifier == other.identifier), None)


def _holds_dielectric(tree: bpy.types.NodeTree, seen: set) -> bool:
    """Whether a nested dielectric stands anywhere in a tree or its groups."""
    if tree in seen:
        return False
    seen.add(tree)
    return any(
        is_dielectric(node) or (node.node_tree is not None and _holds_dielectric(node.node_tree, seen))
        for node in tree.nodes
        if node.type == "GROUP"
    )


def _lacks_preview(material: bpy.types.Material) -> bool:
    """Whether EEVEE would show what is for Cycles, or nothing; an output for EEVEE alone is the artist's own."""
    output, preview = map(material.node_tree.get_output_node, ("CYCLES", "EEVEE"))
    if preview is None or preview == output:
        return not _shows(material, "EEVEE", "Surface", PREVIEW_OUTPUT)
    return not preview.inputs["Surface"].is_linked


def _may_absorb(place: Place) -> bool:
    transmittance, depth = (value_socket(place, name) for name in ("Transmittance", "Transmittance Depth"))
    return (
        transmittance is None
        or depth is None
        or is_animated(transmittance.id_data, transmittance)
        or (min(transmittance.default_value[:3]) < 1.0 and depth.default_value > 0.0)
    )
