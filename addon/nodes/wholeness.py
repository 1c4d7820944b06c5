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
    tree[WHOLE] = "\n".join((_census(tree), *inner))


def is_whole(tree: bpy.types.NodeTree | None) -> bool:
    """Return whether a group holds as many nodes, links and sockets as when it was made, and so do the groups within it.

    To count is quick, however many there are.
    """
    mark = None if tree is None else tree.get(WHOLE)
    if not isinstance(mark, str):
        return False
    census, *inner = mark.split("\n")
    if census != _census(tree):
        return False
    nodes = map(tree.nodes.get, inner)
    return all(node is not None and is_whole(getattr(node, "node_tree", None)) for node in nodes)


def _census(tree: bpy.types.NodeTree) -> str:
    """Return the numbers of nodes, links and sockets of a group."""
    return f"{len(tree.nodes)} {len(tree.links)} {len(tree.interface.items_tree)}"
