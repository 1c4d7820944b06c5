"""Render passes of direct and indirect refraction and reflection."""

import math

import bpy
import numpy as np
import pytest
from passes import add_light, glass_before_stripes
from scenes import add, add_camera, add_plane, add_sphere, diffuse, new_scene, oiio, read_picture

import nested_dielectric as nd
from nested_dielectric.scene.lights import update_lights
from nested_dielectric.scene.passes import PASSES, add_compositor

SAMPLES = 16


def read_passes(path) -> dict[str, np.ndarray]:
    """The layers of an OpenEXR file by name; (height, width, 3) floats each."""
    file = oiio.ImageInput.open(str(path))
    assert file is not None
    layers = {}
    while file.seek_subimage(len(layers), 0):
        spec = file.spec()
        assert str(spec.format) == "float"
        names = [channel.rpartition(".")[0] for channel in spec.channelnames]
        assert set(names) == {names[0]}
        places = [spec.channelnames.index(f"{names[0]}.{channel}") for channel in "RGB"]
        pixels = oiio.ImageBuf(str(path), len(layers), 0).get_pixels(oiio.FLOAT)
        layers[names[0]] = np.array(pixels)[..., places].astype(np.float64)
    file.close()
    return layers


def render_passes(folder, samples=SAMPLES):
    """The picture and the passes of the current scene."""
    scene = bpy.context.scene
    scene.cycles.samples = samples
    scene.render.filepath = str(folder / "picture.exr")
    update_lights(scene)
    nd.add_passes(scene)
    bpy.ops.render.render(write_still=True)
    return read_picture(folder / "picture.exr"), read_passes(folder / "picture_passes.exr")


def assert_sum(picture, passes):
    # Both add up the same samples: single precision through one division by the colours of the surface, and sums.
    np.testing.assert_allclose(sum(passes.values()), picture, rtol=5e-6, atol=1e-6)


@pytest.mark.parametrize("seen", [True, False])
def test_direct_refraction_is_what_lobes_carry_and_the_four_passes_make_the_picture(tmp_path, seen):
    glass_before_stripes()
    add_light((0.5, 3.0, 0.5), visible_transmission=seen, visible_glossy=seen)
    picture, passes = render_passes(tmp_path)
    assert tuple(passes) == PASSES
    assert_sum(picture, passes)
    direct = passes["Direct Refraction"].mean()
    if seen:
        assert direct == 0.0
    else:
        # The light is seen through the ball, a hundred times brighter than the stripes.
        assert direct > 10.0 * passes["Indirect Refraction"].mean()
    assert all(layer.min() >= 0.0 for layer in passes.values())


def test_a_lobe_of_direct_reflection_is_direct_specular(tmp_path):
    def render(energy):
        glass_before_stripes()
        light = add_light((0.0, -4.0, 3.0), visible_transmission=True, visible_glossy=False)
        light.data.energy = energy
        picture, passes = render_passes(tmp_path)
        assert_sum(picture, passes)
        return passes

    dark, light = render(0.0), render(300.0)
    assert light["Direct Specular"].mean() > 2.0 * dark["Direct Specular"].mean()
    # A rough ray may leave the ball between two of its corners and meet it once more.
    assert light["Direct Refraction"].mean() < 1e-3 * light["Direct Specular"].mean()


def test_a_dispersing_medium_around_another_keeps_the_sum(tmp_path):
    scene = glass_before_stripes()
    material = nd.new_material("Prism", "sf11", disperse=True, transmittance=(0.8, 0.5, 0.2), transmittance_depth=1.0)
    bpy.data.objects["Ball"].data.materials[0] = material
    add_sphere("Drop", 0.4, nd.new_material("Water", "water", roughness=0.2), priority=1)
    add_light((0.5, 3.0, 0.5), visible_transmission=False)
    nd.prepare(scene)
    picture, passes = render_passes(tmp_path)
    assert passes["Direct Refraction"].mean() > 0.0
    assert_sum(picture, passes)


def test_light_of_lobes_on_a_floor_is_no_refraction(tmp_path):
    scene = glass_before_stripes()
    scene.cycles.caustics_reflective = scene.cycles.caustics_refractive = True
    scene.camera.data.ortho_scale = 6.0
    add_plane("Floor", 20.0, (0, 0, -1), (0, 0, 1), diffuse(0.7))
    add_light((0.5, 3.0, 2.0), visible_transmission=False, visible_glossy=False)
    _, passes = render_passes(tmp_path)
    assert all(layer.min() >= 0.0 for layer in passes.values())
    bottom = {name: layer[-2:].mean() for name, layer in passes.items()}
    assert bottom == dict.fromkeys(PASSES, 0.0)
    assert passes["Direct Refraction"].max() > 0.0


