"""Hierarchies of boxes, and which boxes of two hierarchies overlap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .numbering import NO_FACES

# Children of each box.
BRANCHING = 8

# The first tree of a hierarchy, where it has but one.
FIRST_TREE = np.zeros(1, dtype=np.intp)


@dataclass(frozen=True, eq=False)
class BoxHierarchy:
    """Trees of ever larger boxes, all of one depth.

    :param bounds: (6, n) lowest coordinates of the smallest boxes and highest ones negated, neighbours in space one after
        the other, one tree's after the other's.
    :param starts: (trees + 1,) first box of each tree, and the number of all.
    """

    bounds: np.ndarray
    starts: np.ndarray

    @cached_property
    def _built(self) -> tuple[list[np.ndarray], list[np.ndarray | None], np.ndarray, np.ndarray]:
        """Build the levels, groups, items and tops: each level joins the boxes of the one below by groups."""
        counts, bounds = np.diff(self.starts), self.bounds
        single = len(counts) == 1
        levels: list[np.ndarray] = []
        groups: list[np.ndarray | None] = [None]
        while True:
            room = counts + -counts % BRANCHING
            starts = np.concatenate([[0], np.cumsum(room)])
            places = np.arange(len(bounds[0])) + np.repeat(starts[:-1] - np.cumsum(counts) + counts, counts)
            if single and bounds.base is not None and bounds.base.shape == (6, starts[-1]):
                level = bounds.base
            else:
                level = np.full((6, starts[-1]), np.inf)
                level[:, slice(len(places)) if single else places] = bounds
            if not levels:
                items = np.full(starts[-1], -1)
                items[places] = np.arange(len(places))
            elif single:
                groups.append(None)
            else:
                group = np.zeros(starts[-1], dtype=np.intp)
                group[places] = np.arange(len(places))
                groups.append(group)
            levels.append(level)
            if counts.max() <= 1:
                return levels, groups, items, starts[:-1]
            counts, bounds = room // BRANCHING, _parent_boxes(level)

    @property
    def levels(self) -> list[np.ndarray]:
        """Return (6, count) boxes, then those of every BRANCHING of them, and so on.

        Those of each tree are filled up to whole groups with boxes that nothing meets.
        """
        return self._built[0]

    @property
    def groups(self) -> list[np.ndarray | None]:
        """Return the group of the level below that each box of a level holds; None where both have the same number.

        The first level, which holds nothing, has None.
        """
        return self._built[1]

    @property
    def items(self) -> np.ndarray:
        """Return the place in the bounds of every box of the first level."""
        return self._built[2]

    @property
    def tops(self) -> np.ndarray:
        """Return the box of the last level that holds all of each tree, (trees,)."""
        return self._built[3]


def padded_boxes(count: int) -> np.ndarray:
    """Return (6, count) room for boxes: the first columns of an array of whole groups of boxes that nothing meets."""
    return np.full((6, count + -count % BRANCHING), np.inf)[:, :count]


def _parent_boxes(level: np.ndarray) -> np.ndarray:
    """Return the boxes that hold the groups of a level."""
    children = np.moveaxis(level.reshape(6, -1, BRANCHING), 2, 0)
    joined = padded_boxes(children.shape[2])
    np.minimum(children[0], children[1], out=joined)
    for child in children[2:]:
        np.minimum(joined, child, out=joined)
    return joined


def overlapping_leaves(
    a: BoxHierarchy, b: BoxHierarchy, tolerance: float, first: np.ndarray = FIRST_TREE, second: np.ndarray = FIRST_TREE
) -> tuple[np.ndarray, np.ndarray]:
    """Find the smallest boxes in pairs of trees that are no farther apart than the tolerance along each axis.

    :param first: (n,) the tree of a for each pair of trees; second: that of b.
    :return: two arrays with the places of boxes in the bounds of a and b.
    """
    depth = [len(a.levels) - 1, len(b.levels) - 1]
    i, j = _overlapping(a.levels[-1], a.tops.take(first), b.levels[-1], b.tops.take(second), tolerance)
    while any(depth) and len(i):
        if depth[0] >= depth[1]:
            depth[0] -= 1
            i, j = _overlapping_children(a, depth[0], i, b.levels[depth[1]], j, tolerance)
        else:
            depth[1] -= 1
            j, i = _overlapping_children(b, depth[1], j, a.levels[depth[0]], i, tolerance)
    if any(depth):
        return NO_FACES, NO_FACES
    return a.items.take(i), b.items.take(j)


def leaves_in_boxes(
    tree: BoxHierarchy, trees: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Find the smallest boxes of trees that meet some boxes.

    :param trees: (n,) the tree for each box; low, high: (3, n) the boxes.
    :return: two arrays: places among the n boxes, and of what meets them in the bounds of the tree.
    """
    boxes = np.concatenate([low, -high])
    node, box = _overlapping(tree.levels[-1], tree.tops.take(trees), boxes, np.arange(len(trees)), 0.0)
    for level in reversed(range(len(tree.levels) - 1)):
        node, box = _overlapping_children(tree, level, node, boxes, box, 0.0)
    return box, tree.items.take(node)


def _overlapping(
    a: np.ndarray, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: float, axes: Sequence[int] = (0, 1, 2)
) -> tuple[np.ndarray, np.ndarray]:
    """Keep the pairs of places i, j in two arrays of bounds whose boxes meet."""
    for axis in axes:
        meet = a[axis].take(i) + b[axis + 3].take(j) <= tolerance
        meet &= b[axis].take(j) + a[axis + 3].take(i) <= tolerance
        meet = np.flatnonzero(meet)
        i, j = i.take(meet), j.take(meet)
    return i, j


def _overlapping_children(
    tree: BoxHierarchy, level: int, i: np.ndarray, b: np.ndarray, j: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Find which children of boxes i of a tree meet boxes j in an array of bounds.

    :param level: the tree's level of the children.
    """
    if tree.groups[level + 1] is not None:
        i = tree.groups[level + 1].take(i)
    a = tree.levels[level]
    # Children stand side by side, so along one axis they are read by the group.
    groups = a.reshape(6, -1, BRANCHING)
    meet = groups[0].take(i, axis=0) + b[3].take(j)[:, None] <= tolerance
    meet &= b[0].take(j)[:, None] + groups[3].take(i, axis=0) <= tolerance
    found = np.flatnonzero(meet)
    pair = found // BRANCHING
    return _overlapping(a, (i.take(pair) - pair) * BRANCHING + found, b, j.take(pair), tolerance, (1, 2))


def morton_order(points: np.ndarray) -> np.ndarray:
    """Return the order of (3, k) points along a curve that fills space.

    Morton 1966, A computer oriented geodetic data base.
    """
    code = np.zeros(points.shape[1], dtype=np.int64)
    for axis, place in enumerate(points):
        low = place.min()
        bits = ((place - low) * (1023.0 / max(float(place.max() - low), 1e-300))).astype(np.int64)
        for shift, mask in ((16, 0x30000FF), (8, 0x300F00F), (4, 0x30C30C3), (2, 0x9249249)):
            bits = (bits | (bits << shift)) & mask
        code |= bits << axis
    return np.argsort(code)
