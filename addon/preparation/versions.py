"""Materials that another version of the extension made, and the copies that an append makes: all are brought to one.

A group of sockets is exchanged for another by the sockets' names, so that all that an artist set, linked, drove or keyframed
stays, whatever came to stand between.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any

import bpy

from ..analysis.analysis import is_analysed
from ..model.parameters import ParameterError
from ..nodes.animation import curves
from ..nodes.compatibility import require_blender, takes_front_ior
from ..nodes.node_group import (
    DAMAGED,
    FRONT_IOR_VERSION,
    MATERIAL_VERSION,
    OFFSET_GROUP,
    arm_dispersion,
    ensure_group,
    find_group,
    group_version,
    hide_internals,
    is_offset_group,
    set_table,
    table_of,
)
from ..nodes.spectral_images import TABLES
from ..scene.lights import refresh_lights
from ..scene.materials import dielectric_node, refresh_spectrum, show_colours_through
from .checks import Problem
from .live import analyse


def update_materials() -> tuple[str, ...]:
    """Bring all materials of the open file to this version of the extension, and copies of what it keeps in a file to one.

    Values, links, drivers and keyframes stay. What belongs to a library, or was made by a newer version, is left as it is.
    Returns what was changed, in sentences; a second call changes nothing. Raises
    :class:`~nested_dielectric.compatibility.UnsupportedError` if this Blender cannot render the materials.
    """
    require_blender()
    return _update(list(_outdated_nodes()))


def _update(outdated: list[bpy.types.ShaderNodeGroup]) -> tuple[str, ...]:
    """Give nodes this version's group, and make one of the copies of what else the extension keeps."""
    changes = []
    if outdated:
        leftovers = _Leftovers()
        for node in outdated:
            leftovers.note(node.node_tree)
        curves_moved, sockets_moved = {}, {}
        for node in outdated:
            before = group_version(node.node_tree)
            of_curves, of_sockets, lost = _exchange(node, ensure_group())
            curves_moved.setdefault(node.id_data, {}).update(of_curves)
            sockets_moved.setdefault(node.id_data, {}).update(of_sockets)
            owner = _owner(node.id_data)
            if before != MATERIAL_VERSION and isinstance(owner, bpy.types.Material):
                show_colours_through(owner)
            how = {MATERIAL_VERSION: "one of several copies", DAMAGED: "damaged"}.get(before, f"version {before}")
            changes.append(f"{owner.name}: was {how}")
            changes += [f"{owner.name}: {name!r} could not be kept" for name in lost]
        _move_curves(curves_moved)
        _move_readers(sockets_moved)
    if refresh_lights():
        changes.append("Lamps of direct refraction and reflection: listed again")
    if outdated:
        leftovers.remove()
    changes += _merge_offsets()
    _arm_groups()
    if changes:
        for scene in bpy.data.scenes:
            if is_analysed(scene):
                analyse(scene)
    return tuple(changes)


def mend_materials() -> tuple[str, ...]:
    """Update materials if this Blender would show them wrong, as a file from another may have them; else let them be, but for
    copies of this version's group, which would go by another list of lamps.

    Returns what was changed, in sentences.
    """
    if any(tree.library is None and _is_wrong_here(tree) for tree in bpy.data.node_groups):
        return update_materials()
    copies = [node for node in _outdated_nodes() if group_version(node.node_tree) == MATERIAL_VERSION]
    if copies:
        return _update(copies)
    _arm_groups()
    return ()


def outdated_materials() -> list[str]:
    """Return the names of what :func:`update_materials` would change the version or the copy of: materials and groups."""
    return sorted({_owner(node.id_data).name for node in _outdated_nodes()})


def version_problems() -> list[Problem]:
    """Return what is wrong with the versions of materials and cannot be changed here."""
    newer = {tree for tree in bpy.data.node_groups if (group_version(tree) or 0) > MATERIAL_VERSION}
    wrong = {tree for tree in bpy.data.node_groups if tree.library is not None and _is_wrong_here(tree)}
    problems = []
    for material in bpy.data.materials if newer or wrong else ():
        node = dielectric_node(material)
        tree = None if node is None else node.node_tree
        if tree in newer:
            problems.append(
                Problem(material.name, "was made by a newer version", "install that version of the extension")
            )
        elif tree in wrong and material.library is not None:
            remedy = f"press Update Materials in {material.library.filepath!r} and save it"
            damaged = group_version(tree) == DAMAGED
            how = "in which its node group is damaged" if damaged else "of an older version, which is wrong here"
            problems.append(Problem(material.name, f"comes from a file {how}", remedy))
    return problems


def _is_wrong_here(tree: bpy.types.NodeTree) -> bool:
    version = group_version(tree)
    return version == DAMAGED or (version is not None and version < FRONT_IOR_VERSION and bool(takes_front_ior()))


