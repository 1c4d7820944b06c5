"""Whether groups of nodes are as the extension made them: nobody has taken anything out of them, or put anything in."""

from __future__ import annotations

import bpy

from .names import LIGHTS_NAME, WHOLE


def mark_whole(tree: bpy.types.NodeTree) -> None:
    """Note how much a group holds that has just been made, and each group within it.

    The group of lights is left out: it holds other nodes with every scene, and is looked at where lights are listed.
    """
    inner = {
        node.name: node.node_tree
        for node in tree.nodes
        if node.bl_idname.endswith("NodeGroup") and node.name != LIGHTS_NAME
    }
    for each in dict.fromkeys(inner.values()):
        if WHOLE not in each:
            mark_whole(each)
    tree[WHOLE] = "\n".join((f"{_version():04d}", _census(tree), *inner))


def is_whole(tree: bpy.types.NodeTree | None) -> bool:
    """Return whether a group holds as many nodes, links and sockets as when it was made, and so do the groups within it.

    To count is quick, however many there are. A Blender that is older than the one that made the group drops links into sockets
    that came later, so there links may be missing.
    """
    mark = None if tree is None else tree.get(WHOLE)
    if not isinstance(mark, str):
        return False
    made_by, census, *inner = (*mark.split("\n"), "", "")
    drops_links = made_by > f"{_version():04d}"
    if _without_links(census) != _without_links(_census(tree)) if drops_links else census != _census(tree):
        return False
    nodes = map(tree.nodes.get, filter(None, inner))
    return all(node is not None and is_whole(getattr(node, "node_tree", None)) for node in nodes)


def _census(tree: bpy.types.NodeTree) -> str:
    """Return the numbers of nodes, sockets and links of a group."""
    return f"{len(tree.nodes)} {len(tree.interface.items_tree)} {len(tree.links)}"


def _version() -> int:
    """Return the number of this Blender, such as 503."""
    return 100 * bpy.app.version[0] + bpy.app.version[1]


def _without_links(census: str) -> str:
    return census.rpartition(" ")[0]
