"""Debug views of a scene: the setting, the legend, and view layers that hold the numbers of all views.

Cycles writes no AOV where Open Shading Language runs, so numbers come from view layers: Cycles' View Layer attributes read a
layer's own property before the scene's, and nothing of the picture itself changes.
"""

from __future__ import annotations

from collections.abc import Iterable

import bpy

from ..model.contract import DebugView
from ..model.debug_views import ALARM, STEPS, VIEWS, Step, medium_colour
from ..model.parameter import ParameterError
from ..nodes.names import DEBUG_THROUGH, DEBUG_VIEW
from .priorities import Row

MOST_THROUGH = 64
"""Surfaces that may be looked through."""

LAYERS = {DebugView[choice.keyword]: f"ND {choice.name}" for choice in VIEWS if choice.keyword != DebugView.NONE.name}
"""Names of the view layers of numbers."""


def get_debug_view(scene: bpy.types.Scene, layer: bpy.types.ViewLayer | None = None) -> DebugView:
    """Return the debug view that a scene shows, or a view layer of it; an unknown number is none."""
    owner = layer if layer is not None and DEBUG_VIEW in layer else scene
    number = owner.get(DEBUG_VIEW)
    if isinstance(number, (int, float)) and abs(number) in DebugView._value2member_map_:
        return DebugView(abs(number))
    return DebugView.NONE


def get_through(scene: bpy.types.Scene) -> int:
    """Return how many surfaces the debug view of a scene lets through before it shows one."""
    number = scene.get(DEBUG_THROUGH)
    return min(max(number, 0), MOST_THROUGH) if isinstance(number, int) else 0


def set_debug_view(scene: bpy.types.Scene, view: str, through: int = 0) -> None:
    """Show a debug view of a scene's media in viewports and renders instead of light, or none.

    :param view: a keyword of :data:`~nested_dielectric.model.debug_views.VIEWS`.
    :param through: surfaces that camera rays pass before one is shown.
    :raises ParameterError: for another word.
    """
    if view not in DebugView.__members__:
        raise ParameterError(f"view={view!r}: one of {', '.join(DebugView.__members__)} is needed")
    code = DebugView[view]
    for name, value in ((DEBUG_VIEW, int(code)), (DEBUG_THROUGH, through if code else 0)):
        if value:
            scene[name] = value
        else:
            scene.pop(name, None)
    scene.update_tag()


def debug_notice(scene: bpy.types.Scene) -> str:
    """Return that renders of a scene show a debug view, in a sentence; empty where none is on."""
    view = get_debug_view(scene)
    return f"renders show the debug view {VIEWS[view].name!r}, not light; choose Debug View: None" if view else ""


def legend(view: DebugView, rows: Iterable[Row]) -> tuple[Step, ...]:
    """Return the rows of a view's legend; `rows` are the scene's media in winning order."""
    media: dict[int, list[str]] = {}
    if view == DebugView.MEDIUM:
        for row in rows:
            media.setdefault(row.priority, []).append(row.owner.name)
    named = [Step(medium_colour(number), f"{number}: {', '.join(names)}") for number, names in media.items()]
    return (*named, *STEPS.get(view, ()), ALARM)


def add_debug_passes(scene: bpy.types.Scene) -> tuple[str, ...]:
    """Add a view layer for each debug view, whose Emission pass holds its numbers: exact, of one sample a pixel.

    Medium is the priority behind the first surface that exists, -1 in air; Validity how many surfaces on the line of sight do
    not exist; the others as :mod:`~nested_dielectric.model.debug_views` has it. What the scene's debug view looks through, they
    do. The layers show what the first view layer shows, and the picture stays as it is. A second call changes nothing.

    :return: sentences: what was changed.
    """
    source = next((layer for layer in scene.view_layers if DEBUG_VIEW not in layer), scene.view_layers[0])
    known = {layer.name for layer in _debug_layers(scene)}
    changes = []
    for view, name in LAYERS.items():
        if name not in known:
            layer = scene.view_layers.new(name)
            layer[DEBUG_VIEW] = -int(view)
            layer[DEBUG_THROUGH] = get_through(scene)
            _copy_shown(source.layer_collection, layer.layer_collection)
            _show_numbers(layer)
            changes.append(f"View Layer {layer.name}: added; its Emission pass holds numbers")
    if changes:
        scene.update_tag()
    return tuple(changes)


def remove_debug_passes(scene: bpy.types.Scene) -> tuple[str, ...]:
    """Remove the view layers of debug views from a scene; return what was changed, in sentences."""
    changes = []
    for layer in _debug_layers(scene):
        if len(scene.view_layers) > 1:
            changes.append(f"View Layer {layer.name}: removed")
            scene.view_layers.remove(layer)
    return tuple(changes)


def _debug_layers(scene: bpy.types.Scene) -> list[bpy.types.ViewLayer]:
    return [layer for layer in scene.view_layers if isinstance(layer.get(DEBUG_VIEW), int) and layer[DEBUG_VIEW] < 0]


def has_debug_passes(scene: bpy.types.Scene) -> bool:
    """Return whether a scene has view layers of debug views."""
    return bool(_debug_layers(scene))


def _copy_shown(source: bpy.types.LayerCollection, target: bpy.types.LayerCollection) -> None:
    """Let a view layer show of collections what another does."""
    for child in source.children:
        other = target.children.get(child.name)
        if other is not None:
            for name in ("exclude", "holdout", "indirect_only", "hide_viewport"):
                setattr(other, name, getattr(child, name))
            _copy_shown(child, other)


def _show_numbers(layer: bpy.types.ViewLayer) -> None:
    """Keep numbers of a view layer apart from all that is not theirs: one sample, no sky, nothing that smooths."""
    layer.samples = 1
    layer.use_pass_emit = True
    layer.use_sky = False
    layer.use_motion_blur = False
    layer.cycles.use_denoising = False