def _arm_groups() -> None:
    for tree in bpy.data.node_groups:
        if tree.library is None and group_version(tree) == MATERIAL_VERSION:
            arm_dispersion(tree)


def _outdated_nodes() -> Iterator[bpy.types.ShaderNodeGroup]:
    """Group nodes of the file's own materials and groups that show another group than this version's one."""
    current = find_group()
    groups = {tree for tree in bpy.data.node_groups if _is_outdated(tree, current)}
    for host in _shader_trees() if groups else ():
        for node in host.nodes:
            if node.type == "GROUP" and node.node_tree in groups:
                yield node


def _is_outdated(tree: bpy.types.NodeTree, current: bpy.types.NodeTree | None) -> bool:
    """Whether a group is of an older version, or a copy of this version's one in this file."""
    version = group_version(tree)
    if version is None or version > MATERIAL_VERSION:
        return False
    return version < MATERIAL_VERSION or (tree.library is None and tree != current)


def _shader_trees() -> Iterator[bpy.types.NodeTree]:
    for material in bpy.data.materials:
        if material.library is None and material.node_tree is not None:
            yield material.node_tree
    for tree in bpy.data.node_groups:
        if tree.library is None and tree.bl_idname == "ShaderNodeTree" and group_version(tree) is None:
            yield tree


def _owner(tree: bpy.types.NodeTree) -> bpy.types.ID:
    """The material that a tree is part of, or the tree itself where it is a group."""
    if not tree.is_embedded_data:
        return tree
    return next(material for material in bpy.data.materials if material.node_tree == tree)


# Exchanging a group ---------------------------------------------------------------------------------------------------


def _exchange(
    node: bpy.types.ShaderNodeGroup, group: bpy.types.NodeTree
) -> tuple[dict[str, str], dict[str, str], list[str]]:
    """Give a node another group. Return where the paths of its keyframes and drivers are to move, where those of its sockets
    have moved, and the names of what could not stay.

    Blender moves keyframes and drivers itself, to the sockets of the same number, and leaves what reads sockets.
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
        lost += _join(links, source, node.inputs.get(name), name, muted)
    for name, target, muted in leaving:
        lost += _join(links, node.outputs.get(name), target, name, muted)
    for socket in (*node.inputs, *node.outputs):
        socket.hide = socket.name in hidden
    hide_internals(node)
    if table is not None:
        set_table(node, table)
    else:
        lost += _bake_again(_owner(node.id_data))
    places = {socket.name: place for place, socket in enumerate(node.inputs)}
    numbered = {socket.identifier: place for place, socket in enumerate(node.inputs)}
    prefix = f'nodes["{bpy.utils.escape_identifier(node.name)}"].inputs'

    def paths(moved: Iterable[tuple[int, str]]) -> dict[str, str]:
        return {f"{prefix}[{at}]": f"{prefix}[{places[name]}]" for at, name in moved if places.get(name, at) != at}

    of_curves = paths((numbered.get(number, at), name) for at, (name, number) in enumerate(before))
    of_sockets = paths((at, name) for at, (name, _) in enumerate(before))
    return of_curves, of_sockets, lost


def _bake_again(owner: bpy.types.ID) -> list[str]:
    """Give a material whose table is lost another; what could not be kept."""
    if not isinstance(owner, bpy.types.Material) or dielectric_node(owner) is None:
        return ["Spectrum"]
    try:
        refresh_spectrum(owner)
    except ParameterError:
        return ["Spectrum"]
    return []


def _value(socket: bpy.types.NodeSocket) -> Any:
    value = socket.default_value
    return value if isinstance(value, (int, float, str)) else tuple(value)


def _set_value(socket: bpy.types.NodeSocket | None, value: Any) -> bool:
    """Set a socket's value; False if there is no such socket, or it takes no such value."""
    if socket is None or not hasattr(socket, "default_value"):
        return False
    try:
        socket.default_value = value
    except (TypeError, ValueError):
        return False
    return True


def _join(
    links: bpy.types.NodeLinks,
    source: bpy.types.NodeSocket | None,
    target: bpy.types.NodeSocket | None,
    name: str,
    muted: bool,
) -> list[str]:
    """Link two sockets; the name in a list if one of them is not there."""
    if source is None or target is None:
        return [name]
    links.new(source, target).is_muted = muted
    return []


def _move_curves(moved: dict[bpy.types.NodeTree, dict[str, str]]) -> None:
    """Let keyframes and drivers of trees go to other paths."""
    seen: set[int] = set()
    for tree, places in moved.items():
        for curve in curves(tree.animation_data) if places else ():
            if curve.as_pointer() not in seen:  # trees may share an action
                seen.add(curve.as_pointer())
                curve.data_path = _moved(curve.data_path, places)


