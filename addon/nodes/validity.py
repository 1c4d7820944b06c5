"""Nodes that find out whether what was stored of an analysis holds on the frame that is rendered."""

from __future__ import annotations

import bpy

from .identity import SCENE_PROPERTY
from .material_version import MATERIAL_VERSION
from .names import ANALYSED, FRAME_NODE, VERSION_PROPERTY
from .numbers import Number
from .shader_nodes import view_layer_attribute

FRAME_PATH, TIMED_FRAME_PATH = "frame_float", "frame_current"
"""Both are the number of the frame; by the other one the depsgraph knows that a material depends on it."""


def analysed_scene(tree: bpy.types.NodeTree) -> Number:
    """Return the number of the rendered scene if what its materials store of an analysis holds on this frame, else -1.

    Scripts may change a scene on every frame, and while the shutter is open: then it holds on the frame that was looked at,
    if nothing blurs. Simplify may change every shape.
    """
    number = Number(tree, view_layer_attribute(tree, f'["{SCENE_PROPERTY}"]').outputs["Fac"])
    validity = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(view_layer_attribute(tree, f'["{ANALYSED}"]').outputs["Color"], validity.inputs[0])
    analysed, frame, every_frame = (Number(tree, socket) for socket in validity.outputs)
    attributes = [
        view_layer_attribute(tree, path)
        for path in (FRAME_PATH, "render.use_motion_blur", "render.motion_blur_shutter", "render.use_simplify")
    ]
    attributes[0].name = FRAME_NODE
    frame_now, blurs, shutter, simplified = (Number(tree, node.outputs["Fac"]) for node in attributes)
    this_frame = frame_now.equals(frame)
    still = blurs * shutter < 1e-6
    moment = every_frame.math("MAXIMUM", this_frame * still)
    holds = moment * (analysed - simplified) > 0.5
    return holds * (number + 1.0) - 1.0


def evaluate_every_frame(follow: bool) -> None:
    """Let materials, with all objects that have them, be evaluated anew on each frame, or not.

    They have to be where what is stored of an analysis may not hold on other frames.
    """
    path = TIMED_FRAME_PATH if follow else FRAME_PATH
    for tree in bpy.data.node_groups:
        if tree.get(VERSION_PROPERTY) == MATERIAL_VERSION and tree.is_editable and (node := tree.nodes.get(FRAME_NODE)):
            if node.attribute_name in (FRAME_PATH, TIMED_FRAME_PATH) and node.attribute_name != path:
                node.attribute_name = path
