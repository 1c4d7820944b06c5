"""The extension's submenu in the menu Object, which holds every operator that needs no row of a list.

F3 finds what stands in menus.
"""

from __future__ import annotations

import bpy

from ...preparation.guard import guarded
from ...scene.lights import LOBE, RAYS
from ..operators.debug_operators import AddDebugPasses, RemoveDebugPasses, ShowDebugView
from ..operators.dispersion_operators import DispersionModel, SellmeierIor, Spectrum
from ..operators.light_operators import AddPasses, LightCarrier, ShadowCaustics
from ..operators.preparation_operators import ClearAnalysis, CutSurfaces, KeepCut, Prepare, PutBack, RenderWith
from ..operators.priority_operators import PriorityMove, PriorityOwn, SelectObjects, SpaceOut
from ..operators.problem_operators import Check, FixAll
from ..operators.suggestion_operators import SuggestPriorities
from ..operators.update_operators import UpdateMaterials
from ..preferences import FIT, MEASURED
from ..presets.own_preset_operators import SavePreset
from ..presets.preset_menus import PresetMenu
from ..presets.preset_operators import FitDepth


@guarded("while a panel was drawn", writes=False)
def draw_entry(self: bpy.types.Menu, context: bpy.types.Context) -> None:
    """Draw the submenu as an entry at the end of a menu of Blender's that is far from Delete."""
    self.layout.menu(ObjectMenu.bl_idname, icon="MATERIAL")
    self.layout.separator()


class ObjectMenu(bpy.types.Menu):
    """The extension's submenu of Blender's menu Object."""

    bl_idname = "NESTED_DIELECTRIC_MT_object"
    bl_label = "Nested Dielectric"
    bl_description = "What the extension does to objects and their scene"

    def draw(self, context: bpy.types.Context) -> None:
        layout = self.layout
        layout.menu(PresetMenu.bl_idname, icon="MATERIAL")
        for depth, text in ((FIT, "Fit Depth to Object"), (MEASURED, "Fit Depth as Measured")):
            layout.operator(FitDepth.bl_idname, text=text).depth = depth
        layout.operator(SavePreset.bl_idname, text="Save Preset...")
        layout.separator()
        for direction, text in (("UP", "Priority: Win over One More"), ("DOWN", "Priority: Give Way to One More")):
            layout.operator(PriorityMove.bl_idname, text=text).direction = direction
        layout.operator(PriorityOwn.bl_idname, text="Priority: Own or Material's")
        layout.operator(SpaceOut.bl_idname)
        layout.operator(SuggestPriorities.bl_idname, text="Suggest Priorities...")
        layout.operator(SelectObjects.bl_idname, text="Select Objects of Medium")
        layout.separator()
        layout.operator(Prepare.bl_idname)
        layout.operator(Check.bl_idname)
        layout.operator(FixAll.bl_idname, text="Fix All Problems")
        layout.operator_menu_enum(RenderWith.bl_idname, "backend")
        layout.operator(CutSurfaces.bl_idname)
        layout.operator(KeepCut.bl_idname, text="Keep Cut in File")
        layout.operator(PutBack.bl_idname, text="Put Back what Prepare Changed")
        layout.operator(ClearAnalysis.bl_idname)
        layout.operator(UpdateMaterials.bl_idname)
        layout.separator()
        layout.operator(Spectrum.bl_idname, text="Spectrum...")
        layout.operator_menu_enum(DispersionModel.bl_idname, "model")
        layout.operator(SellmeierIor.bl_idname)
        for carrier, text in ((LOBE, "Refract Lights by Lobe"), (RAYS, "Refract Lights by Rays")):
            layout.operator(LightCarrier.bl_idname, text=text).carrier = carrier
        for enable, text in ((True, "Shadow Caustics On"), (False, "Shadow Caustics Off")):
            layout.operator(ShadowCaustics.bl_idname, text=text).enable = enable
        layout.operator(AddPasses.bl_idname)
        layout.separator()
        layout.operator_menu_enum(ShowDebugView.bl_idname, "view")
        layout.operator(AddDebugPasses.bl_idname)
        layout.operator(RemoveDebugPasses.bl_idname)


CLASSES = (ObjectMenu,)
