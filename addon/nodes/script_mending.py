"""Repairs of Script nodes whose bytecode was emptied or changed: Cycles ends Blender when it renders one that holds nothing."""

from __future__ import annotations

import hashlib

import bpy

from ..model.shader_source import inlined_source
from .compatibility import UnsupportedError
from .material_version import MATERIAL_VERSION
from .names import COORDINATE_NODE, LIGHTS_VERSION_PROPERTY, MASK_OUTPUT, SHADER_NODE, VERSION_PROPERTY
from .osl import COORDINATE_FILE, LIGHT_FILE, MASK_FILE, SHADER_FILE, compiled, set_bytecode

FILES = {SHADER_NODE: SHADER_FILE, COORDINATE_NODE: COORDINATE_FILE, MASK_OUTPUT: MASK_FILE}
"""Shaders by the names of nodes; those of lights have other names."""


def mend_scripts() -> list[str]:
    """Compile anew what Script nodes of the file's own groups have lost; return what was changed, in sentences.

    A group of this version gets the extension's source, another one what stands in the file. Where there is none, or this
    Blender compiles no OSL, the node is emptied so that it shows magenta.
    """
    changes = []
    for tree in bpy.data.node_groups:
        version = tree.get(VERSION_PROPERTY, tree.get(LIGHTS_VERSION_PROPERTY))
        if version is None or not tree.is_editable or tree.library is not None:
            continue
        for node in tree.nodes:
            if node.type == "SCRIPT" and node.mode == "INTERNAL" and not _is_sound(node):
                _mend(node, version)
                how = "compiled again" if node.bytecode else "lost for good"
                changes.append(f"{tree.name}: the shader of {node.name!r} was damaged and is {how}")
    return changes


def _is_sound(node: bpy.types.ShaderNodeScript) -> bool:
    """Return whether a node holds the bytecode that its hash is of, or neither."""
    bytecode = node.bytecode
    if not bytecode:
        return not node.bytecode_hash
    return hashlib.md5(bytecode.encode(), usedforsecurity=False).hexdigest() == node.bytecode_hash


def _mend(node: bpy.types.ShaderNodeScript, version: int) -> None:
    """Compile a node's shader, or empty the node."""
    if version == MATERIAL_VERSION:
        source = inlined_source(FILES.get(node.name, LIGHT_FILE))
    else:
        source = node.script.as_string() if node.script is not None else ""
    try:
        set_bytecode(node, compiled(source) if source.strip() else "")
    except UnsupportedError:
        set_bytecode(node, "")
