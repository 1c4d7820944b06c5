"""Render passes: direct light through and off media, apart from all else that media refract and reflect.

The lobes of direct refraction and reflection are light that a medium's surface emits. Cycles keeps all of it apart in a
light group of the media, and what the camera sees of it without a bounce in the Emission pass; the compositor does the
rest, so the passes come with the file wherever it is rendered.
"""

from __future__ import annotations

from pathlib import PurePath

import bpy

from ..nodes.names import DEBUG_VIEW
from .media import is_cut_surface, media

LIGHT_GROUP = "Media"
GROUP_NAME = "Nested Dielectric Passes"
FILE_NAME = "passes"
MARK = "nd_passes"
"""Custom property of the node group, whatever it is named."""

PASSES = ("Direct Refraction", "Indirect Refraction", "Direct Specular", "Indirect Specular")

_SOURCES = {
    "Glossy Direct": "use_pass_glossy_direct",
    "Glossy Indirect": "use_pass_glossy_indirect",
    "Glossy Color": "use_pass_glossy_color",
    "Transmission Direct": "use_pass_transmission_direct",
    "Transmission Indirect": "use_pass_transmission_indirect",
    "Transmission Color": "use_pass_transmission_color",
    "Emission": "use_pass_emit",
}
"""Passes of Cycles by the names of the compositor's sockets, and the switches of a view layer."""

_MEDIA_LIGHT = "Media Light"
"""What the group of nodes calls the pass of the light group."""


def add_passes(scene: bpy.types.Scene) -> tuple[str, ...]:
    """Make every view layer that renders, but for those of debug views, write its four passes as the layers of an OpenEXR file.

    Direct Refraction is direct light that lobes refracted, seen through media; Direct Specular is what media emit or
    reflect of lights towards the camera; Indirect Refraction and Indirect Specular are all else that media refract and
    reflect. Where only media are seen their sum is the picture, unless that is denoised. The files lie in the folder of
    the scene's output.

    The artist's own nodes, light groups and picture stay. A second call changes nothing.

    :return: sentences: what was changed or stands in the way.
    """
    if scene.render.engine != "CYCLES":
        return (f"scene {scene.name!r} renders with {scene.render.engine}; its passes are Cycles': prepare it first",)
    changes = _put_in_light_group(scene)
    layers = [layer for layer in scene.view_layers if layer.use and DEBUG_VIEW not in layer] or [scene.view_layers[0]]
    for layer in layers:
        changes += _turn_on_passes(layer)
    changes += _ensure_compositor(scene, layers)
    trees = compositors(scene)
    if not trees:
        return tuple(changes)
    tree = next((tree for tree in trees if tree.is_editable), None)
    if tree is None:
        return (*changes, f"{trees[0].name!r} belongs to a library, so no passes are written; make it local")
    for layer in layers:
        if all(_writer(each, scene, layer) is None for each in trees):
            path = _add_nodes(tree, scene, layer, alone=len(layers) == 1)
            changes.append(f"View Layer {layer.name}: {', '.join(PASSES)} go to {path}")
    return tuple(changes)


def _put_in_light_group(scene: bpy.types.Scene) -> list[str]:
    changes = []
    objects = media(scene)
    for obj in objects:
        if obj.lightgroup == LIGHT_GROUP:
            continue
        if obj.lightgroup:
            changes.append(
                f"{obj.name!r} is in light group {obj.lightgroup!r}, so Indirect Refraction holds its direct one; "
                f"choose {LIGHT_GROUP!r} to part them"
            )
        elif not obj.is_editable:
            changes.append(
                f"{obj.name!r} belongs to a library, so Indirect Refraction holds its direct one; make it local"
            )
        else:
            obj.lightgroup = LIGHT_GROUP
            changes.append(f"Light Group of {obj.name}: {LIGHT_GROUP}")
    ours = {*objects, *filter(is_cut_surface, scene.objects)}
    others = [obj for obj in scene.objects if obj.lightgroup == LIGHT_GROUP and obj not in ours]
    if scene.world is not None and scene.world.lightgroup == LIGHT_GROUP:
        others.append(scene.world)
    for other in others:
        changes.append(
            f"{other.name!r} is no medium, but in light group {LIGHT_GROUP!r}, so Direct Refraction holds its light; "
            "choose another group"
        )
    return changes


def _turn_on_passes(layer: bpy.types.ViewLayer) -> list[str]:
    changes = []
    for name, switch in _SOURCES.items():
        if not getattr(layer, switch):
            setattr(layer, switch, True)
            changes.append(f"View Layer {layer.name}: pass {name} on")
    if LIGHT_GROUP not in layer.lightgroups:
        active = layer.active_lightgroup_index
        layer.lightgroups.add(name=LIGHT_GROUP)
        layer.active_lightgroup_index = max(active, 0)
        changes.append(f"View Layer {layer.name}: light group {LIGHT_GROUP} added")
    return changes


