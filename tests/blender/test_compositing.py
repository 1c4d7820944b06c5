"""Passes are added to the compositor once, and the flags of shadow caustics set and taken back."""

import bpy
import pytest
from passes import add_light, glass_before_stripes
from scenes import add_plane, add_sphere, diffuse

import nested_dielectric as nd
from nested_dielectric.scene.passes import add_compositor, compositors


def test_passes_are_added_once(tmp_path):
    scene = glass_before_stripes()
    scene.render.filepath = str(tmp_path / "shot_####.png")
    changes = nd.add_passes(scene)
    assert "Light Group of Ball: Media" in changes
    assert changes[-1].endswith(f"go to {tmp_path / 'shot_passes'}")
    (tree,) = compositors(scene)
    nodes = len(tree.nodes), len(bpy.data.node_groups)
    assert nd.add_passes(scene) == ()
    assert compositors(scene) == [tree] and (len(tree.nodes), len(bpy.data.node_groups)) == nodes


def test_passes_need_cycles():
    scene = glass_before_stripes(8)
    scene.render.engine = "BLENDER_EEVEE"
    assert nd.add_passes(scene) == (
        "scene 'Scene' renders with BLENDER_EEVEE; its passes are Cycles': prepare it first",
    )
    assert not compositors(scene) and not scene.objects["Ball"].lightgroup


def test_passes_say_what_they_cannot_part():
    scene = glass_before_stripes(8)
    add_sphere("Lens", 0.3, bpy.data.materials["Glass"]).lightgroup = "Key"
    add_plane("Screen", 1.0, (0, 9, 0), (0, -1, 0)).lightgroup = "Media"
    changes = nd.add_passes(scene)
    left = nd.add_passes(scene)
    assert len(left) == 2 and set(left) <= set(changes)
    assert left[0].startswith("'Lens' is in light group 'Key'")
    assert left[1].startswith("'Screen' is no medium, but in light group 'Media'")
    assert scene.objects["Lens"].lightgroup == "Key"


def test_compositing_that_the_artist_switched_off_stays_off():
    scene = glass_before_stripes(8)
    add_compositor(scene, bpy.data.node_groups.new("Artist's", "CompositorNodeTree"))
    scene.render.use_compositing = False
    assert any("Compositing is off" in change for change in nd.add_passes(scene))
    assert not scene.render.use_compositing


@pytest.mark.skipif(not hasattr(bpy.types.Scene, "compositor_effects"), reason="this Blender has one compositor alone")
def test_passes_go_into_an_effect_that_is_on_in_renders():
    scene = glass_before_stripes(8)
    trees = [bpy.data.node_groups.new(name, "CompositorNodeTree") for name in ("Off", "On")]
    for tree in trees:
        add_compositor(scene, tree)
    scene.render.use_compositing = True
    for effect in scene.compositor_effects:
        effect.enable_for_render = False
    assert any("No compositor effect is on" in change for change in nd.add_passes(scene))
    assert not any(tree.nodes for tree in trees)
    scene.compositor_effects[1].enable_for_render = True
    assert nd.add_passes(scene) and trees[1].nodes and not trees[0].nodes
    assert nd.add_passes(scene) == () and len(scene.compositor_effects) == 2


def caustic_flags():
    objects = bpy.context.scene.objects
    return (
        {obj.name for obj in objects if obj.cycles.is_caustics_caster},
        {obj.name for obj in objects if obj.cycles.is_caustics_receiver},
        {light.name for light in bpy.data.lights if light.cycles.is_caustics_light},
    )


def test_one_switch_sets_the_flags_of_shadow_caustics_and_takes_them_back():
    scene = glass_before_stripes(8)
    add_plane("Floor", 6.0, (0, 0, -1), (0, 0, 1), diffuse(0.5))
    add_plane("Hidden", 6.0, (0, 0, -1), (0, 0, 1), diffuse(0.5)).hide_render = True
    add_light((0, 0, 4))
    assert nd.set_shadow_caustics(scene) == (
        "Cast Shadow Caustics of Ball: on",
        "Receive Shadow Caustics of Floor: on",
        "Shadow Caustics of Lamp: on",
        "'Glass' is rough, for which shadow caustics are approximate; set Roughness to 0",
    )
    assert caustic_flags() == ({"Ball"}, {"Floor"}, {"Lamp"})
    assert nd.set_shadow_caustics(scene)[:-1] == ()
    assert len(nd.set_shadow_caustics(scene, False)) == 3
    assert caustic_flags() == (set(), set(), set())
    assert nd.set_shadow_caustics(scene, False) == ()


def test_shadow_caustics_say_what_would_be_counted_twice():
    scene = glass_before_stripes(8)
    bpy.data.objects["Ball"].data.materials[0] = nd.new_material("Clear", shadow_mode="OUTSIDE_FRESNEL")
    light = add_light((0, 0, 4))
    nd.set_shadow_caustics(scene)
    (shadow,) = nd.set_shadow_caustics(scene)
    assert shadow.startswith("'Clear' also lets light straight through")
    light.visible_transmission = False
    assert nd.set_shadow_caustics(scene)[1].startswith("'Clear' also casts light by its lobe")
