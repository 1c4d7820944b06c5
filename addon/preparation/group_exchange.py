"""Exchanging the group of a node for another: its values, links, keyframes and drivers go to the sockets of the same names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

import bpy

from ..model.parameter import ParameterError
from ..nodes.animation import curves
from ..nodes.sockets import hide_internal_sockets
from ..nodes.spectral_tables import set_table, table_of
from ..scene.material_spectra import refresh_spectrum
from ..scene.materials import dielectric_node


def owner_of(tree: bpy.types.NodeTree) -> bpy.types.ID:
    """Return the material that a tree is part of, or the tree itself where it is a group."""
    if not tree.is_embedded_data:
        return tree
    return next(material for material in bpy.data.materials if material.node_tree == tree)


def exchange_group(
    node: bpy.types.ShaderNodeGroup, group: bpy.types.NodeTree
) -> tuple[dict[str, str], dict[str, str], list[str]]:
    """Give a node another group.

    Blender moves keyframes and drivers itself, to the sockets of the same number, and leaves what reads sockets.

    :returns: where the paths of the node's keyframes and drivers are to move, where those of its sockets have moved, and the
        names of what could not stay.
    """
    links = node.id_data.links
    table = table_of(node)
    before = [(socket.name, socket.identifier) for socket in node.inputs]
    values = {socket.name: _value(socket) for socket in node.inputs if hasattr(socket, "default_value")}
    hidden = {socket.name for socket in (*node.inputs, *node.outputs) if socket.hide}
    arriving = [(link.from_socket, link.to_socket.name, link.is_muted) for s in node.inputs for link in s.links]
    leaving = [(link.from_socket.name, link.to_socket, link.is_muted) for s in node.outputs for link in s.links]

    node.node_tree = group
    for link in [link for socket in (*node.inputs, *node.outputs) for link in socket.links]:
        links.remove(link)
    lost = [name for name, value in values.items() if not _set_value(node.inputs.get(name), value)]
    for source, name, muted in arriving:
        lost += _link(links, source, node.inputs.get(name), name, muted)
    for name, target, muted in leaving:
        lost += _link(links, node.outputs.get(name), target, name, muted)
    for socket in (*node.inputs, *node.outputs):
        socket.hide = socket.name in hidden
    hide_internal_sockets(node)
    if table is not None:
        set_table(node, table)
    else:
        lost += _bake_again(owner_of(node.id_data))
    places = {socket.name: place for place, socket in enumerate(node.inputs)}
    numbered = {socket.identifier: place for place, socket in enumerate(node.inputs)}
    prefix = f'nodes["{bpy.utils.escape_identifier(node.name)}"].inputs'

    def paths(moved: Iterable[tuple[int, str]]) -> dict[str, str]:
        return {f"{prefix}[{at}]": f"{prefix}[{places[name]}]" for at, name in moved if places.get(name, at) != at}

    of_curves = paths((numbered.get(number, at), name) for at, (name, number) in enumerate(before))
    of_sockets = paths((at, name) for at, (name, _) in enumerate(before))
    return of_curves, of_sockets, lost


def _bake_again(owner: bpy.types.ID) -> list[str]:
    """Give a material whose table is lost another; return what could not be kept."""
    if not isinstance(owner, bpy.types.Material) or dielectric_node(owner) is None:
        return ["Spectrum"]
    try:
        refresh_spectrum(owner)
    except ParameterError:
        return ["Spectrum"]
    return []


def _value(socket: bpy.types.NodeSocket) -> Any:
    """Return a socket's value, several numbers as a tuple."""
    value = socket.default_value
    return value if isinstance(value, (int, float, str)) else tuple(value)


def _set_value(socket: bpy.types.NodeSocket | None, value: Any) -> bool:
    """Set a socket's value; return whether there is such a socket and it takes such a value."""
    if socket is None or not hasattr(socket, "default_value"):
        return False
    try:
        socket.default_value = value
    except (TypeError, ValueError):
        return False
    return True


def _link(
    links: bpy.types.NodeLinks,
    source: bpy.types.NodeSocket | None,
    target: bpy.types.NodeSocket | None,
    name: str,
    muted: bool,
) -> list[str]:
    """Link two sockets; return the name in a list if one of them is not there."""
    if source is None or target is None:
        return [name]
    links.new(source, target).is_muted = muted
    return []


def move_curves(moved: dict[bpy.types.NodeTree, dict[str, str]]) -> None:
    """Let keyframes and drivers of trees go to other paths."""
    seen: set[int] = set()
    for tree, places in moved.items():
        for curve in curves(tree.animation_data) if places else ():
            if curve.as_pointer() not in seen:  # trees may share an action
                seen.add(curve.as_pointer())
                curve.data_path = _moved(curve.data_path, places)


def move_readers(moved: dict[bpy.types.NodeTree, dict[str, str]]) -> None:
    """Let drivers that read sockets of trees follow these to their new places."""
    moved = {tree: places for tree, places in moved.items() if places}
    prefixes = {(tree, ""): places for tree, places in moved.items()}
    prefixes |= {(owner_of(tree), "node_tree."): places for tree, places in moved.items() if tree.is_embedded_data}
    for data in _all_data() if moved else ():
        for curve in data.animation_data.drivers if data.animation_data else ():
            for target in (target for variable in curve.driver.variables for target in variable.targets):
                for (owner, prefix), places in prefixes.items():
                    if target.id == owner and target.data_path.startswith(prefix):
                        target.data_path = prefix + _moved(target.data_path.removeprefix(prefix), places)
                        break


def _moved(path: str, places: dict[str, str]) -> str:
    """Return where a path is after what it begins with has moved."""
    for old, new in places.items():
        if path.startswith(old):
            return new + path.removeprefix(old)
    return path


def _all_data() -> Iterator[bpy.types.ID]:
    """Yield every data-block of the file that may be animated."""
    for data in bpy.data.all_ids:
        tree = getattr(data, "node_tree", None)
        for each in (data, tree if tree is not None and tree.is_embedded_data else None):
            if hasattr(each, "animation_data"):
                yield each
