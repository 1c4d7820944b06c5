"""Drawing panels without a window, and what stands in them then."""

from types import SimpleNamespace

import bpy
import pytest


class Layout:
    """A layout of Blender's that writes down what is drawn into it."""

    def __init__(self, layout, drawn):
        self.__dict__.update(layout=layout, drawn=drawn)

    def __setattr__(self, name, value):
        setattr(self.layout, name, value)

    def panel(self, idname, default_closed=False):
        """A panel within it, which is open; Blender makes them in panels alone."""
        self.drawn.append(("panel", (idname,), {"default_closed": default_closed}))
        return Layout(self.layout.row(), self.drawn), Layout(self.layout.column(), self.drawn)

    def __getattr__(self, name):
        def call(*arguments, **keywords):
            self.drawn.append((name, arguments, keywords))
            result = getattr(self.layout, name)(*arguments, **keywords)
            return Layout(result, self.drawn) if isinstance(result, bpy.types.UILayout) else result

        return call


@pytest.fixture
def draw(capfd):
    """Draw a panel as Blender would, in a region of some width; what it draws, as in :class:`Layout`."""

    def draw(panel, width=220):
        context = SimpleNamespace(
            scene=bpy.context.scene,
            object=bpy.context.object,
            region=SimpleNamespace(width=width),
            preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
        )
        drawn = []
        capfd.readouterr()
        area = bpy.context.window.screen.areas[0]
        with bpy.context.temp_override(area=area, region=area.regions[0]):
            layout = bpy.context.window_manager.popover_begin__internal(ui_units_x=10).layout
            panel.draw(SimpleNamespace(layout=Layout(layout, drawn)), context)
        complaints = [line for line in "".join(capfd.readouterr()).splitlines() if "no icon for icon ID" not in line]
        assert not complaints
        return drawn

    return draw


def texts(drawn):
    """All labels of a panel as one text, its properties' names, and its buttons' names with what they look like."""
    by_kind = {
        kind: {keywords["text"]: keywords for name, _, keywords in drawn if name == kind and "text" in keywords}
        for kind in ("prop", "operator")
    }
    labels = " ".join(keywords["text"] for name, _, keywords in drawn if name == "label")
    return labels, by_kind["prop"].keys(), by_kind["operator"]


def labels_and_operators(drawn):
    """All labels of a panel as one text, and which operators it offers."""
    labels = " ".join(keywords["text"] for name, _, keywords in drawn if name == "label")
    return labels, [arguments[0] for name, arguments, _ in drawn if name == "operator"]
