"""Materials that another version of the extension made, and copies that an append makes, brought to one version.

A group of sockets is exchanged for another by the sockets' names, so that all that an artist set, linked, drove or keyframed
stays, whatever came to stand between (:mod:`nested_dielectric.preparation.group_exchange`).
"""

from __future__ import annotations

from collections.abc import Iterator

import bpy

from ..analysis.validity import is_analysed
from ..checking.version_checks import is_wrong_here
from ..nodes.closures import arm_dispersion
from ..nodes.compatibility import require_blender
from ..nodes.group import ensure_group
from ..nodes.material_version import DAMAGED, MATERIAL_VERSION, find_group, group_version
from ..nodes.names import WHOLE
from ..nodes.script_mending import mend_scripts
from ..scene.lights import refresh_lights
from ..scene.new_materials import show_colours_through
from .group_exchange import exchange_group, move_curves, move_readers, owner_of
from .leftovers import Leftovers, merge_offset_groups
from .live import analyse


def update_materials() -> tuple[str, ...]:
    """Bring all materials of the open file to this version of the extension, and copies of what it keeps in a file to one.

    Values, links, drivers and keyframes stay. What belongs to a library, or was made by a newer version, is left as it is.
    A second call changes nothing.

    :returns: what was changed, in sentences.
    :raises UnsupportedError: if this Blender cannot render the materials.
    """
    require_blender()
    return _update(list(_outdated_nodes()))


def _update(outdated: list[bpy.types.ShaderNodeGroup]) -> tuple[str, ...]:
    """Give nodes this version's group, and merge copies of what else the extension keeps; return what was changed."""
    changes = []
    if outdated:
        leftovers = Leftovers()
        for node in outdated:
            leftovers.note(node.node_tree)
        curves_moved, sockets_moved = {}, {}
        for node in outdated:
            before = group_version(node.node_tree)
            of_curves, of_sockets, lost = exchange_group(node, ensure_group())
            curves_moved.setdefault(node.id_data, {}).update(of_curves)
            sockets_moved.setdefault(node.id_data, {}).update(of_sockets)
            owner = owner_of(node.id_data)
            if before != MATERIAL_VERSION and isinstance(owner, bpy.types.Material):
                show_colours_through(owner)
            how = {MATERIAL_VERSION: "one of several copies", DAMAGED: "damaged"}.get(before, f"version {before}")
            changes.append(f"{owner.name}: was {how}")
            changes += [f"{owner.name}: {name!r} could not be kept" for name in lost]
        move_curves(curves_moved)
        move_readers(sockets_moved)
    if refresh_lights():
        changes.append("Lights of direct refraction and reflection: listed again")
    if outdated:
        leftovers.remove()
    changes += merge_offset_groups()
    _arm_groups()
    if changes:
        for scene in bpy.data.scenes:
            if is_analysed(scene):
                analyse(scene)
    return tuple(changes)


def mend_materials() -> tuple[str, ...]:
    """Update materials if this Blender would show them wrong, as a file from another may have them.

    Else let them be, but for copies of this version's group, which would go by another list of lights.

    :returns: what was changed, in sentences.
    """
    mended = tuple(mend_scripts())
    if any(tree.library is None and is_wrong_here(tree) for tree in bpy.data.node_groups):
        return mended + update_materials()
    copies = [node for node in _outdated_nodes() if group_version(node.node_tree) == MATERIAL_VERSION]
    if copies:
        return mended + _update(copies)
    _arm_groups()
    return mended


def outdated_materials() -> list[str]:
    """Return the names of what :func:`update_materials` would change the version or the copy of: materials and groups."""
    return sorted({owner_of(node.id_data).name for node in _outdated_nodes()})


def _arm_groups() -> None:
    """Arm the dispersion of groups of this version, which files of another Blender may lack."""
    for tree in bpy.data.node_groups:
        if tree.library is None and group_version(tree) == MATERIAL_VERSION:
            arm_dispersion(tree)


def _outdated_nodes() -> Iterator[bpy.types.ShaderNodeGroup]:
    """Yield group nodes of the file's own materials and groups that show another group than this version's one."""
    current = find_group()
    groups = {tree for tree in bpy.data.node_groups if _is_outdated(tree, current)}
    for host in _shader_trees() if groups else ():
        for node in host.nodes:
            if node.type == "GROUP" and node.node_tree in groups:
                yield node


def _is_outdated(tree: bpy.types.NodeTree, current: bpy.types.NodeTree | None) -> bool:
    """Return whether a group is of an older version, or a copy of this version's one in this file."""
    version = group_version(tree)
    if version is None or version > MATERIAL_VERSION:
        return False
    return version < MATERIAL_VERSION or (tree.library is None and tree != current)


def _shader_trees() -> Iterator[bpy.types.NodeTree]:
    """Yield the trees of the file's own materials, and its shader groups but the extension's and the parts of those."""
    for material in bpy.data.materials:
        if material.library is None and material.node_tree is not None:
            yield material.node_tree
    for tree in bpy.data.node_groups:
        is_artists = tree.library is None and WHOLE not in tree and group_version(tree) is None
        if is_artists and tree.bl_idname == "ShaderNodeTree":
            yield tree
