"""A saved file renders without the extension."""

import subprocess
import sys
from pathlib import Path

import bpy
import numpy as np
from scenes import add, add_camera, add_sphere, new_scene, read_picture, render, set_striped_world, set_world

import nested_dielectric as nd
from nested_dielectric.scene.materials import set_spectrum

RENDER = """
import bpy
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
bpy.context.scene.render.filepath = sys.argv[2]
bpy.ops.render.render(write_still=True)
"""
WITH_EXTENSION = "import sys\nimport nested_dielectric\nnested_dielectric.register()" + RENDER
WITHOUT_EXTENSION = 'import sys\nsys.modules["nested_dielectric"] = None  # any import of it fails' + RENDER


def render_in_fresh_process(program: str, file: Path, picture: Path) -> np.ndarray:
    """Blender orders objects by where they lie in memory, so only processes that do the same agree to the last bit."""
    subprocess.run([sys.executable, "-c", program, str(file), str(picture)], check=True, capture_output=True)
    return read_picture(picture)


def build_scene() -> None:
    new_scene(48)
    add_content()


def add_content() -> None:
    set_striped_world()
    add_camera((0, -5, 0.3), (0, 0, 0), angle=28)
    tint = {"transmittance": (0.9, 0.5, 0.3), "transmittance_depth": 0.8}
    add_sphere("Glass", 1.0, nd.new_material("Glass", preset="glass", **tint), 2)
    add_sphere("Water", 0.7, nd.new_material("Water", preset="water"), 1, (0.5, -0.2, 0.1))
    add_sphere("Bubble", 0.3, nd.new_material("Bubble", preset="air_bubble"), None, (0.2, -0.1, 0.0))


def add_moving_lamp() -> None:
    """A lamp that the lobe of direct refraction carries, on its way past the glass."""
    light = bpy.data.lights.new("Lamp", "AREA")
    light.energy = 200.0
    lamp = add("Lamp", light, (0.0, 3.0, 1.0))
    lamp.rotation_euler = (-1.4, 0.0, 0.0)
    lamp.visible_transmission = False
    for frame, x in ((1, -9.0), (11, 1.0)):
        lamp.location.x = x
        lamp.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)


def test_a_lamp_of_the_lobe_moves_without_the_extension(tmp_path):
    build_scene()
    set_world((0.0, 0.0, 0.0))
    add_moving_lamp()
    nd.prepare(bpy.context.scene)
    file = tmp_path / "scene.blend"
    bpy.context.scene.cycles.samples = 16
    bpy.context.scene.frame_set(10)
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    farm = render_in_fresh_process(WITHOUT_EXTENSION, file, tmp_path / "farm.exr")
    bpy.context.scene.frame_set(1)
    far, near = render(16).mean(), farm.mean()
    assert near > 2.0 * far
    bpy.context.scene.frame_set(10)
    assert abs(near / render(16).mean() - 1.0) < 1e-3


def test_a_saved_file_renders_bit_for_bit_the_same_without_the_extension(tmp_path):
    build_scene()
    for name, light in (("Glass", "DAYLIGHT"), ("Water", "FL2")):
        node = bpy.data.materials[name].node_tree.nodes["Nested Dielectric"]
        node.inputs["Disperse"].default_value = True
        set_spectrum(bpy.data.materials[name], spectral_distribution=light, clamp_negative=False)
    nd.prepare(bpy.context.scene)
    file = tmp_path / "scene.blend"
    bpy.context.scene.cycles.samples = 16
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    installed = render_in_fresh_process(WITH_EXTENSION, file, tmp_path / "studio.exr")
    missing = render_in_fresh_process(WITHOUT_EXTENSION, file, tmp_path / "farm.exr")
    assert np.array_equal(installed, missing)
    assert abs(missing.mean() / render(16).mean() - 1.0) < 1e-3
    assert missing.std(axis=2).mean() > 0.01, "no colours"


def test_a_material_made_under_another_engine_renders_the_same():
    """Cycles compiles scripts by itself only while it is the scene's engine."""
    build_scene()
    expected = render(16)
    new_scene(48)
    bpy.context.scene.render.engine = "BLENDER_EEVEE"
    nd.new_material("First")
    shader = bpy.data.node_groups["Nested Dielectric"].nodes["Nested Dielectric Shader"]
    bpy.context.scene.render.engine = "CYCLES"
    add_content()
    assert shader.bytecode
    # The order of objects in memory decides single samples where a ray meets an edge.
    assert (np.abs(render(16) - expected).max(axis=2) > 1e-4).mean() < 0.01


def test_the_source_travels_with_the_file_in_one_text():
    build_scene()
    text = bpy.data.texts["nested_dielectric.osl"].as_string()
    assert "#include" not in text
    assert text.count("struct Medium") == 1


def test_materials_of_one_file_share_one_group():
    build_scene()
    names = [tree.name for tree in bpy.data.node_groups]
    assert [name for name in names if not name.startswith(".")] == ["Nested Dielectric", "Nested Dielectric Lights"]
    assert not any(name[-3:].isdigit() for name in names)  # as copies would be
