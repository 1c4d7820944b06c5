"""Reference renders that never change for one Blender: kept as means of tiles, so that they need not be rendered again.

A reference is looked up by all that is in its scene. One that is not there is rendered and kept; to make all anew, delete
``tests/references`` and run the tests on both Blenders.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import bpy
import numpy as np
from scenes import batches
from significance import tile_means

FOLDER = Path(__file__).parents[1] / "references"
DIGITS = 5
"""Significant digits of numbers in a scene; those beyond differ from machine to machine."""

_VARY = {"samples", "seed", "filepath", "sample_offset", "sample_subset_length", "use_persistent_data"}
"""Settings that say how often to look, not at what."""

_SIMPLE = {"BOOLEAN", "INT", "FLOAT", "ENUM", "STRING"}


def reference_batches(samples: int, count: int) -> np.ndarray:
    """`batches` of the current scene, which may hold nothing of ours, as means of tiles; (count, rows, columns, 3)."""
    return reference_tiles(lambda: batches(samples, count), samples, count)


def reference_tiles(render: Callable[[], np.ndarray], *parts: object) -> np.ndarray:
    """Means of tiles of the pictures that `render` makes of the current scene; `parts` say how."""
    assert not any(tree.name.startswith("Nested Dielectric") for tree in bpy.data.node_groups)
    words = [*map(repr, parts), *_scene()]
    name = hashlib.sha256("\n".join(words).encode()).hexdigest()[:16]
    file = FOLDER / ".".join(map(str, bpy.app.version[:2])) / f"{name}.npy"
    if file.is_file():
        return np.load(file).astype(np.float64)
    tiles = tile_means(render())
    file.parent.mkdir(parents=True, exist_ok=True)
    np.save(file, tiles.astype(np.float32))
    return tiles


def _scene() -> Iterator[str]:
    """Everything in the current scene that a picture may depend on, a line each."""
    scene = bpy.context.scene
    bpy.context.view_layer.update()
    for settings in (scene.render, scene.cycles):
        yield from _properties(settings)
    for obj in sorted(scene.objects, key=lambda obj: obj.name):
        yield f"{obj.name} {_rounded(np.array(obj.matrix_world))}"
        yield from _properties(obj.cycles)
        yield from _data(obj.data)
        for slot in obj.material_slots:
            yield from _tree(slot.material.node_tree)
    if scene.world is not None:
        yield from _properties(scene.world.cycles)
        yield from _tree(scene.world.node_tree)


def _data(data: bpy.types.ID) -> Iterator[str]:
    if not isinstance(data, bpy.types.Mesh):
        yield from _properties(data)
        if hasattr(data, "cycles"):
            yield from _properties(data.cycles)
        return
    # BMesh orders faces by where they lie in memory.
    yield from sorted(
        f"{_rounded((*face.center, *face.normal))} {len(face.vertices)} {face.use_smooth} {face.material_index}"
        for face in data.polygons
    )


def _tree(tree: bpy.types.NodeTree) -> Iterator[str]:
    for node in tree.nodes:
        yield from _properties(node)
        for socket in node.inputs:
            if hasattr(socket, "default_value"):
                yield f"{socket.name} {_rounded(socket.default_value)}"
    yield from (
        f"{link.from_node.name} {link.from_socket.name} {link.to_node.name} {link.to_socket.name}"
        for link in tree.links
    )


def _properties(owner: bpy.types.bpy_struct) -> Iterator[str]:
    for prop in owner.bl_rna.properties:
        if prop.type in _SIMPLE and prop.identifier not in _VARY and not prop.is_deprecated:
            if not prop.identifier.startswith(("session", "location")):
                yield f"{prop.identifier} {_rounded(getattr(owner, prop.identifier))}"


def _rounded(value: object) -> str:
    if isinstance(value, (str, int)):
        return str(value)
    if isinstance(value, (float, np.ndarray)) or (isinstance(value, Iterable) and not isinstance(value, (str, set))):
        numbers = np.asarray(value if isinstance(value, (float, np.ndarray)) else list(value), dtype=np.float64).ravel()
        return " ".join(f"{number + 0.0:.{DIGITS}g}" if abs(number) > 1e-6 else "0" for number in numbers)
    return str(sorted(value) if isinstance(value, set) else value)
