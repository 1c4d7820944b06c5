"""The cut of one frame, baked into the file so that whoever renders that frame has nothing to cut."""

from __future__ import annotations

from collections.abc import Sequence
from hashlib import sha256

import bpy
import numpy as np

from ..analysis import findings, mesh_modifiers
from ..nodes.cutting.names import FRAME_INPUT
from ..nodes.cutting.plan import Plan, enclosing_layers, values_of
from ..nodes.cutting.surfaces import SURFACE_INPUTS, ensure_kept_tree, ensure_surface_tree
from ..nodes.wholeness import is_whole
from ..scene.materials import dielectric_node
from ..scene.shapes import mesh_digest
from .copied_settings import copy_settings
from .cut_collection import ensure_nodes_modifier, exchange_mesh, remove_unused_tree, surfaces_of
from .cutter import PLAN, cutter_of, input_of, plan_digest, set_inputs

BAKED_STATE = "nd_kept"
"""Custom property of the cutter: the digest of all that the baked cut was made from."""


def bake_frame(scene: bpy.types.Scene, plan: Plan | None) -> str:
    """Bake the cut of a scene's present frame into the file, so that whoever renders this frame has nothing to cut.

    Other frames are cut as ever. :func:`delete_bake` takes it back.

    :param plan: what is cut of the scene now, as :func:`~nested_dielectric.cutting.cut_scene.last_plan` says.
    :returns: why that cannot be, or nothing.
    """
    shown = surfaces_of(scene)
    if plan is None or not shown or cutter_of(scene).get(PLAN) != plan_digest(plan):
        return "nothing is cut, or something has changed since; press Prepare Scene"
    if scene.render.use_simplify:
        return "Simplify may show other shapes in a render"
    different = [obj.name for obj in shown if not all(map(mesh_modifiers.is_same_in_renders, obj.modifiers))]
    if different:
        return f"{findings.listed(tuple(different))} has modifiers that do otherwise in renders"
    delete_bake(scene)
    _bake_meshes(scene, list(shown.values()))
    cutter_of(scene)[BAKED_STATE] = _cut_digest(scene, plan)
    return ""


def _bake_meshes(scene: bpy.types.Scene, surfaces: Sequence[bpy.types.Object]) -> None:
    """Give surfaces the meshes that they are cut to on the present frame of a scene."""
    layer = scene.view_layers[0]
    hidden = {surface: surface.hide_viewport for surface in surfaces}
    for surface in hidden:
        surface.hide_viewport = False
        surface.hide_set(False, view_layer=layer)
    layer.update()
    for surface in hidden:
        evaluated = surface.evaluated_get(layer.depsgraph)
        mesh = bpy.data.meshes.new_from_object(evaluated, preserve_all_data_layers=True, depsgraph=layer.depsgraph)
        mesh.use_auto_texspace = False
        mesh.texspace_location, mesh.texspace_size = evaluated.data.texspace_location, evaluated.data.texspace_size
        exchange_mesh(surface, mesh)
        _exchange_tree(ensure_nodes_modifier(surface), ensure_kept_tree())
        set_inputs(ensure_nodes_modifier(surface), {FRAME_INPUT: scene.frame_current})
        surface.hide_viewport = hidden[surface]


def is_baked(scene: bpy.types.Scene) -> bool:
    """Return whether the cut of one frame of a scene is baked into the file."""
    cutter = cutter_of(scene)
    return cutter is not None and BAKED_STATE in cutter


def delete_bake(scene: bpy.types.Scene) -> bool:
    """Delete a scene's bake, so that every frame is cut as it is rendered; return whether there was one."""
    was_baked = is_baked(scene)
    for obj, surface in surfaces_of(scene).items() if was_baked else ():
        _exchange_tree(ensure_nodes_modifier(surface), ensure_surface_tree())
        exchange_mesh(surface, bpy.data.meshes.new(surface.name))
        copy_settings(surface, obj)
    if was_baked:
        del cutter_of(scene)[BAKED_STATE]
    return was_baked


def delete_outdated_bake(scene: bpy.types.Scene, plan: Plan) -> None:
    """Delete a scene's bake if it is not what a plan would cut."""
    if is_baked(scene) and cutter_of(scene)[BAKED_STATE] != _cut_digest(scene, plan):
        delete_bake(scene)


def _cut_digest(scene: bpy.types.Scene, plan: Plan) -> str:
    """Return a digest of what a plan's cut depends on on the present frame: shapes, places and all that faces carry."""
    state = sha256(plan_digest(plan).encode())
    depsgraph = scene.view_layers[0].depsgraph
    for obj in plan.numbers():
        state.update(np.ascontiguousarray(obj.matrix_world))
        state.update(mesh_digest(obj.evaluated_get(depsgraph).data))
    for place in sorted(enclosing_layers(plan)):
        inputs = dielectric_node(plan.layers[place].material).inputs
        state.update(
            repr([_plain_value(inputs[name].default_value) for name in values_of(plan.layers[place])]).encode()
        )
    return state.hexdigest()


def _plain_value(value):
    """Return a socket's value as a number or a tuple of numbers."""
    return value if isinstance(value, (bool, int, float)) else tuple(value)


def _exchange_tree(modifier: bpy.types.NodesModifier, tree: bpy.types.NodeTree) -> None:
    """Give a surface's modifier another group and the same inputs; remove the group that it had if nothing uses it."""
    was_whole = is_whole(modifier.node_group)
    values = {name: input_of(modifier, name).value for name in SURFACE_INPUTS if was_whole}
    before, modifier.node_group = modifier.node_group, tree
    set_inputs(modifier, values)
    remove_unused_tree(before)
