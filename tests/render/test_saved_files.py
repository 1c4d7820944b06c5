"""A saved file renders without the extension."""

import bpy
import numpy as np
from nested_balls import add_content, build_scene
from processes import WITH_EXTENSION, WITHOUT_EXTENSION, render_in_fresh_process
from scenes import add, new_scene, render, set_world

import nested_dielectric as nd
from nested_dielectric.scene.material_spectra import set_spectrum


def add_moving_light() -> None:
    """A light that the lobe of direct refraction carries, on its way past the glass."""
    light = bpy.data.lights.new("Lamp", "AREA")
    light.energy = 200.0
    light = add("Lamp", light, (0.0, 3.0, 1.0))
    light.rotation_euler = (-1.4, 0.0, 0.0)
    light.visible_transmission = False
    for frame, x in ((1, -9.0), (11, 1.0)):
        light.location.x = x
        light.keyframe_insert("location", frame=frame)
    bpy.context.scene.frame_set(1)


def test_a_light_of_the_lobe_moves_without_the_extension(tmp_path):
    build_scene()
    set_world((0.0, 0.0, 0.0))
    add_moving_light()
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
