"""What tests of buttons and panels share: media to press them on, and what a panel draws."""

from types import SimpleNamespace

import bpy

import nested_dielectric as nd
from nested_dielectric.scene import materials


def add_cube(name, x=0.0):
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(x, 0.0, 0.0))
    bpy.context.object.name = name
    return bpy.context.object


def add_media(**priorities):
    """Cubes of water with priorities of their own, or, where that is None, with that of water."""
    cubes = [add_cube(name) for name in priorities]
    for cube, priority in zip(cubes, priorities.values()):
        nd.assign(cube, "water", priority)
    return cubes


def add_dispersive(preset="bk7", **keywords):
    """A cube of a preset that splits colours, its material and that one's group node."""
    cube = add_cube("Prism")
    material = nd.new_material("Prism", preset, disperse=True, **keywords)
    nd.assign(cube, material)
    return material, materials.dielectric_node(material)


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
            self.drawn.append((name, arguments, keywords | {"active": self.layout.active}))
            result = getattr(self.layout, name)(*arguments, **keywords)
            return Layout(result, self.drawn) if isinstance(result, bpy.types.UILayout) else result

        return call


def draw_panel(panel, width, read_output):
    """Draw a panel as Blender would, in a region of some width; what it draws, as in :class:`Layout`. Blender complains of what
    it cannot draw on the terminal alone, which ``read_output`` reads.
    """
    context = SimpleNamespace(
        scene=bpy.context.scene,
        object=bpy.context.object,
        region=SimpleNamespace(width=width),
        preferences=SimpleNamespace(system=SimpleNamespace(ui_scale=1.0)),
        window_manager=bpy.context.window_manager,
    )
    drawn = []
    read_output()
    area = bpy.context.window.screen.areas[0]
    with bpy.context.temp_override(area=area, region=area.regions[0]):
        layout = bpy.context.window_manager.popover_begin__internal(ui_units_x=10).layout
        panel.draw(SimpleNamespace(layout=Layout(layout, drawn), bl_label=panel.bl_label), context)
    complaints = [line for line in "".join(read_output()).splitlines() if "no icon for icon ID" not in line]
    assert not complaints
    return drawn


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
