"""Lights through the lobe of direct refraction, against Cycles' own rough refraction lit by the same lights."""

import bpy
import numpy as np
import pytest
from direct_lights import SIZES, add_light, slab
from scenes import (
    add,
    add_box,
    add_camera,
    add_plane,
    add_sphere,
    diffuse,
    mostly_again,
    new_scene,
    render,
    set_striped_world,
    set_world,
)

import nested_dielectric as nd
from nested_dielectric.scene import lights


def picture(samples=64):
    bpy.context.view_layer.update()
    lights.update_lights(bpy.context.scene)
    return render(samples)


def through_slab(kind="POINT", lobe=True, samples=64, **keywords):
    slab(**keywords)
    add_light(kind, lobe)
    return picture(samples)


@pytest.mark.parametrize("kind", mostly_again(SIZES, 2))
def test_the_lobe_refracts_as_much_of_a_light_as_rays(kind):
    rays, lobe = (through_slab(kind, lobe, samples=512) for lobe in (False, True))
    assert rays.mean() > 0.1
    # 524,288 paths leave 0.2 % on either side.
    assert lobe.mean(axis=(0, 1)) == pytest.approx(rays.mean(axis=(0, 1)), rel=1e-2)


def test_the_lobe_refracts_as_much_through_a_rough_ball():
    """Towards its edge the far side of a ball would reflect all light, were it smooth."""
    means = []
    for lobe in (False, True):
        slab()
        bpy.data.objects.remove(bpy.data.objects["Slab"])
        add_sphere("Ball", 0.6, bpy.data.materials["Glass"])
        add_light("AREA", lobe)
        means.append(picture(1024).mean())
    assert means[0] > 0.1
    # 1,048,576 paths leave 0.3 % on either side.
    assert means[1] == pytest.approx(means[0], rel=1e-2)


def off_slab(lobe=True, samples=16, **keywords):
    """A light before the slab, which reflects and does not refract."""
    slab(specular_scale=1.0, refraction_scale=0.0, **keywords)
    light = add_light()
    light.location = (0.5, -4.0, 1.5)
    light.visible_glossy = not lobe
    return picture(samples)


def test_the_lobe_reflects_as_much_of_a_light_as_rays():
    means = [off_slab(lobe, samples=256).mean() for lobe in (False, True)]
    assert means[0] > 0.01
    assert means[1] == pytest.approx(means[0], rel=1e-2)


def test_several_lights_add_up():
    slab()
    add_light("POINT", True)
    add_light("AREA", True).location.x = -0.8
    together = picture(256).mean()
    slab()
    add_light("AREA", True).location.x = -0.8
    assert together == pytest.approx(picture(256).mean() + through_slab("POINT", samples=256).mean(), rel=2e-2)


@pytest.mark.parametrize(
    "keywords",
    mostly_again(
        (
            {"roughness": 0.4, "separate_direct_lobe": True, "direct_roughness": 0.4},
            {"roughness": 0.4, "separate_direct_lobe": True, "direct_roughness": 0.1, "direct_roughness_offset": 0.3},
            {
                "roughness": 0.4,
                "separate_direct_lobe": True,
                "direct_roughness": 0.2,
                "direct_roughness_depth_multiplier": 2.0,
            },
            {"roughness": 0.4, "separate_direct_lobe": True, "direct_roughness_depth_adder": 0.4},
            {"roughness": 0.4, "separate_direct_lobe": True, "direct_roughness": 0.2, "direct_second_scale": 1.0},
            {
                "roughness": 0.4,
                "separate_direct_lobe": True,
                "direct_roughness": 0.1,
                "direct_second_scale": 1.0,
                "direct_second_roughness_multiplier": 4.0,
            },
        ),
        2,
    ),
    ids=lambda keywords: " ".join(keywords),
)
def test_every_way_to_a_roughness_is_the_same_lobe(keywords):
    """The exit is reached after one bounce, so a depth multiplier counts once."""
    assert through_slab(samples=16, **keywords) == pytest.approx(through_slab(samples=16), rel=1e-3, abs=1e-5)


def test_a_second_lobe_shares_the_light():
    def mixed(share):
        return through_slab(samples=16, direct_second_scale=share, direct_second_roughness_multiplier=1.5)

    assert mixed(0.25) == pytest.approx(0.75 * mixed(0.0) + 0.25 * mixed(1.0), rel=1e-3, abs=1e-5)
    assert not np.allclose(mixed(1.0), mixed(0.0), rtol=0.05)


