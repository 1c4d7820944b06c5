"""Making the open file whole: what it links from other files becomes its own, and what it shows of them is packed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import bpy


def make_local() -> list[str]:
    """Make all linked data the open file's own, library overrides too; return what was done, in sentences.

    What a library lacks stays linked: :mod:`nested_dielectric.farm.outside` names it.
    """
    linked: set[bpy.types.ID] = set()
    while linked != (linked := _linked_data()):
        users = bpy.data.user_map(subset=linked)
        # What others linked use, too, would be copied, and they would go on using what is linked.
        first = [data for data in linked if not any(user in linked for user in users[data] - {data})]
        for data in first or list(linked)[:1]:
            data.make_local()
    for data in list(bpy.data.user_map()):
        if data.override_library is not None:
            data.make_local()
    left = {data.library for data in bpy.data.user_map()} - {None}
    left |= {library.archive_parent_library for library in left}
    # Those that are packed, and so in the file already, go with the one that they come from.
    done = [library for library in bpy.data.libraries if library not in left and not library.is_archive]
    changes = [f"{library.filepath}: its data are the file's own now" for library in done]
    for library in done:
        bpy.data.libraries.remove(library)
    return changes


def _linked_data() -> set[bpy.types.ID]:
    """Return all data of the open file that are linked and there."""
    return {data for data in bpy.data.user_map() if data.library is not None and not data.is_missing}


def pack_files() -> list[str]:
    """Pack all that Blender can pack into the open file; return what was packed, in sentences."""
    changes = [f"{material}: the light distribution {name} is in the file" for material, name in _take_in_photometry()]
    before = _packed()
    with suppress(RuntimeError):  # files that are missing, which Blender names after it has packed all others
        bpy.ops.file.pack_all()
    names = sorted(data.name for data in _packed() - before)
    return changes + [f"{name}: its file is packed" for name in names]


def _packed() -> set[bpy.types.ID]:
    """Return all data with a file that is packed, from which it is shown: not volumes, which Blender packs and then misses."""
    owners = (bpy.data.images, bpy.data.fonts, bpy.data.sounds)
    return {data for each in owners for data in each if data.packed_file is not None}


def _take_in_photometry() -> Iterator[tuple[str, str]]:
    """Take light distributions of IES files into texts; yield whose nodes they belong to, and their names."""
    for owner, tree in shader_trees():
        for node in tree.nodes:
            if node.type != "TEX_IES" or node.mode != "EXTERNAL" or not node.filepath:
                continue
            path = Path(bpy.path.abspath(node.filepath))
            with suppress(OSError):
                lines = path.read_text(encoding="latin-1")
                text = bpy.data.texts.new(path.name)
                text.from_string(lines)
                node.mode, node.ies = "INTERNAL", text
                yield owner.name, path.name


def shader_trees() -> Iterator[tuple[bpy.types.ID, bpy.types.NodeTree]]:
    """Yield the open file's trees of shader nodes, each with the data that it stands in."""
    for each in (bpy.data.materials, bpy.data.worlds, bpy.data.lights):
        yield from ((data, data.node_tree) for data in each if data.node_tree is not None)
    yield from ((tree, tree) for tree in bpy.data.node_groups if tree.bl_idname == "ShaderNodeTree")
