"""Packed files alone, where the extension is not: they show what they showed, or the alarm, whatever a farm does to them."""

import bpy
import numpy as np
import pytest
from command_line import run
from crossing_blocks import add_crossing
from direct_lights import add_light
from packed import ON_GPU, WITHOUT_OSL, alarm, on_farm, packed_away, run_jobs
from scenes import (
    add_camera,
    add_plane,
    add_sphere,
    diffuse,
    new_scene,
    read_picture,
    render,
    set_striped_world,
    set_world,
)
from structures import by_library

import nested_dielectric as nd
from nested_dielectric.model.shader_source import inlined_source
from nested_dielectric.nodes import group
from nested_dielectric.preparation import live
from nested_dielectric.scene.materials import dielectric_node

SAMPLES = 16

# The same samples meet the same surfaces; the shader and Cycles' own nodes round otherwise.
SAME = 1e-3

NOISY = 0.08
"""Most by which two seeds differ in the mean square, of 16 samples or half as many (measured: up to 0.03)."""


def stage(with_group=True):
    scene = new_scene(24, with_group)
    set_striped_world()
    add_camera((2.1, -4.3, 1.7), (0, 0, 0))
    scene.cycles.samples = SAMPLES
    add_crossing()
    return scene


def inputs(name):
    return dielectric_node(bpy.data.materials[name]).inputs


def differs(one, other):
    return float(np.sqrt(((one - other) ** 2).mean()))


def place(name, frame, location):
    obj = bpy.data.objects[name]
    obj.location = location
    obj.keyframe_insert("location", frame=frame)


def move():
    """The water, away from the block and back."""
    for frame, x in ((1, 0.0), (2, 1.4), (3, -0.3)):
        place("Water", frame, (x, 0.1 * x, 0.0))
    bpy.context.scene.frame_set(1)


def set_input(material, name, value):
    inputs(material)[name].default_value = value


def add_spoon():
    """Something that is no medium, in tinted water."""
    set_input("Water", "Transmittance", (0.9, 0.3, 0.2, 1.0))
    set_input("Water", "Transmittance Depth", 0.5)
    add_sphere("Spoon", 0.25, diffuse(0.8), location=(0.5, 0, 0))


def light_by_lobe():
    set_world((0.1, 0.1, 0.1))
    add_light("AREA", lobe=True)
    set_input("Glass", "Roughness", 0.2)


def open_the_water():
    mesh = bpy.data.objects["Water"].data
    faces = [tuple(face.vertices) for face in mesh.polygons][1:]
    points = [tuple(vertex.co) for vertex in mesh.vertices]
    mesh.clear_geometry()
    mesh.from_pydata(points, [], faces)


def leave():
    """As it is."""


OF_OWN_NODES = {
    "crossing": leave,
    "moving": move,
    "keyed": lambda: (inputs("Water")["IOR"].keyframe_insert("default_value", frame=1), set_input("Water", "IOR", 1.1)),
    "rough": lambda: set_input("Glass", "Roughness", 0.3),
}
"""What Cycles' own nodes render as the shader does, if it is cut."""

OF_THE_SHADER = {
    "dispersing": lambda: set_input("Glass", "Disperse", True),
    "scaled": lambda: (set_input("Glass", "Roughness", 0.3), set_input("Glass", "Refraction Scale", 0.3)),
    "tinting": add_spoon,
    "lobes": light_by_lobe,
    "open": open_the_water,
}
"""What only the shader renders."""


@pytest.mark.parametrize("change", OF_OWN_NODES)
def test_a_device_without_osl_shows_what_own_nodes_do(change, tmp_path):
    stage()
    OF_OWN_NODES[change]()
    file, packed = packed_away(tmp_path)
    assert packed.needs[0].devices == ("CPU", "GPU")
    for frame in (1, 2) if change == "moving" else (1,):
        by_shader, on_gpu, without = on_farm(file, {}, ON_GPU, WITHOUT_OSL, frame=frame)
        assert alarm(by_shader) == 0.0 and differs(by_shader, on_gpu) < SAME and differs(by_shader, without) < SAME


@pytest.mark.parametrize("change", OF_THE_SHADER)
def test_a_device_without_osl_shows_the_alarm_where_only_the_shader_is_right(change, tmp_path):
    stage()
    OF_THE_SHADER[change]()
    file, packed = packed_away(tmp_path)
    assert packed.needs[0].devices == ("CPU",)
    by_shader, without = on_farm(file, {}, WITHOUT_OSL)
    # Both blocks fill 0.4 of the picture; a few wavelengths may look like the alarm.
    assert alarm(by_shader) < 0.01 and alarm(without) > 0.35


def test_media_that_are_not_cut_show_the_alarm_on_every_frame_without_osl(tmp_path):
    stage()
    move()
    file, packed = packed_away(tmp_path, cut=False)
    assert packed.needs[0].devices == ("CPU",)
    for frame in (1, 2, 3):
        by_shader, without = on_farm(file, {}, WITHOUT_OSL, frame=frame)
        assert alarm(by_shader) == 0.0 and alarm(without) > 0.2


def test_what_an_artist_has_left_to_own_nodes_is_as_he_saw_it(tmp_path):
    stage()
    add_spoon()
    nd.prepare(bpy.context.scene, backend="NATIVE")
    seen = render(SAMPLES)
    file, packed = packed_away(tmp_path, backend="NATIVE")
    assert packed.needs[0].devices == ("CPU", "GPU")
    for picture in on_farm(file, {}, WITHOUT_OSL):
        assert alarm(picture) == 0.0 and differs(picture, seen) < SAME


