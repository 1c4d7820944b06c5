"""Removing data-blocks that exchanged groups leave behind, and copies of groups."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field

import bpy

from ..nodes.material_version import find_group
from ..nodes.names import OFFSET_GROUP
from ..nodes.offset_group import is_offset_group
from ..nodes.spectral_images import TABLES


@dataclass
class Leftovers:
    """Data-blocks that exchanged groups leave behind: they themselves, their texts, images of tables and lists of lights."""

    groups: set[bpy.types.NodeTree] = field(default_factory=set)
    texts: set[bpy.types.Text] = field(default_factory=set)
    images: set[bpy.types.Image] = field(default_factory=set)

    def note(self, tree: bpy.types.NodeTree) -> None:
        """Remember a local group and what stands in it."""
        if tree.library is not None or tree in self.groups:
            return
        self.groups.add(tree)
        for data in _used_by(tree):
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
        for data in (tree, *dict.fromkeys(_used_within(tree))):
            _take_plain_name(data)


def _used_by(tree: bpy.types.NodeTree) -> Iterator[bpy.types.ID]:
    """Yield the texts of shaders, images of tables and groups that a group uses."""
    for node in tree.nodes:
        if node.type == "SCRIPT" and node.script is not None:
            yield node.script
        elif node.type == "TEX_IMAGE" and node.image is not None and TABLES in node.image:
            yield node.image
        elif node.type == "GROUP" and node.node_tree is not None:
            yield node.node_tree


def _used_within(tree: bpy.types.NodeTree) -> Iterator[bpy.types.ID]:
    """Yield the same of a group and of the groups within it."""
    for data in _used_by(tree):
        yield data
        if isinstance(data, bpy.types.NodeTree):
            yield from _used_within(data)


def _is_unused(data: bpy.types.ID) -> bool:
    """Return whether nothing uses a data-block but a fake user."""
    return data.users - data.use_fake_user == 0


def _remove_unused(found: Iterable[bpy.types.ID], remove: Callable[[bpy.types.ID], None]) -> None:
    """Remove those of some data-blocks that nothing uses."""
    for data in found:
        if _is_unused(data):
            remove(data)


def _take_plain_name(data: bpy.types.ID) -> None:
    """Name what is left of several copies as the first of them; Blender numbers it if that is still taken."""
    if data.name != _plain_name(data):
        data.name = _plain_name(data)


def _plain_name(data: bpy.types.ID) -> str:
    """Return the name of a data-block without the number that Blender gives a copy."""
    stem, _, number = data.name.rpartition(".")
    return stem if number.isdigit() else data.name


def merge_offset_groups() -> list[str]:
    """Let all modifiers that separate faces use one group; return what was changed, in sentences."""
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
