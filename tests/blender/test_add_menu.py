"""The node in the shader editor's menu Add > Shader."""

from contextlib import contextmanager

import bpy
import pytest
from ui import add_cube

import nested_dielectric as nd
from nested_dielectric.scene import material_spectra, materials
from nested_dielectric.ui import polls

pytestmark = pytest.mark.usefixtures("registered")


@contextmanager
def shader_editor(tree):
    """The window's first area as a shader editor that shows a material's nodes."""
    area = bpy.context.window.screen.areas[0]
    before = area.ui_type
    area.ui_type = "ShaderNodeTree"
    space = area.spaces.active
    space.pin = True
    space.node_tree = tree
    with bpy.context.temp_override(area=area, region=next(each for each in area.regions if each.type == "WINDOW")):
        yield space
    area.ui_type = before


def add_to(material):
    with shader_editor(material.node_tree):
        assert bpy.ops.nested_dielectric.add_node() == {"FINISHED"}
    return material.node_tree.nodes["Nested Dielectric"]


def plugs(material):
    """Target of an output, its socket, and what is plugged in."""
    return {
        (link.to_node.target, link.to_socket.name): (link.from_node.name, link.from_socket.name)
        for link in material.node_tree.links
        if link.to_node.type == "OUTPUT_MATERIAL"
    }


WIRED = {
    ("CYCLES", "Surface"): ("Nested Dielectric", "Surface"),
    ("CYCLES", "Volume"): ("Nested Dielectric", "Volume"),
    ("EEVEE", "Surface"): ("Nested Dielectric", "Preview"),
}


def test_a_node_added_to_a_new_material_takes_the_place_of_its_bare_principled():
    cube = add_cube("Cube")
    material = bpy.data.materials.new("Mine")
    cube.data.materials.append(material)
    node = add_to(material)
    assert plugs(material) == WIRED
    assert materials.dielectric_node(material) == node and nd.get_priority(cube) == 0
    assert "Principled BSDF" in material.node_tree.nodes
    assert node.width >= 300.0 and node.select and not material.node_tree.nodes["Principled BSDF"].select
    assert material_spectra.material_table(material) is not None


def test_a_node_added_beside_an_artists_own_shaders_leaves_them_plugged_in():
    material = bpy.data.materials.new("Mine")
    tree = material.node_tree
    noise = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(noise.outputs[0], tree.nodes["Principled BSDF"].inputs["Roughness"])
    before = plugs(material).keys()
    node = add_to(material)
    assert plugs(material).keys() == before and not any(output.is_linked for output in node.outputs)


def test_a_node_added_to_a_material_without_an_output_gets_one():
    material = bpy.data.materials.new("Mine")
    material.node_tree.nodes.clear()
    add_to(material)
    assert plugs(material) == WIRED


def test_a_node_is_added_by_undoable_steps_where_there_is_a_material(monkeypatch):
    with pytest.raises(RuntimeError, match="Open a material in the Shader Editor"):
        bpy.ops.nested_dielectric.add_node()
    material = bpy.data.materials.new("Mine")
    material.use_fake_user = True
    bpy.ops.ed.undo_push(message="material")
    with shader_editor(material.node_tree):
        assert bpy.ops.nested_dielectric.add_node("EXEC_DEFAULT", True) == {"FINISHED"}
    bpy.ops.ed.undo()
    assert "Nested Dielectric" not in bpy.data.materials["Mine"].node_tree.nodes
    monkeypatch.setattr(polls, "blender_problem", lambda: "this Blender has no OSL")
    with shader_editor(bpy.data.materials["Mine"].node_tree), pytest.raises(RuntimeError, match="no OSL"):
        bpy.ops.nested_dielectric.add_node()
