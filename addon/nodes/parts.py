"""Groups of shader nodes that other groups are made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from math import e

import bpy

from .numbers import Number
from .shader_nodes import SOCKET_TYPES, Socket, lazily, mix_shaders, mix_values, plug, vector_math


class Part:
    """A group of nodes within another one, whose inputs are made where they are first asked for.

    Small trees are built far faster than large ones: Blender looks at all of a tree after each link.
    """

    def __init__(self, name: str, kinds: Mapping[str, str]) -> None:
        """Begin a group, whose leading dot hides it from menus; `kinds` holds the kinds of all that it may ask for, by name."""
        self.tree = bpy.data.node_groups.new(f".{name}", "ShaderNodeTree")
        self.kinds = kinds
        self.start = self.tree.nodes.new("NodeGroupInput")
        self.end = self.tree.nodes.new("NodeGroupOutput")
        self.known: dict[str, Socket] = {}
        self.inputs: list[str] = []
        self.vector = partial(vector_math, self.tree)
        self.node = self.tree.nodes.new

    def socket(self, name: str) -> Socket:
        """Return what a name stands for in this group: one of its inputs, or what was defined here."""
        if name not in self.known:
            self.tree.interface.new_socket(name, in_out="INPUT", socket_type=SOCKET_TYPES[self.kinds[name]])
            self.inputs.append(name)
            self.known[name] = self.start.outputs[name]
        return self.known[name]

    def raw(self, name: str) -> Number:
        """Return the number of a name as it is."""
        return Number(self.tree, self.socket(name))

    def define(self, name: str, value: Number | Socket) -> None:
        """Let a name stand for a value, in this group and those within it."""
        self.known[name] = value.socket if isinstance(value, Number) else value

    def add_output(self, name: str, kind: str, value: Number | Socket) -> None:
        """Add an output, and link a value into it."""
        self.tree.interface.new_socket(name, in_out="OUTPUT", socket_type=SOCKET_TYPES[kind])
        self.tree.links.new(value.socket if isinstance(value, Number) else value, self.end.inputs[name])

    def call(self, part: Part, **given: Number | Socket | float) -> dict[str, Socket]:
        """Add another group within this one, and return its outputs; what is not given means there what it means here."""
        node = self.node("ShaderNodeGroup")
        node.node_tree = part.tree
        for name in part.inputs:
            value = given[name] if name in given else self.socket(name)
            plug(self.tree, value.socket if isinstance(value, Number) else value, node.inputs[name])
        return dict(zip((socket.name for socket in node.outputs), node.outputs))

    def mix(self, factor: Number, first: Socket | None, second: Socket | None) -> Socket:
        """Return one of two shaders, or both, as a factor has it."""
        return mix_shaders(self.tree, factor.socket, first, second)

    def add(self, first: Socket | None, second: Socket | None) -> Socket:
        """Return the sum of two shaders."""
        node = self.node("ShaderNodeAddShader")
        for source, socket in zip((first, second), node.inputs):
            if source is not None:
                self.tree.links.new(source, socket)
        return node.outputs[0]

    def choose(self, condition: Number, otherwise: Number | float, chosen: Number | float) -> Number:
        """Return one of two numbers, as a condition has it that may differ from hit to hit."""
        values = (each.socket if isinstance(each, Number) else each for each in (otherwise, chosen))
        return Number(self.tree, mix_values(self.tree, "FLOAT", condition.socket, *values))

    def choose_vector(self, condition: Number, otherwise: Socket, chosen: Socket) -> Socket:
        """Return one of two vectors, as a condition has it that may differ from hit to hit."""
        return mix_values(self.tree, "VECTOR", condition.socket, otherwise, chosen)

    def surely(self, condition: Number) -> Number:
        """Return 1 where a condition holds and follows from unlinked sockets."""
        return Number(self.tree, lazily(self.tree, "INT", condition.socket, 0, 1))

    def where(self, condition: Number, otherwise: Number | float, chosen: Number | float) -> Number:
        """Return one of two numbers, of which the other is left out; see :func:`lazily`."""
        values = (each.socket if isinstance(each, Number) else each for each in (otherwise, chosen))
        return Number(self.tree, lazily(self.tree, "FLOAT", condition.socket, *values))

    def split(self, value: Socket, names: Sequence[str] = ("x", "y", "z"), node: str = "XYZ") -> dict[str, Number]:
        """Return the components of a vector, or of a colour."""
        separate = self.node(f"ShaderNodeSeparate{node}")
        self.tree.links.new(value, separate.inputs[0])
        return {name: Number(self.tree, socket) for name, socket in zip(names, separate.outputs)}

    def join(self, components: Sequence[Number | float]) -> Socket:
        """Return a vector of three numbers."""
        combine = self.node("ShaderNodeCombineXYZ")
        for component, socket in zip(components, combine.inputs):
            plug(self.tree, component.socket if isinstance(component, Number) else component, socket)
        return combine.outputs[0]

    def dot(self, first: Socket, second: Socket) -> Number:
        """Return the dot product of two vectors."""
        return Number(self.tree, self.vector("DOT_PRODUCT", first, second))

    def length(self, vector: Socket) -> Number:
        """Return the length of a vector."""
        return Number(self.tree, self.vector("LENGTH", vector))

    def scaled(self, vector: Socket, factor: Number | float) -> Socket:
        """Return a vector times a number."""
        return self.vector("SCALE", vector, factor.socket if isinstance(factor, Number) else factor)

    def exponential(self, exponents: Socket) -> Socket:
        """Return e to the power of each component."""
        return self.vector("POWER", (e, e, e), exponents)
