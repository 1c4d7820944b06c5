"""The cutter: one object whose modifier cuts all media of a scene, from which each medium's surface picks its faces.

Where a scene has many media, further objects hold the faces of
:data:`~nested_dielectric.nodes.cutting.surfaces.PART` media each, so that no surface has to look through all faces.
"""

from __future__ import annotations

from hashlib import sha256

import bpy

from ..nodes.animation import curves
from ..nodes.cut_faces import CUT_WITH_COLOUR, CUT_WITH_DISPERSION
from ..nodes.cutting.cut import make_cut_tree
from ..nodes.cutting.plan import Plan, enclosing_layers, value_name, values_of
from ..nodes.cutting.surfaces import PART
from ..nodes.wholeness import is_whole
from ..scene.materials import dielectric_node
from ..scene.media import CUT_OF
from .cut_collection import (
    COLLECTION,
    CUTTER,
    ensure_nodes_modifier,
    find_collection,
    remove_object,
    remove_unused_tree,
)
from .drivers import drive_by
from .medium_contents import is_in_use

PLAN = "nd_plan"
"""Custom property of the cutter: the digest of the plan that its nodes were made from."""


def cutter_of(scene: bpy.types.Scene) -> bpy.types.Object | None:
    """Return the object whose modifier cuts a scene's media, None without one."""
    collection = find_collection(scene)
    return next((obj for obj in collection.objects if PLAN in obj), None) if collection is not None else None


def told_by_faces(plan: Plan) -> float:
    """Return the most that faces of a plan's surfaces tell of the media outside.

    1 stands for their index, CUT_WITH_COLOUR for colour, too, and CUT_WITH_DISPERSION for dispersion, too.
    """
    nodes = [
        dielectric_node(plan.layers[place].material)
        for place in enclosing_layers(plan)
        if plan.layers[place].needs_all_values
    ]
    if any(is_in_use(node, "Disperse") for node in nodes):
        return CUT_WITH_DISPERSION
    return CUT_WITH_COLOUR if nodes else 1.0


def ensure_cutters(collection: bpy.types.Collection, media: int) -> list[bpy.types.Object]:
    """Return the cutter and, where there are many media, one object for each part of them; make or remove them as needed.

    They are hidden everywhere.
    """
    count = 1 + (-(-media // PART) if media > PART else 0)
    cutters = sorted((obj for obj in collection.objects if obj.get(CUT_OF) == CUTTER), key=lambda obj: PLAN not in obj)
    for obj in cutters[count:]:
        remove_object(obj)
    while len(cutters) < count:
        cutter = bpy.data.objects.new(COLLECTION, bpy.data.meshes.new(COLLECTION))
        cutter[CUT_OF] = CUTTER
        cutter.hide_render = cutter.hide_viewport = cutter.hide_select = True
        collection.objects.link(cutter)
        cutters.append(cutter)
    return cutters[:count]


def ensure_cutter_nodes(cutter: bpy.types.Object, plan: Plan) -> None:
    """Give the cutter the nodes of a plan, and drivers that bring the values of materials, unless it has them."""
    digest = plan_digest(plan)
    modifier = ensure_nodes_modifier(cutter)
    if cutter.get(PLAN) == digest and is_whole(modifier.node_group) and _is_driven(cutter, plan):
        return
    cutter.animation_data_clear()
    before, modifier.node_group = modifier.node_group, None
    remove_unused_tree(before)
    modifier.node_group = make_cut_tree(plan)
    cutter[PLAN] = digest
    for place in enclosing_layers(plan):
        for name in values_of(plan.layers[place]):
            _drive_input(cutter, modifier, value_name(name, place), plan.layers[place].material, name)


def _is_driven(cutter: bpy.types.Object, plan: Plan) -> bool:
    """Return whether the cutter has as many drivers as a plan needs."""
    driven = {curve.data_path for curve in curves(cutter.animation_data)}
    return len(driven) == sum(len(values_of(plan.layers[place])) for place in enclosing_layers(plan))


def plan_digest(plan: Plan) -> str:
    """Return a digest of all that the nodes of a plan depend on."""
    text = repr(
        (
            [
                (
                    layer.priority,
                    layer.material.name_full,
                    [obj.name_full for obj in layer.crossing],
                    [(obj.name_full, around) for obj, around in layer.constant],
                    layer.overlapping,
                    layer.needs_all_values,
                    layer.keeps_hidden_faces,
                )
                for layer in plan.layers
            ],
            sorted(plan.pairs),
            plan.may_part,
            sorted((obj.name_full, names) for obj, names in plan.attributes.items()),
        )
    )
    return sha256(text.encode()).hexdigest()


def _drive_input(
    cutter: bpy.types.Object, modifier: bpy.types.NodesModifier, name: str, material: bpy.types.Material, socket: str
) -> None:
    """Drive an input of the cutter's modifier by a socket of a material's medium, without a script."""
    identifier = modifier.node_group.interface.items_tree[name].identifier
    path = f'modifiers["{modifier.name}"].properties.inputs.{identifier}.value'
    node = dielectric_node(material)
    drive_by(cutter, path, material, f'node_tree.nodes["{node.name}"].inputs["{socket}"].default_value')


def set_inputs(modifier: bpy.types.NodesModifier, values: dict) -> None:
    """Set inputs of a modifier by name, and tag its object if any of them changes."""
    for name, value in values.items():
        socket = input_of(modifier, name)
        if socket.value != value:
            socket.value = value
            modifier.id_data.update_tag()


def input_of(modifier: bpy.types.NodesModifier, name: str) -> bpy.types.bpy_struct:
    """Return the property of a modifier that holds an input of its group."""
    tree = modifier.node_group.interface.items_tree
    socket = next(item for item in tree if item.item_type == "SOCKET" and item.in_out == "INPUT" and item.name == name)
    return getattr(modifier.properties.inputs, socket.identifier)