def compositors(scene: bpy.types.Scene) -> list[bpy.types.CompositorNodeTree]:
    """Return the groups of nodes that a scene's renders go through: from Blender 5.3 on there may be several."""
    if hasattr(scene, "compositor_effects"):
        return [
            effect.node_group for effect in scene.compositor_effects if effect.enable_for_render and effect.node_group
        ]
    return [] if scene.compositing_node_group is None else [scene.compositing_node_group]


def file_outputs(scene: bpy.types.Scene) -> list[bpy.types.CompositorNodeOutputFile]:
    """Return the nodes that write files when a scene is rendered, of groups in groups too, but for those of libraries."""
    strips = scene.sequence_editor is not None and len(scene.sequence_editor.strips) > 0
    if not scene.render.use_compositing or (scene.render.use_sequencer and strips):
        return []
    found: list[bpy.types.CompositorNodeOutputFile] = []
    trees = compositors(scene)
    for tree in trees:  # which grows meanwhile
        for node in tree.nodes:
            if node.mute:
                continue
            if node.bl_idname == "CompositorNodeGroup" and node.node_tree is not None and node.node_tree not in trees:
                trees.append(node.node_tree)
            elif node.bl_idname == "CompositorNodeOutputFile" and tree.library is None:
                if any(socket.is_linked for socket in node.inputs):
                    found.append(node)
    return found


def _has_compositor(scene: bpy.types.Scene) -> bool:
    if hasattr(scene, "compositor_effects"):
        return any(effect.node_group is not None for effect in scene.compositor_effects)
    return scene.compositing_node_group is not None


def add_compositor(scene: bpy.types.Scene, tree: bpy.types.CompositorNodeTree) -> None:
    """Let a scene's renders go through a group of nodes."""
    if hasattr(scene, "compositor_effects"):
        scene.compositor_effects.new(tree.name).node_group = tree
    else:
        scene.compositing_node_group = tree


