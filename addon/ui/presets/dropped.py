"""Media that are dragged from the asset library: Blender appends a material and gives it to an object without saying so."""

from __future__ import annotations

from math import isclose

import bpy

from ...model.parameter import ParameterError
from ...preparation.guard import guarded
from ...scene.materials import dielectric_node
from ...scene.preset_materials import fit_depth, is_preset, preset_of
from ...scene.preset_values import DEPTH, measured_depth
from ...scene.shapes import thickness
from ..preferences import FIT, preference

_before: set[int] = set()
"""What the file held before an append, by the session's numbers."""

_appended: set[int] = set()
"""Materials by their session's numbers, until :func:`fit_appended` has looked at them."""


@bpy.app.handlers.persistent
@guarded("while data were appended", writes=False)
def note_before(*_: object) -> None:
    """Note what the file holds before an append: what an append lists may be gone when other handlers have seen it."""
    _before.clear()
    _before.update(each.session_uid for each in (*bpy.data.materials, *bpy.data.objects))


@bpy.app.handlers.persistent
@guarded("while data were appended", writes=False)
def note_appended(*_: object) -> None:
    """Note materials that were appended alone, to look at them once Blender has given them away.

    What comes with objects is as its file has it.
    """
    if any(obj.session_uid not in _before for obj in bpy.data.objects) or preference("depth") != FIT:
        return
    _appended.update(
        each.session_uid for each in bpy.data.materials if each.session_uid not in _before and each.is_editable
    )
    if _appended and not bpy.app.timers.is_registered(fit_appended):
        bpy.app.timers.register(fit_appended)


@guarded("after a material was appended", writes=False)
def fit_appended() -> None:
    """Let the colour of appended presets be that of the objects that have got them, as where a preset is assigned."""
    found = [material for material in bpy.data.materials if material.session_uid in _appended]
    _appended.clear()
    if [material for material in found if _fit(material)]:
        bpy.ops.ed.undo_push(message="Fit Depth")


def forget_appended() -> None:
    """Forget what was appended."""
    _appended.clear()
    if bpy.app.timers.is_registered(fit_appended):
        bpy.app.timers.unregister(fit_appended)


def _fit(material: bpy.types.Material) -> bool:
    """Fit the depth of a material that is as its preset has it; tell whether it was."""
    preset = preset_of(material)
    if preset is None or not preset.has_colour or not is_preset(material, preset):
        return False
    if not isclose(dielectric_node(material).inputs[DEPTH.name].default_value, preset.depth, rel_tol=1e-6):
        return False
    objects = [obj for obj in bpy.data.objects if any(slot.material == material for slot in obj.material_slots)]
    try:
        fit_depth(material, max(map(thickness, objects), default=0.0) or measured_depth(preset))
    except ParameterError:
        return False
    return bool(objects)
