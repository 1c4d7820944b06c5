"""Geometry Nodes that cut the surfaces of media where they cross, so that every face lies between two known media.

One object holds the whole cut: its modifier reads all media, in layers of one priority and one material each, the strongest
first. What the union of the stronger ones leaves of a layer is bounded by the layer's own faces and by theirs, and outside the
latter is that layer: so each of them is found once, with what lies outside. The union of all layers has the faces in air. For
each medium an object picks its own faces.

Nothing here knows the extension: a file that is rendered without it evaluates the same.
"""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...model.contract import (
    BY_VOLUME_SOCKET,
    CUT,
    CUT_AIR,
    CUT_BY_VOLUME,
    CUT_CURVE,
    CUT_DEPTH,
    CUT_HIDDEN,
    CUT_LIKE_AIR,
    CUT_PRIORITY,
    CUT_SELLMEIER_B,
    CUT_SELLMEIER_C,
    CUT_SPLITS,
    CUT_TINT,
)
from .bodies import numbered, read_bodies, united_where_they_meet
from .builder import GEOMETRY, Builder, new_tree
from .names import BODY, CUT_GROUP
from .plan import HIDDEN, VALUES, Plan, enclosing_layers, value_name, values_of


def make_cut_tree(plan: Plan) -> bpy.types.NodeTree:
    """Make the group that cuts; it returns instances, one a medium, with its number and its faces."""
    inputs = {
        value_name(name, place): VALUES[name]
        for place in sorted(enclosing_layers(plan))
        for name in values_of(plan.layers[place])
    }
    tree = new_tree(CUT_GROUP, inputs, GEOMETRY, "Surfaces of media, cut where they cross")
    tree.is_modifier = True
    build = Builder(tree)
    numbers = plan.numbers()
    whole: list[bpy.types.NodeSocket] = []
    closed: list[bpy.types.NodeSocket] = []
    pieces: list[bpy.types.NodeSocket] = []
    layers: dict[int, bpy.types.NodeSocket] = {}
    for place, layer in enumerate(plan.layers):
        if layer.crossing:
            crossing = [(obj, numbers[obj]) for obj in layer.crossing]
            geometries, sound = read_bodies(build, plan, crossing, layer.overlapping)
            closed += sound
            whole += geometries
            layers[place] = united_where_they_meet(build, geometries) if layer.overlapping else build.joined(geometries)
        for around in sorted({around for _, around in layer.constant}, key=str):
            alike = [(obj, numbers[obj]) for obj, other in layer.constant if other == around]
            geometries, sound = read_bodies(build, plan, alike)
            closed += sound
            whole += geometries
            pieces.append(_with_exterior(build, plan, build.joined(geometries), around))
    if layers:
        pieces += _cut(build, plan, layers, numbers)
    cut = build.joined(pieces)
    raw = build.joined(whole)
    shown = build.switch(_is_sound(build, closed, cut, raw), raw, cut)
    split = build.node("GeometryNodeSplitToInstances", properties={"domain": "FACE"})
    build.put(split.inputs[0], shown)
    build.put(split.inputs["Group ID"], build.attribute(BODY, "INT"))
    instances = build.stored(split.outputs["Instances"], BODY, split.outputs["Group ID"], "INT", "INSTANCE")
    build.returns(Geometry=instances)
    return tree


def _is_sound(build: Builder, closed: Sequence[bpy.types.NodeSocket], cut, raw) -> bpy.types.NodeSocket:
    """Return whether everything was closed, and the solver has returned something of it; else the media are left uncut."""
    some = build.compare(build.face_count(cut), "GREATER_THAN", 0)
    none = build.compare(build.face_count(raw), "EQUAL", 0)
    return build.all_of([*closed, build.all_of((some, none), "OR")])


