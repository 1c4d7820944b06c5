"""What of a scene is rendered: through which camera, and which view layer."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import bpy

from .meanwhile import set_meanwhile
from .passes import compositors
from .render_error import RenderError


def cameras(scene: bpy.types.Scene) -> dict[str, bpy.types.Object]:
    """Return the cameras of a scene by their names."""
    return {obj.name: obj for obj in scene.objects if obj.type == "CAMERA"}


@contextmanager
def through_camera(scene: bpy.types.Scene, camera: bpy.types.Object) -> Iterator[None]:
    """Let a scene be seen through a camera meanwhile, on frames at which markers change to others, too."""
    with ExitStack() as undo:
        for marker in scene.timeline_markers:
            if marker.camera is not None:
                undo.enter_context(set_meanwhile(marker, camera=None))
        undo.enter_context(set_meanwhile(scene, camera=camera))
        yield


@contextmanager
def layer_alone(scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> Iterator[None]:
    """Let one view layer of a scene alone be rendered meanwhile.

    :raises RenderError: if the compositor shows others, too, which would be empty.
    """
    for other in _shown_layers(scene) - {layer.name}:
        raise RenderError(
            f"the compositor shows view layer {other!r}, too; render all, or switch Output > Post Processing > Compositing off"
        )
    with ExitStack() as undo:
        for each in scene.view_layers:
            undo.enter_context(set_meanwhile(each, use=each == layer))
        yield


def _shown_layers(scene: bpy.types.Scene) -> set[str]:
    """Return the names of the view layers of a scene that its compositor shows."""
    if not scene.render.use_compositing:
        return set()
    trees = compositors(scene)
    layers = set()
    for tree in trees:  # which grows meanwhile
        for node in tree.nodes:
            if node.bl_idname == "CompositorNodeGroup" and node.node_tree is not None and node.node_tree not in trees:
                trees.append(node.node_tree)
            elif node.bl_idname == "CompositorNodeRLayers" and node.scene == scene and not node.mute:
                layers.add(node.layer)
    return layers