def test_a_packed_file_that_is_opened_with_the_extension_shows_no_alarm(tmp_path):
    stage()
    OF_THE_SHADER["scaled"]()
    file, _ = packed_away(tmp_path)
    live.remove()
    bpy.ops.wm.open_mainfile(filepath=str(file))
    scene = bpy.context.scene
    scene.cycles.shading_system = False
    assert alarm(render(4)) > 0.35
    nd.prepare(scene)
    assert alarm(render(4)) == 0.0


def add_wall(folder):
    """A plane behind the blocks that shows a picture from a file."""
    image = bpy.data.images.new("squares", 8, 8)
    image.generated_type = "COLOR_GRID"
    image.filepath_raw, image.file_format = str(folder / "squares.png"), "PNG"
    image.save()
    image.source = "FILE"
    material = diffuse(1.0)
    texture = material.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = image
    bsdf = next(node for node in material.node_tree.nodes if node.type == "BSDF_DIFFUSE")
    material.node_tree.links.new(texture.outputs["Color"], bsdf.inputs["Color"])
    add_plane("Wall", 3.0, (0, 3, 0), (0, -1, 0), material)


def test_a_file_alone_shows_what_the_command_line_renders_of_the_one_that_it_was_packed_from(tmp_path):
    studio = tmp_path / "studio"
    studio.mkdir()
    stage()
    add_wall(studio)
    bpy.ops.wm.save_as_mainfile(filepath=str(studio / "scene.blend"))
    assert run("render", studio / "scene.blend", "-o", tmp_path / "seen.exr").returncode == 0
    file, packed = packed_away(tmp_path)
    assert packed.lacks == ()
    (picture,) = on_farm(file, {})
    # Bit for bit, unless both processes order objects otherwise.
    assert differs(picture, read_picture(tmp_path / "seen.exr")) < SAME


def test_media_that_were_linked_look_the_same_where_the_file_is_alone(tmp_path):
    """Linked ones ask, and the file's own are cut."""
    scene = stage()
    studio = tmp_path / "studio"
    studio.mkdir()
    by_library(nd.new_material("Egg", ior=1.4, priority=3), studio)
    nd.prepare(scene, cut=True)
    seen = render(SAMPLES)
    live.remove()
    file, packed = packed_away(tmp_path)
    assert packed.lacks == () and packed.needs[0].devices == ("CPU", "GPU")
    (picture,) = on_farm(file, {})
    assert differs(picture, seen) < NOISY and abs(picture.mean() / seen.mean() - 1.0) < 0.01


def test_a_device_that_runs_the_shader_and_traces_no_rays_shows_what_own_nodes_do_or_the_alarm(monkeypatch, tmp_path):
    """On a GPU trace() meets nothing and leaves no record; a message that no device knows stands for one here."""
    source = inlined_source
    monkeypatch.setattr(group, "inlined_source", lambda name: source(name).replace('"hit", hit', '"no such", hit'))
    for cut in (True, False):
        stage(with_group=False)
        # It is told of air, which one surface in 512 does not believe before it has asked.
        add_sphere("Ball", 0.5, nd.new_material("Ice", ior=1.31), location=(0.0, -1.0, 1.6))
        file, _ = packed_away(tmp_path, cut=cut)
        by_shader, without = on_farm(file, {}, WITHOUT_OSL)
        if cut:
            assert alarm(by_shader) == 0.0 and differs(by_shader, without) < SAME
        else:
            assert alarm(by_shader) > 0.35 and alarm(without) > 0.35


def test_frames_of_an_animation_are_those_that_each_frame_is_by_itself(tmp_path):
    """With data that Cycles keeps from frame to frame, a step, and media that ask and that are cut."""
    for cut in (True, False):
        stage()
        move()
        file, _ = packed_away(tmp_path, cut=cut)
        single = [on_farm(file, {}, frame=frame)[0] for frame in (1, 3)]
        folder = tmp_path / "farm"
        job = {"file": str(file), "output": str(folder / "f_####.exr"), "frames": [1, 3, 2]}
        run_jobs(folder, [job | {"settings": {"render.use_persistent_data": True}}])
        for frame, picture in zip((1, 3), single):
            assert differs(read_picture(folder / f"f_{frame:04d}.exr"), picture) < SAME
        assert not (folder / "f_0002.exr").exists() and differs(*single) > 0.05


def test_what_farms_change_of_a_picture_changes_no_light(tmp_path):
    """Size, samples, seed, tiles and bit depth: means and places stay."""
    stage()
    file, _ = packed_away(tmp_path)
    border = {"render.use_border": True, "render.border_max_x": 0.5, "render.use_crop_to_border": True}
    whole, large, fewer, seeded, tile, half = on_farm(
        file,
        {},
        {"render.resolution_percentage": 200},
        {"cycles.samples": SAMPLES // 2},
        {"cycles.seed": 7},
        border,
        {"render.image_settings.color_depth": "16"},
    )
    assert large.shape == (48, 48, 3) and tile.shape == (24, 12, 3)
    shrunk = large.reshape(24, 2, 24, 2, 3).mean(axis=(1, 3))
    for picture, reference in ((shrunk, whole), (fewer, whole), (seeded, whole), (tile, whole[:, :12]), (half, whole)):
        assert alarm(picture) == 0.0 and differs(picture, reference) < NOISY
        assert abs(picture.mean() / reference.mean() - 1.0) < 0.01
