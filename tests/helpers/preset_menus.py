"""What tests of menus of presets share."""

from types import SimpleNamespace

import bpy
from scenes import add_sphere

from nested_dielectric.model import presets
from nested_dielectric.ui.presets import preset_menus

NODE = "Nested Dielectric"


def add_active_ball() -> bpy.types.Object:
    """Add a ball that is active and selected."""
    obj = add_sphere("Ball", 0.5, segments=16)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    return obj


def call(operator: str, /, *arguments, **keywords):
    return getattr(bpy.ops.nested_dielectric, operator)(*arguments, **keywords)


def save_wine(folder):
    wine = presets.Preset(
        "my_wine", "My Wine", "Drinks", ("red", "homemade"), "Red.", "Invented.",
        {"ior": 1.34, "transmittance": [0.6, 0.1, 0.15], "transmittance_depth": 0.05, "priority": 20},
    )  # fmt: skip
    presets.save_preset(wine, folder)
    return wine


class Calls:
    """A layout that writes down what is drawn into it."""

    def __init__(self, drawn):
        self.__dict__["drawn"] = drawn

    def __getattr__(self, name):
        def call(*arguments, **keywords):
            self.drawn.append((name, arguments, keywords))
            return Calls(self.drawn)

        return call

    def __setattr__(self, name, value):
        self.drawn.append((name, (value,), {}))


def draw_popover(group="Glass", search="", cls=preset_menus.PresetPopover) -> list:
    """Draw the popover with a group or words; return what it draws, as names, arguments and keywords."""
    state = bpy.context.window_manager.nested_dielectric_presets
    state.group, state.search = group, search
    drawn = []
    cls.draw(SimpleNamespace(layout=Calls(drawn), bl_label=getattr(cls, "bl_label", "")), bpy.context)
    return drawn
