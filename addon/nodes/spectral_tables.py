"""The spectral tables that a material's group reads."""

from __future__ import annotations

import bpy
import numpy as np

from ..model.dispersion import mean_inverse_square_offsets
from .names import COORDINATE_NODE, MEANS_SOCKET, ROW_OUTPUT, TABLE_SOCKET, TABLES_NODE
from .osl import Script, add_script
from .shader_nodes import view_layer_attribute
from .spectral_images import ensure_row, holds, read_rows


def table_row(tree: bpy.types.NodeTree, table: np.ndarray) -> int:
    """Return the row of a spectral table in the group's image, where it is put on first use."""
    node = tree.nodes[TABLES_NODE]
    node.image, row = ensure_row(node.image, table)
    tree.nodes[COORDINATE_NODE].inputs["Tables"].default_value = node.image.size[1]
    return row


def uses_table(node: bpy.types.ShaderNodeGroup, table: np.ndarray) -> bool:
    """Return whether a material's group node uses this very spectral table."""
    image = node.node_tree.nodes[TABLES_NODE].image
    row = node.inputs[TABLE_SOCKET].default_value
    count = node.node_tree.nodes[COORDINATE_NODE].inputs["Tables"].default_value
    means = np.float32(mean_inverse_square_offsets(table))
    return (
        holds(image, row, table)
        and count == image.size[1]
        and np.array_equal(np.float32(node.inputs[MEANS_SOCKET].default_value), means)
    )


def table_of(node: bpy.types.ShaderNodeGroup) -> np.ndarray | None:
    """Return the spectral table that a material's group node uses, or None if its file has lost it."""
    holder = node.node_tree.nodes.get(TABLES_NODE)
    rows = read_rows(getattr(holder, "image", None))
    if rows is None or TABLE_SOCKET not in node.inputs:
        return None
    return rows[min(max(node.inputs[TABLE_SOCKET].default_value, 0), len(rows) - 1)]


def set_table(node: bpy.types.ShaderNodeGroup, table: np.ndarray) -> None:
    """Make a material's group node use a spectral table."""
    node.inputs[TABLE_SOCKET].default_value = table_row(node.node_tree, table)
    node.inputs[MEANS_SOCKET].default_value = mean_inverse_square_offsets(table)


def add_table_image(
    tree: bpy.types.NodeTree, table: bpy.types.NodeSocket, script: Script
) -> bpy.types.ShaderNodeTexImage:
    """Add the image of spectral tables, read where the path's wavelength stands in it.

    Linear interpolation makes the spectrum continuous and keeps every table's mean, because the edges are extended.
    """
    nodes, links = tree.nodes, tree.links
    shutter = view_layer_attribute(tree, "render.motion_blur_shutter")
    coordinate = add_script(
        tree,
        COORDINATE_NODE,
        script,
        {"Table": "INT", "Tables": "INT", "Shutter": "COLOR"},
        {"Coordinate": "VECTOR", ROW_OUTPUT: "INT"},
    )
    links.new(table, coordinate.inputs["Table"])
    links.new(shutter.outputs["Color"], coordinate.inputs["Shutter"])
    image = nodes.new("ShaderNodeTexImage")
    image.name = image.label = TABLES_NODE
    image.interpolation = "Linear"
    image.extension = "EXTEND"
    links.new(coordinate.outputs["Coordinate"], image.inputs["Vector"])
    return image
