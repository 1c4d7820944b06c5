"""Scenes to be written to files: one that takes no time, and one that takes hours."""

from pathlib import Path

import bpy
from scenes import add_camera, add_sphere, new_scene, set_striped_world

import nested_dielectric as nd
from nested_dielectric.scene.output import save_blend
from nested_dielectric.scene.passes import add_compositor, file_outputs


def stripes(resolution: int = 32) -> bpy.types.Scene:
    """A scene that takes no time."""
    scene = new_scene(resolution)
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    scene.cycles.samples = 1
    return scene


def with_passes(folder: Path, scene: bpy.types.Scene) -> bpy.types.CompositorNodeOutputFile:
    add_sphere("Ball", 1.0, nd.new_material("Glass"))
    scene.render.filepath = f"{folder}/{{blend_name}}/shot_####.png"
    nd.add_passes(scene)
    (writer,) = file_outputs(scene)
    return writer


def with_writer(
    scene: bpy.types.Scene, directory: str, name: str, item: str = "", layered: bool = False
) -> bpy.types.CompositorNodeOutputFile:
    """Give a scene a compositor that leaves its picture as it is and writes it to one file more."""
    tree = bpy.data.node_groups.new("Nodes", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    add_compositor(scene, tree)
    layers, writer = (tree.nodes.new(kind) for kind in ("CompositorNodeRLayers", "CompositorNodeOutputFile"))
    layers.scene = scene
    writer.format.media_type = "MULTI_LAYER_IMAGE" if layered else "IMAGE"
    writer.format.file_format = "OPEN_EXR_MULTILAYER" if layered else "PNG"
    writer.directory, writer.file_name = directory, name
    writer.file_output_items.clear()
    writer.file_output_items.new("RGBA", item)
    tree.links.new(layers.outputs["Image"], writer.inputs[0])
    tree.links.new(layers.outputs["Image"], tree.nodes.new("NodeGroupOutput").inputs[0])
    return writer


def save_long_file(folder: Path) -> Path:
    """Save a scene that renders for hours."""
    scene = stripes(64)
    add_sphere("Glass", 1.0, nd.new_material("Glass", preset="glass"))
    scene.cycles.samples = 10_000_000
    path = folder / "scene.blend"
    save_blend(path)
    return path