def test_direct_refraction_scales_the_lights_alone():
    assert through_slab(samples=16, direct_refraction=0.5) == pytest.approx(0.5 * through_slab(samples=16), rel=1e-4)
    rays = through_slab(lobe=False, samples=16)
    assert through_slab(lobe=False, samples=16, direct_refraction=0.0) == pytest.approx(rays, rel=1e-4)


def test_the_separate_lobe_has_its_own_distribution_and_anisotropy():
    own = {"separate_direct_lobe": True, "direct_roughness": 0.4}
    beckmann = through_slab(samples=16, direct_distribution="BECKMANN", **own)
    assert not np.allclose(beckmann, through_slab(samples=16, **own), rtol=0.05)
    stretched = through_slab(samples=16, direct_anisotropy=0.6, **own)
    turned = through_slab(samples=16, direct_anisotropy=-0.6, **own)
    assert not np.allclose(stretched, turned, rtol=0.05)


def test_direct_reflection_scales_its_lobe():
    assert off_slab(direct_reflection=0.25) == pytest.approx(0.25 * off_slab(), rel=1e-4)


def test_what_stands_between_shades_the_lobe():
    slab()
    add_light(lobe=True)
    add_plane("Shade", 3, (0.2, 2.0, 0.5), (0, -1, 0), diffuse(0.0))
    assert picture(16).max() == 0.0


def test_a_light_is_followed_where_a_parent_and_an_animation_take_it():
    means = []
    for lobe in (False, True):
        slab()
        light = add_light("AREA", lobe)
        parent = add("Parent", None)
        light.parent = parent
        for frame, x in ((1, 0.0), (11, 2.0)):
            parent.location.x = x
            parent.rotation_euler.z = 0.3 * x
            parent.keyframe_insert("location", frame=frame)
            parent.keyframe_insert("rotation_euler", frame=frame)
            light.data.energy = 100.0 + 300.0 * x
            light.data.keyframe_insert("energy", frame=frame)
        bpy.context.scene.frame_set(1)
        picture(4)
        bpy.context.scene.frame_set(8)
        means.append(render(256).mean())
    assert means[0] > 0.02
    assert means[1] == pytest.approx(means[0], rel=1e-2)


def floor_below(**keywords):
    """A floor that only light of a light above a slab could reach, through the lobe."""
    new_scene(16)
    set_world((0.0, 0.0, 0.0))
    material = nd.new_material("Glass", ior=1.5, shadow_mode="BLACK", direct_roughness_offset=0.3, **keywords)
    add_box("Slab", (-20, -20, 1.0), (20, 20, 1.2), material)
    add_plane("Floor", 4, (0, 0, 0), (0, 0, 1), diffuse(0.8))
    light = add_light(lobe=True)
    light.location = (0.0, 0.0, 3.0)
    add_camera((0.0, -1.5, 0.7), (0, 0, 0), angle=30)
    return picture(256)


def test_direct_refraction_makes_caustics_that_can_be_switched_off_and_made_rougher():
    soft = floor_below(caustic_roughness_offset=0.2)
    assert soft.mean() > 0.1
    assert floor_below(caustic_direct_refraction=False).max() == 0.0
    sharp = floor_below(caustic_roughness_offset=0.0)
    assert sharp.max() / sharp.mean() > 1.2 * soft.max() / soft.mean()


def test_direct_reflection_makes_caustics_that_can_be_switched_off():
    def floor(**keywords):
        new_scene(16)
        set_world((0.0, 0.0, 0.0))
        material = nd.new_material(
            "Glass", ior=2.5, roughness=0.5, shadow_mode="BLACK", refraction_scale=0.0, **keywords
        )
        add_box("Mirror", (-20, -20, 2.0), (20, 20, 2.2), material)
        add_plane("Floor", 4, (0, 0, 0), (0, 0, 1), diffuse(0.8))
        light = add_light()
        light.location = (0.0, 0.0, 0.7)
        light.visible_glossy = light.visible_diffuse = False
        add_camera((0.0, -1.5, 0.7), (0, 0, 0), angle=30)
        return picture(64)

    with_it, without = (floor(caustic_direct_reflection=on).mean() for on in (True, False))
    assert with_it > 0.01
    assert without < 0.01 * with_it


def test_direct_caustics_need_no_indirect_ones():
    alone = floor_below(caustic_refraction=False)
    assert alone.mean() == pytest.approx(floor_below().mean(), rel=0.05)


def test_direct_world_blurs_the_world_alone():
    def view(**keywords):
        slab(roughness=0.0, direct_roughness_offset=0.6, **keywords)
        set_striped_world()
        return render(64)

    def contrast(image):
        return image.std() / image.mean()

    assert contrast(view(direct_world=True)) < 0.7 * contrast(view())