def test_passes_leave_an_existing_compositor_and_its_picture_alone(tmp_path):
    scene = glass_before_stripes(8)
    tree = bpy.data.node_groups.new("Artist's", "CompositorNodeTree")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    add_compositor(scene, tree)
    source, invert = tree.nodes.new("CompositorNodeRLayers"), tree.nodes.new("CompositorNodeInvert")
    output = tree.nodes.new("NodeGroupOutput")
    tree.links.new(source.outputs["Image"], invert.inputs["Color"])
    tree.links.new(invert.outputs["Color"], output.inputs["Image"])

    def picture():
        scene.cycles.samples = SAMPLES
        scene.render.filepath = str(tmp_path / "picture.exr")
        bpy.ops.render.render(write_still=True)
        return read_picture(tmp_path / "picture.exr")

    before = picture()
    assert before.min() < 0.5  # inverted
    nd.add_passes(scene)
    np.testing.assert_array_equal(picture(), before)
    assert tuple(read_passes(tmp_path / "picture_passes.exr")) == PASSES
    assert invert.inputs["Color"].links[0].from_node == source
    assert output.inputs["Image"].links[0].from_node == invert


def test_a_new_compositor_leaves_the_picture_alone(tmp_path):
    scene = glass_before_stripes(8)
    scene.render.film_transparent = True
    scene.camera.data.ortho_scale = 3.0

    def pixels():
        scene.cycles.samples = SAMPLES
        scene.render.filepath = str(tmp_path / "picture.exr")
        bpy.ops.render.render(write_still=True)
        return np.array(oiio.ImageBuf(scene.render.filepath).get_pixels(oiio.FLOAT))

    before = pixels()
    nd.add_passes(scene)
    np.testing.assert_array_equal(pixels(), before)
    assert before.shape[-1] == 4 and before[..., 3].min() == 0.0


def test_every_view_layer_that_renders_writes_a_file_of_its_own(tmp_path):
    scene = glass_before_stripes(8)
    scene.cycles.samples = 1
    scene.render.filepath = str(tmp_path / "picture.exr")
    scene.view_layers[0].name = "Front"
    scene.view_layers.new("Back/Far")
    scene.view_layers.new("Off").use = False
    nd.add_passes(scene)
    assert nd.add_passes(scene) == ()
    scene.view_layers["Front"].name = "Near"
    assert nd.add_passes(scene) == ()
    bpy.ops.render.render(write_still=True)
    assert {path.name for path in tmp_path.iterdir()} == {
        "picture.exr",
        "picture_passes_Front.exr",
        "picture_passes_Back_Far.exr",
    }


def test_passes_come_with_the_file(tmp_path):
    scene = glass_before_stripes(8)
    scene.cycles.samples = 1
    scene.render.filepath = str(tmp_path / "picture.exr")
    nd.add_passes(scene)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "scene.blend"))
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "scene.blend"))
    assert nd.add_passes(bpy.context.scene) == ()
    bpy.ops.render.render(write_still=True)
    assert tuple(read_passes(tmp_path / "picture_passes.exr")) == PASSES


def test_caustics_of_a_smooth_ball_are_brighter_with_the_switch_than_its_shadow():
    """Where a walk leads through the ball, the floor is lit by a light without a size, which no path finds."""
    scene = new_scene(8)
    add_sphere("Ball", 0.7, nd.new_material("Glass", ior=1.3, shadow_mode="BLACK"), location=(0, 0, 1))
    add_plane("Floor", 6.0, (0, 0, 0), (0, 0, 1), diffuse(0.5))
    light = bpy.data.lights.new("Lamp", "POINT")
    light.energy, light.shadow_soft_size = 100.0, 0.0
    add("Lamp", light, (0, 0, 4))
    scene.objects["Ball"].visible_camera = False
    add_camera((0.01, 0.02, 3.0), (0.01, 0.02, 0.0), width=0.3)

    def brightness(enabled):
        nd.set_shadow_caustics(scene, enabled)
        scene.cycles.samples = 4
        scene.render.filepath = str(bpy.app.tempdir) + "caustics.exr"
        bpy.ops.render.render(write_still=True)
        return read_picture(scene.render.filepath).mean()

    shadow, caustic = brightness(False), brightness(True)
    unobstructed = 100.0 / (16.0 * math.pi**2 * 4.0**2) * 4.0 * 0.5 / 4.0
    assert shadow < 1e-6
    assert caustic > unobstructed
