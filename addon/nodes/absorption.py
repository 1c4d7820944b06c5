"""Absorption by Cycles' own volume."""

from __future__ import annotations

from math import e

import bpy

from ..model.contract import LEAST_TRANSMITTANCE
from ..model.parameters import BY_KEYWORD
from .numbers import Number
from .shader_nodes import Socket, mix_shaders


def absorption_coefficients(tree: bpy.types.NodeTree, inputs: bpy.types.Node) -> tuple[Socket, Number]:
    """Return what the medium absorbs per length (Beer 1852), and whether it absorbs at all (0 or 1).

    They are not those of :class:`~nested_dielectric.nodes.native.coefficients.Coefficients`: a volume takes no colour darker
    than ``LEAST_TRANSMITTANCE``, and needs no value where there is no depth.
    """
    separate = tree.nodes.new("ShaderNodeSeparateColor")
    tree.links.new(inputs.outputs["Transmittance"], separate.inputs[0])
    red, green, blue = (Number(tree, socket) for socket in separate.outputs)
    total = red + green + blue
    low, high, default = BY_KEYWORD["transmittance"].limits
    channels = [channel.bounded((low, high, own), number=total) for channel, own in zip((red, green, blue), default)]
    depth = Number(tree, inputs.outputs["Transmittance Depth"]).bounded(BY_KEYWORD["transmittance_depth"].limits)
    coefficients = tree.nodes.new("ShaderNodeCombineXYZ")
    for channel, coefficient in zip(channels, coefficients.inputs):
        decay = channel.math("MAXIMUM", LEAST_TRANSMITTANCE).math("LOGARITHM", e) * -1.0
        tree.links.new((decay / depth).socket, coefficient)
    red, green, blue = channels
    least = red.math("MINIMUM", green).math("MINIMUM", blue)
    return coefficients.outputs[0], (least < 1.0) * (depth > 0.0)


def absorption_volume(
    tree: bpy.types.NodeTree, coefficients: Socket, absorbs: Number, by_volume: Number, of_shadows: Number
) -> Socket:
    """Return Cycles' own volume that absorbs: of all rays where `by_volume` is 1 (see :mod:`charging`).

    Elsewhere it absorbs of rays that start at the camera or at a foreign object, whose way may meet no surface of a medium, and
    of shadow rays where the native body cannot. The surface, which knows who wins, charges all other rays. Where nothing is
    absorbed the mix is folded away, and Cycles sees no volume.
    """
    path = tree.nodes.new("ShaderNodeLightPath")
    camera, diffuse, shadow = (Number(tree, path.outputs[f"Is {kind} Ray"]) for kind in ("Camera", "Diffuse", "Shadow"))
    charged = tree.nodes.new("ShaderNodeVectorMath")
    charged.operation = "SCALE"
    tree.links.new(coefficients, charged.inputs[0])
    # Folds to 1, and no light path is asked, where the volume absorbs for all rays.
    straight = (camera + diffuse).math("MAXIMUM", shadow * of_shadows)
    elsewhere = straight * (1.0 - by_volume)
    tree.links.new((elsewhere + by_volume).socket, charged.inputs["Scale"])
    volume = tree.nodes.new("ShaderNodeVolumeCoefficients")
    volume.inputs["Scatter Coefficients"].default_value = (0.0, 0.0, 0.0)
    tree.links.new(charged.outputs[0], volume.inputs["Absorption Coefficients"])
    return mix_shaders(tree, absorbs.socket, None, volume.outputs[0])
