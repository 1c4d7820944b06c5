"""The collection of objects that stand for media that are cut, in each scene that has any."""

from __future__ import annotations

import bpy

from ..nodes.cutting.names import CUT_GROUP
from ..nodes.names import WHOLE
from ..scene.media import CUT_OF

COLLECTION = "Nested Dielectric Cut"
"""Name of the collection, and of the object that cuts."""

CUTTER = "all"
"""Value of an object's property CUT_OF in place of a medium: it cuts media and shows none."""


def is_shown(scene: bpy.types.Scene) -> bool:
    """Return whether renders of a scene show any surfaces in place of media."""
    return find_collection(scene) is not None


def find_collection(scene: bpy.types.Scene) -> bpy.types.Collection | None:
    """Return the scene's own collection of what renders show in place of media, None without one."""
    return next((each for each in scene.collection.children if CUT_OF in each and each.library is None), None)


def ensure_collection(scene: bpy.types.Scene) -> bpy.types.Collection:
    """Return the collection of a scene, made if need be, and show it in renders of all view layers."""
    collection = find_collection(scene)
    if collection is None:
        collection = bpy.data.collections.new(COLLECTION)
        collection[CUT_OF] = True
        collection.hide_select = True
        scene.collection.children.link(collection)
    shown = [
        each for layer in scene.view_layers for each in layer.layer_collection.children if each.collection == collection
    ]
    for owner, names in (
        (collection, ("hide_render",)),
        *((each, ("exclude", "holdout", "indirect_only")) for each in shown),
    ):
        for name in names:
            if getattr(owner, name):
                setattr(owner, name, False)
    return collection


def move_out_others(scene: bpy.types.Scene, collection: bpy.types.Collection) -> None:
    """Move what artists have put into the collection, or made while it was active, into the scene's own."""
    for obj in [each for each in collection.objects if not _is_ours(each)]:
        if obj.name not in scene.collection.objects:
            scene.collection.objects.link(obj)
        collection.objects.unlink(obj)
    for child in list(collection.children):
        if child.name not in scene.collection.children:
            scene.collection.children.link(child)
        collection.children.unlink(child)


def _is_ours(obj: bpy.types.Object) -> bool:
    """Return whether an object shows a medium's surface, or cuts, though others have taken its mark."""
    trees = (modifier.node_group for modifier in obj.modifiers if modifier.type == "NODES")
    return CUT_OF in obj or any(tree is not None and WHOLE in tree for tree in trees)


def surfaces_of(scene: bpy.types.Scene) -> dict[bpy.types.Object, bpy.types.Object]:
    """Return the objects that show media of a scene in renders, by the media."""
    collection = find_collection(scene)
    found = collection.objects if collection is not None else ()
    return {obj[CUT_OF]: obj for obj in found if isinstance(obj.get(CUT_OF), bpy.types.Object)}


def exchange_mesh(surface: bpy.types.Object, mesh: bpy.types.Mesh) -> None:
    """Give a surface another mesh, and remove the one that it had unless others use it: they would go with it."""
    before, surface.data = surface.data, mesh
    if not before.users:
        bpy.data.meshes.remove(before)


def find_nodes_modifier(obj: bpy.types.Object) -> bpy.types.NodesModifier | None:
    """Return the Geometry Nodes modifier of an object of the collection, None if an artist has removed it."""
    return next((each for each in obj.modifiers if each.type == "NODES"), None)


def ensure_nodes_modifier(obj: bpy.types.Object) -> bpy.types.NodesModifier:
    """Return the Geometry Nodes modifier of an object of the collection, a new one without a group if there is none."""
    return find_nodes_modifier(obj) or obj.modifiers.new(CUT_GROUP, "NODES")


def remove_object(obj: bpy.types.Object) -> None:
    """Remove an object of the collection, with its mesh and its node groups if nothing else uses them."""
    data = obj.data
    trees = [modifier.node_group for modifier in obj.modifiers]
    bpy.data.objects.remove(obj)
    if isinstance(data, bpy.types.Mesh) and not data.users:
        bpy.data.meshes.remove(data)
    for tree in trees:
        remove_unused_tree(tree)


def remove_unused_tree(tree: bpy.types.NodeTree | None) -> None:
    """Remove a local node group that nothing uses, and then those in it."""
    if tree is None or tree.users or tree.library is not None:
        return
    inner = [node.node_tree for node in tree.nodes if node.type == "GROUP"]
    bpy.data.node_groups.remove(tree)
    for each in dict.fromkeys(inner):
        remove_unused_tree(each)
