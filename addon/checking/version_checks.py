"""Checks of the versions of materials, and of the groups in them."""

from __future__ import annotations

import bpy

from ..nodes.compatibility import takes_front_ior
from ..nodes.material_version import DAMAGED, FRONT_IOR_VERSION, MATERIAL_VERSION, group_version
from ..scene.materials import dielectric_node
from .finding import Finding
from .inspection import Inspection
from .kinds import VERSION


def version_findings(_: Inspection) -> list[Finding]:
    """Return what is wrong with the versions of materials and cannot be changed here."""
    return version_problems()


def version_problems() -> list[Finding]:
    """Return what is wrong with the versions of materials and cannot be changed here."""
    newer = {tree for tree in bpy.data.node_groups if (group_version(tree) or 0) > MATERIAL_VERSION}
    wrong = {tree for tree in bpy.data.node_groups if tree.library is not None and is_wrong_here(tree)}
    problems = []
    for material in bpy.data.materials if newer or wrong else ():
        node = dielectric_node(material)
        tree = None if node is None else node.node_tree
        if tree in newer:
            problems.append(
                Finding(VERSION, material.name, "was made by a newer version", "install that version of the extension")
            )
        elif tree in wrong and material.library is not None:
            remedy = f"press Update Materials in {material.library.filepath!r} and save it"
            damaged = group_version(tree) == DAMAGED
            how = "in which its node group is damaged" if damaged else "of an older version, which is wrong here"
            problems.append(Finding(VERSION, material.name, f"comes from a file {how}", remedy))
    return problems


def is_wrong_here(tree: bpy.types.NodeTree) -> bool:
    """Return whether a group is damaged, or of a version that this Blender renders wrong."""
    version = group_version(tree)
    return version == DAMAGED or (version is not None and version < FRONT_IOR_VERSION and bool(takes_front_ior()))
