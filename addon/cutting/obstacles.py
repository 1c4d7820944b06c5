"""What keeps media from being cut."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy

from ..analysis import mesh_modifiers, solid_cache, stability
from ..model.parameter import PRIORITY_PROPERTY
from ..nodes.animation import curves, is_animated
from ..nodes.mesh_reads import reads_generated, reads_whole_mesh
from ..nodes.places import is_plugged, shows_other_volume
from ..nodes.sockets import has_analysis
from ..scene.materials import dielectric_node, dielectrics


def find_obstacles(scene: bpy.types.Scene, objects: Sequence[bpy.types.Object]) -> dict[bpy.types.Object, str]:
    """Return why media of a scene cannot be cut: the rest of a sentence about each that cannot."""
    layer = scene.view_layers[0]
    layer.update()
    depsgraph = layer.depsgraph
    instanced = {instance.object.original for instance in depsgraph.object_instances if instance.is_instance}
    shown_otherwise = _view_layer_obstacles(scene, objects)
    own = set(scene.objects)
    elsewhere = {obj for other in bpy.data.scenes if other != scene for obj in other.objects}
    of_materials = {
        material: _material_obstacle(material)
        for material in {slot.material for obj in objects for slot in obj.material_slots}
    }
    blurs = scene.render.use_motion_blur and scene.render.motion_blur_shutter > 0.0
    found = {}
    for obj in objects:
        if obj not in own or obj in instanced:
            reason = "is instanced"
        elif obj in elsewhere:
            reason = "is in another scene, too"
        elif blurs and stability.may_change(obj):
            reason = "may move while the shutter is open"
        else:
            reason = (
                _object_obstacle(obj)
                or next(filter(None, (of_materials[slot.material] for slot in obj.material_slots)), "")
                or shown_otherwise.get(obj, "")
                or solid_cache.is_one_closed_surface(obj.evaluated_get(depsgraph))
            )
        if reason:
            found[obj] = reason
    return found


def _object_obstacle(obj: bpy.types.Object) -> str:
    """Return why an object cannot be cut whatever its materials are, or nothing."""
    found = {material for _, material in dielectrics(obj)}
    if obj.type != "MESH":
        return "is no mesh: Object > Convert > Mesh"
    if obj.library is not None:
        return "is linked from another file"
    if obj.mode == "EDIT":
        return "is being edited"
    if _is_keyed(obj, "hide_render"):
        return "is shown and hidden by keyframes"
    if obj.instance_type != "NONE" or obj.particle_systems:
        return "has instances or particles"
    if len(found) > 1:
        return "has several media"
    if _is_keyed(obj, f'["{PRIORITY_PROPERTY}"]'):
        return "has a priority that may change"
    if any(modifier.type == "SUBSURF" and modifier.use_adaptive_subdivision for modifier in obj.modifiers):
        return "is subdivided adaptively"
    if len(set(obj.data.materials)) < len(obj.data.materials):
        return "has one material in several slots"
    deformed = obj.data.shape_keys is not None or not all(map(mesh_modifiers.keeps_mesh, obj.modifiers))
    if deformed and any(
        slot.material and slot.material.node_tree and reads_generated(slot.material) for slot in obj.material_slots
    ):
        return "has Generated coordinates, which are lost on a mesh that modifiers or shape keys change"
    return ""


def _is_keyed(obj: bpy.types.Object, path: str) -> bool:
    """Return whether a property of an object has keyframes or a driver."""
    return any(curve.data_path == path for curve in curves(obj.animation_data))


def _material_obstacle(material: bpy.types.Material | None) -> str:
    """Return why objects that show a material cannot be cut, or nothing."""
    if material is None or material.node_tree is None:
        return ""
    output = material.node_tree.get_output_node("CYCLES")
    if output is not None and output.inputs["Displacement"].is_linked and material.displacement_method != "BUMP":
        return "is displaced by its material"
    node = dielectric_node(material)
    if node is None:
        return ""
    if not has_analysis(node) or not is_plugged(node):
        return f"has its medium in a group of {material.name!r}"
    priority = node.inputs["Priority"]
    if priority.is_linked or is_animated(material.node_tree, priority):
        return "has a priority that may change"
    if shows_other_volume(material):
        return "has a volume of its own"
    whole = reads_whole_mesh(material)
    return f"has {whole} in {material.name!r}, which is another on part of a mesh" if whole else ""


def _view_layer_obstacles(scene: bpy.types.Scene, objects: Iterable[bpy.types.Object]) -> dict[bpy.types.Object, str]:
    """Return how collections show objects in view layers otherwise than the collection of cut surfaces would."""
    found = {}
    for layer in scene.view_layers:
        found |= dict.fromkeys(set(objects) - set(layer.objects), f"is not in the view layer {layer.name!r}")
        pending = [layer.layer_collection]
        while pending:
            each = pending.pop()
            pending += each.children
            if each.holdout or each.indirect_only:
                reason = f"is in the collection {each.name!r}, a holdout or indirect in the view layer {layer.name!r}"
                found |= dict.fromkeys(each.collection.all_objects, reason)
    return found