def _ensure_compositor(scene: bpy.types.Scene, layers: list[bpy.types.ViewLayer]) -> list[str]:
    """Give a scene that has no compositing nodes those that leave its picture as it is."""
    if _has_compositor(scene):
        # Switched on, the artist's own nodes would change the picture.
        if not scene.render.use_compositing:
            return ["Output > Post Processing > Compositing is off, so no passes are written; switch it on"]
        if not compositors(scene):
            return ["No compositor effect is on in renders, so no passes are written; switch one on"]
        return []
    tree = bpy.data.node_groups.new("Compositor Nodes", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    add_compositor(scene, tree)
    picture = _render_layers(tree, scene, layers[0])
    output = tree.nodes.new("NodeGroupOutput")
    output.location = (300.0, 0.0)
    tree.links.new(picture.outputs["Image"], output.inputs["Image"])
    scene.render.use_compositing = True
    return [f"Compositing Nodes of {scene.name}: made, with the picture as it was"]


def _render_layers(
    tree: bpy.types.NodeTree, scene: bpy.types.Scene, layer: bpy.types.ViewLayer
) -> bpy.types.CompositorNodeRLayers:
    node = tree.nodes.new("CompositorNodeRLayers")
    node.scene = scene
    node.layer = layer.name
    return node


def _writer(
    tree: bpy.types.NodeTree, scene: bpy.types.Scene, layer: bpy.types.ViewLayer
) -> bpy.types.CompositorNodeOutputFile | None:
    """Return the node that writes the passes of a view layer, or None."""
    for node in tree.nodes:
        if node.bl_idname != "CompositorNodeOutputFile":
            continue
        for link in (link for socket in node.inputs for link in socket.links):
            group = link.from_node
            if group.bl_idname != "CompositorNodeGroup" or not _is_passes(group.node_tree):
                continue
            sources = [other.from_node for other in group.inputs[_MEDIA_LIGHT].links]
            if any(_shows(source, scene, layer) for source in sources):
                return node
    return None


def _shows(node: bpy.types.Node, scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> bool:
    return node.bl_idname == "CompositorNodeRLayers" and node.scene == scene and node.layer == layer.name


def _add_nodes(tree: bpy.types.NodeTree, scene: bpy.types.Scene, layer: bpy.types.ViewLayer, alone: bool) -> str:
    """Add the nodes that compute and write the passes of a view layer; return the file's path without its number."""
    bottom = min((node.location_absolute.y - _height(node) for node in tree.nodes), default=0.0)
    frame = tree.nodes.new("NodeFrame")
    frame.label = f"{GROUP_NAME}: {layer.name}"
    source = _render_layers(tree, scene, layer)
    group = tree.nodes.new("CompositorNodeGroup")
    group.node_tree = _ensure_group()
    group.width = 240.0
    writer = tree.nodes.new("CompositorNodeOutputFile")
    for place, node in enumerate((source, group, writer)):
        node.location = (340.0 * place, bottom - 120.0)
        node.parent = frame
    for name in _SOURCES:
        tree.links.new(source.outputs[name], group.inputs[name])
    tree.links.new(source.outputs[f"Combined_{LIGHT_GROUP}"], group.inputs[_MEDIA_LIGHT])
    for socket in source.outputs:
        socket.hide = not socket.is_linked

    writer.format.media_type = "MULTI_LAYER_IMAGE"
    writer.format.file_format = "OPEN_EXR_MULTILAYER"
    writer.format.color_depth = "32"
    writer.format.exr_codec = "ZIP"
    writer.file_output_items.clear()
    for name in PASSES:
        writer.file_output_items.new("RGBA", name)
        tree.links.new(group.outputs[name], writer.inputs[name])
    writer.directory, writer.file_name = _path(scene, "" if alone else layer.name)
    return str(PurePath(writer.directory, writer.file_name))


def _height(node: bpy.types.Node) -> float:
    """Return the space that a node takes from top to bottom, which Blender knows once it is drawn."""
    return max(node.height, 22.0 * (len(node.inputs) + len(node.outputs)) + 100.0)


def _path(scene: bpy.types.Scene, layer: str) -> tuple[str, str]:
    """Return the folder and the name of a file beside the scene's output."""
    folder, slash, name = scene.render.filepath.replace("\\", "/").rpartition("/")
    stem = PurePath(name).stem.rstrip("#_. ")
    words = [word for word in (stem, FILE_NAME, bpy.path.clean_name(layer)) if word]
    return f"{folder}/" if slash else "./", "_".join(words)


def _is_passes(tree: bpy.types.NodeTree | None) -> bool:
    """Return whether a group is that of this extension, with the sockets it was made with."""
    if tree is None or tree.bl_idname != "CompositorNodeTree" or MARK not in tree:
        return False
    sockets = {(item.in_out, item.name) for item in tree.interface.items_tree if item.item_type == "SOCKET"}
    inputs, outputs = (("INPUT", (*_SOURCES, _MEDIA_LIGHT)), ("OUTPUT", PASSES))
    return all((in_out, name) in sockets for in_out, names in (inputs, outputs) for name in names)


def _ensure_group() -> bpy.types.NodeTree:
    """Return this file's group that computes the four passes, made on first use."""
    found = next((tree for tree in bpy.data.node_groups if _is_passes(tree) and tree.library is None), None)
    return _new_group() if found is None else found


def _new_group() -> bpy.types.NodeTree:
    tree = bpy.data.node_groups.new(GROUP_NAME, "CompositorNodeTree")
    tree[MARK] = True
    tree.description = "Parts what media refract and reflect into direct light and all else"
    for name in (*_SOURCES, _MEDIA_LIGHT):
        tree.interface.new_socket(name, in_out="INPUT", socket_type="NodeSocketColor")
    for name in PASSES:
        tree.interface.new_socket(name, in_out="OUTPUT", socket_type="NodeSocketColor")
    inputs = tree.nodes.new("NodeGroupInput")
    outputs = tree.nodes.new("NodeGroupOutput")
    column = iter(range(20))

    def math(operation: str, first: bpy.types.NodeSocket, second: bpy.types.NodeSocket | None, label: str):
        node = tree.nodes.new("ShaderNodeVectorMath")
        node.operation = operation
        node.label = label
        node.location = (200.0 * next(column), 0.0)
        tree.links.new(first, node.inputs[0])
        if second is not None:
            tree.links.new(second, node.inputs[1])
        return node.outputs[0]

    def light(kind: str, color: str) -> bpy.types.NodeSocket:
        return math("MULTIPLY", given[kind], given[color], kind)

    given = inputs.outputs
    inputs.location = (-300.0, 0.0)
    emitted = math("MINIMUM", given["Emission"], given[_MEDIA_LIGHT], "Emitted towards the Camera")
    refracted = math("ADD", given["Transmission Direct"], given["Transmission Indirect"], "Transmission")
    refracted = math("MULTIPLY", refracted, given["Transmission Color"], "All Refraction")
    # Light of media also reaches the camera off other things, and off media.
    beyond = math("SUBTRACT", given[_MEDIA_LIGHT], emitted, "After a Bounce")
    beyond = math("MAXIMUM", beyond, None, "At least None")
    direct = math("MINIMUM", beyond, refracted, "Refracted")
    results = {
        "Direct Refraction": direct,
        "Indirect Refraction": math("SUBTRACT", refracted, direct, "All but the Direct"),
        "Direct Specular": math("ADD", light("Glossy Direct", "Glossy Color"), emitted, "Reflected and Emitted"),
        "Indirect Specular": light("Glossy Indirect", "Glossy Color"),
    }
    for name, result in results.items():
        tree.links.new(result, outputs.inputs[name])
    outputs.location = (200.0 * next(column), 0.0)
    return tree