def _cut(
    build: Builder, plan: Plan, layers: dict[int, bpy.types.NodeSocket], numbers: dict[bpy.types.Object, int]
) -> list[bpy.types.NodeSocket]:
    """Return the faces of the layers that cross, each with what lies outside it."""
    boxes = {place: build.box(geometry) for place, geometry in layers.items()} if plan.may_part else {}
    pieces = []
    winners = None
    for place, geometry in layers.items():
        stronger = [other for other in layers if (other, place) in plan.pairs]
        if not stronger:
            winners = geometry if winners is None else build.joined([winners, geometry])
            continue
        first = numbers[plan.layers[place].bodies[0]]
        end = first + len(plan.layers[place].bodies)
        left = build.less(geometry, winners)
        found = [_with_exterior(build, plan, build.flipped(numbered(build, left, 0, first)), place)]
        is_last = place == max(layers)
        cut = build.less(winners, geometry) if is_last or plan.layers[place].keeps_hidden_faces else None
        if plan.layers[place].keeps_hidden_faces:
            found.append(_with_exterior(build, plan, build.flipped(numbered(build, cut, first, end)), HIDDEN))
        # What wins over nothing needs no union: the solver's time goes by what it returns.
        union = (
            build.joined([numbered(build, left, first, end), numbered(build, cut, 0, first)])
            if is_last
            else build.united(winners, geometry)
        )
        found = build.joined(found)
        if plan.may_part:
            meets = build.all_of([build.meet(boxes[other], boxes[place]) for other in stronger], "OR")
            found = build.switch(meets, None, found)
            union = build.switch(meets, build.joined([winners, geometry]), union)
        pieces.append(found)
        winners = union
    return [*pieces, _with_exterior(build, plan, winners, None)]


def _with_exterior(build: Builder, plan: Plan, geometry, around: int | None) -> bpy.types.NodeSocket:
    """Store in faces what lies outside them: a layer, air (None) or a winner (HIDDEN)."""
    if around is None or around == HIDDEN:
        return build.stored(geometry, CUT, CUT_AIR if around is None else CUT_HIDDEN, "FLOAT")
    layer = plan.layers[around]
    inputs = {name: build.inputs.outputs[value_name(name, around)] for name in values_of(layer)}
    index = build.switch(build.compare(inputs["IOR"], "EQUAL", CUT_AIR, "FLOAT"), inputs["IOR"], CUT_LIKE_AIR, "FLOAT")
    if layer.needs_all_values:
        negative = build.node("ShaderNodeMath", properties={"operation": "MULTIPLY"})
        build.put(negative.inputs[0], index)
        negative.inputs[1].default_value = -1.0
        index = negative.outputs[0]
    geometry = build.stored(geometry, CUT, index, "FLOAT")
    geometry = build.stored(geometry, CUT_PRIORITY, float(layer.priority), "FLOAT")
    if not layer.needs_all_values:
        return geometry
    geometry = build.stored(geometry, CUT_TINT, inputs["Transmittance"], "FLOAT_COLOR")
    geometry = build.stored(geometry, CUT_DEPTH, inputs["Transmittance Depth"], "FLOAT")
    geometry = build.stored(geometry, CUT_BY_VOLUME, inputs[BY_VOLUME_SOCKET], "FLOAT")
    curve = build.node("ShaderNodeCombineXYZ", X=_model(build, inputs), Y=inputs["Abbe"], Z=inputs["Dispersion"])
    geometry = build.stored(geometry, CUT_CURVE, curve.outputs[0], "FLOAT_VECTOR")
    geometry = build.stored(geometry, CUT_SELLMEIER_B, inputs["Sellmeier B"], "FLOAT_VECTOR")
    return build.stored(geometry, CUT_SELLMEIER_C, inputs["Sellmeier C"], "FLOAT_VECTOR")


def _model(build: Builder, inputs: dict[str, bpy.types.NodeSocket]) -> bpy.types.NodeSocket:
    """Return the number of the dispersion's model, higher by the count of models where the medium splits light itself."""
    node = build.node("ShaderNodeMath", properties={"operation": "MULTIPLY_ADD"})
    build.put(node.inputs[0], inputs["Disperse"])
    node.inputs[1].default_value = float(CUT_SPLITS)
    build.put(node.inputs[2], inputs["Dispersion Model"])
    return node.outputs[0]