def _move_readers(moved: dict[bpy.types.NodeTree, dict[str, str]]) -> None:
    """Let drivers that read sockets of trees follow these to their new places."""
    moved = {tree: places for tree, places in moved.items() if places}
    prefixes = {(tree, ""): places for tree, places in moved.items()}
    prefixes |= {(_owner(tree), "node_tree."): places for tree, places in moved.items() if tree.is_embedded_data}
    for data in _all_data() if moved else ():
        for curve in data.animation_data.drivers if data.animation_data else ():
            for target in (target for variable in curve.driver.variables for target in variable.targets):
                for (owner, prefix), places in prefixes.items():
                    if target.id == owner and target.data_path.startswith(prefix):
                        target.data_path = prefix + _moved(target.data_path.removeprefix(prefix), places)
                        break


def _moved(path: str, places: dict[str, str]) -> str:
    for old, new in places.items():
        if path.startswith(old):
            return new + path.removeprefix(old)
    return path


def _all_data() -> Iterator[bpy.types.ID]:
    """Every data-block of the file that may be animated."""
    for data in bpy.data.all_ids:
        tree = getattr(data, "node_tree", None)
        for each in (data, tree if tree is not None and tree.is_embedded_data else None):
            if hasattr(each, "animation_data"):
                yield each


# Leftovers ------------------------------------------------------------------------------------------------------------


@dataclass
class _Leftovers:
    """What exchanged groups leave behind: they themselves, their texts, images of tables and lists of lamps."""

    groups: set[bpy.types.NodeTree] = field(default_factory=set)
    texts: set[bpy.types.Text] = field(default_factory=set)
    images: set[bpy.types.Image] = field(default_factory=set)

    def note(self, tree: bpy.types.NodeTree) -> None:
        """Remember a local group and what stands in it."""
        if tree.library is not None or tree in self.groups:
            return
        self.groups.add(tree)
        for data in _held_by(tree):
            if isinstance(data, bpy.types.NodeTree):
                self.note(data)
            else:
                (self.texts if isinstance(data, bpy.types.Text) else self.images).add(data)

    def remove(self) -> None:
        """Remove what nothing uses any more; a text's own users are the Script nodes that are left."""
        left = self.groups
        while unused := {tree for tree in left if _is_unused(tree)}:
            left = left - unused
            _remove_unused(unused, bpy.data.node_groups.remove)
        _remove_unused(self.images, bpy.data.images.remove)
        _remove_unused(self.texts, bpy.data.texts.remove)
        tree = find_group()
        for data in (tree, *dict.fromkeys(_held_within(tree))):
            _take_plain_name(data)


def _held_by(tree: bpy.types.NodeTree) -> Iterator[bpy.types.ID]:
    """Texts of shaders, images of tables and groups in a group."""
    for node in tree.nodes:
        if node.type == "SCRIPT" and node.script is not None:
            yield node.script
        elif node.type == "TEX_IMAGE" and node.image is not None and TABLES in node.image:
            yield node.image
        elif node.type == "GROUP" and node.node_tree is not None:
            yield node.node_tree


def _held_within(tree: bpy.types.NodeTree) -> Iterator[bpy.types.ID]:
    """The same, in groups within the group, too."""
    for data in _held_by(tree):
        yield data
        if isinstance(data, bpy.types.NodeTree):
            yield from _held_within(data)


def _is_unused(data: bpy.types.ID) -> bool:
    return data.users - data.use_fake_user == 0


def _remove_unused(found: Iterable[bpy.types.ID], remove: Callable[[bpy.types.ID], None]) -> None:
    for data in found:
        if _is_unused(data):
            remove(data)


def _take_plain_name(data: bpy.types.ID) -> None:
    """Name what is left of several copies as the first of them; Blender numbers it if that is still taken."""
    if data.name != _plain_name(data):
        data.name = _plain_name(data)


def _plain_name(data: bpy.types.ID) -> str:
    """A name without the number that Blender gives a copy."""
    stem, _, number = data.name.rpartition(".")
    return stem if number.isdigit() else data.name


def _merge_offsets() -> list[str]:
    """Let all modifiers that part faces use one group."""
    found = [
        tree
        for tree in bpy.data.node_groups
        if tree.library is None and is_offset_group(tree) and _plain_name(tree) == OFFSET_GROUP
    ]
    if [tree.name for tree in found] in ([], [OFFSET_GROUP]):
        return []
    # One that reads no name would forget those that the modifiers of the others give.
    kept, *copies = sorted(found, key=lambda tree: len(tree.interface.items_tree), reverse=True)
    for tree in copies:
        tree.user_remap(kept)
    _remove_unused(copies, bpy.data.node_groups.remove)
    _take_plain_name(kept)
    return [f"{OFFSET_GROUP}: {len(found)} copies became one" if copies else f"{OFFSET_GROUP}: has its name back"]
