"""What an OSL shader makes of many points at once."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import bpy
import numpy as np
from scenes import add_camera, add_plane, new_scene, render

from nested_dielectric.model import shader_source
from nested_dielectric.nodes.osl import add_script, make_script

RESULT = "Result"
"""The output of a shader that :func:`evaluate` shows, a color."""


def source_of(text: str) -> str:
    """Return a shader's text with the extension's own headers in place."""
    with tempfile.TemporaryDirectory() as folder:
        for header in shader_source.OSL_FOLDER.glob("*.h"):
            shutil.copy(header, folder)
        Path(folder, "test.osl").write_text(text, encoding="utf-8")
        return shader_source.inlined_source("test.osl", Path(folder))


def script_material(text: str) -> bpy.types.Material:
    """Return a material that emits the color ``Result`` of a shader."""
    material = bpy.data.materials.new("Shader")
    tree = material.node_tree
    tree.nodes.clear()
    node = add_script(tree, "Shader", make_script("test.osl", source_of(text)), {}, {RESULT: "RGBA"})
    emission = tree.nodes.new("ShaderNodeEmission")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[RESULT], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material


def evaluate(text: str, width: int, height: int, build: Callable[[], object] | None = None) -> np.ndarray:
    """Evaluate a shader once a pixel, in its middle: (height, width, 3), the highest y first.

    P runs from 0 to 1 along x and from 0 to height / width along y; I is (0, 0, 1). ``build``
    adds more to the scene; the camera is at a height of 1.
    """
    scene = new_scene()
    scene.render.resolution_x, scene.render.resolution_y = width, height
    middle = (0.5, 0.5 * height / width, 0.0)
    add_plane("Plane", 2.0, middle, (0, 0, 1), script_material(text))
    add_camera((*middle[:2], 1.0), middle, width=1.0)
    if build is not None:
        build()
    return render(1)


def tiles(picture: np.ndarray, columns: int) -> np.ndarray:
    """Cut a picture into square tiles, the lowest row first; (tiles, pixels, 3)."""
    height, width, channels = picture.shape
    size = width // columns
    parts = picture[::-1].reshape(height // size, size, columns, size, channels)
    return parts.transpose(0, 2, 1, 3, 4).reshape(-1, size * size, channels)
