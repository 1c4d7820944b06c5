"""What the extension keeps in a file may be changed, removed or another's: it is replaced or named, and never trusted."""

import itertools

import bpy
import numpy as np
import pytest
from scenes import add_box, add_point_light, add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric.analysis.mesh_modifiers import is_offset
from nested_dielectric.analysis.surroundings import clear_analysis
from nested_dielectric.checking.check import check as find_problems
from nested_dielectric.model.presets import load_preset
from nested_dielectric.model.spectral_tables import spectral_table
from nested_dielectric.nodes.lights_group import find_lights
from nested_dielectric.nodes.material_version import find_group
from nested_dielectric.nodes.names import OFFSET_ATTRIBUTE, OFFSET_GROUP
from nested_dielectric.nodes.spectral_tables import uses_table
from nested_dielectric.scene import media
from nested_dielectric.scene.lights import listed_lights
from nested_dielectric.scene.material_spectra import material_table, spectrum_settings, usable_spectrum_settings
from nested_dielectric.scene.passes import add_passes
from nested_dielectric.scene.preset_materials import is_preset

NODE = "Nested Dielectric"


def build() -> bpy.types.Scene:
    """A dispersing ball across the surface of water that stands exactly on glass, and a light that a lobe carries."""
    scene = new_scene(8)
    ball = add_sphere("Ball", 0.6, nd.new_material("Prism", preset="bk7", disperse=True), segments=16)
    ball["nd_priority"] = 1
    water = nd.new_material("Sea", preset="water")
    add_box("Water", (-1, -1, -1), (1, 1, 0.1), water)
    add_box("Floor", (-1, -1, -1.5), (1, 1, -1), nd.new_material("Floor", preset="glass"))
    add_box("Far", (5, 5, 5), (6, 6, 6), water)
    add_point_light((2.0, 2.0, 4.0), 100.0)
    bpy.data.objects["Lamp"].visible_transmission = False
    nd.prepare(scene)
    return scene


def group() -> bpy.types.NodeTree:
    return find_group()


def image() -> bpy.types.Image:
    return group().nodes["Spectral Tables"].image


def material(name: str) -> bpy.types.Material:
    return bpy.data.materials[name]


def assert_prepared(scene: bpy.types.Scene) -> None:
    """Everything is as in a scene that nobody touched."""
    assert nd.prepare(scene).changes == () and find_problems(scene) == []
    node = material("Prism").node_tree.nodes[NODE]
    assert node.node_tree == group() and uses_table(node, spectral_table(gamut="REC709"))
    assert np.array_equal(material_table(material("Prism")), spectral_table(gamut="REC709"))
    assert listed_lights(bpy.context.scene) == [bpy.data.objects["Lamp"]]
    assert [obj.name for obj in media.media(scene)] == ["Ball", "Floor", "Far", "Water"]


def take_name(collection, name: str, *arguments):
    """Another's data-block comes by the name of one of ours."""
    if name in collection:
        collection[name].name = "Put Away"
    return collection.new(name, *arguments)


DAMAGES = {
    "the tables have lost their mark": lambda: image().pop("nd_tables"),
    "the mark of the tables is a word": lambda: image().__setitem__("nd_tables", "junk"),
    "somebody painted on the tables": lambda: image().pixels.foreach_set(np.ones(len(image().pixels), np.float32)),
    "the tables are scaled": lambda: image().scale(64, 7),
    "the tables are removed": lambda: bpy.data.images.remove(image()),
    "the tables are taken for colours": lambda: setattr(image().colorspace_settings, "name", "sRGB"),
    "an artist's picture stands in their place": lambda: setattr(
        group().nodes["Spectral Tables"], "image", bpy.data.images.new("Photo", 8, 8)
    ),
    "the number of tables is another": lambda: setattr(
        group().nodes["Spectral Coordinate"].inputs["Tables"], "default_value", 90
    ),
    "the row is none": lambda: setattr(
        material("Prism").node_tree.nodes[NODE].inputs["Spectral Table"], "default_value", -9
    ),
    "the row's means are none": lambda: setattr(
        material("Prism").node_tree.nodes[NODE].inputs["Spectral Table Means"], "default_value", (float("nan"),) * 3
    ),
    "the version is a word": lambda: group().__setitem__("nd_version", "junk"),
    "the version is a list": lambda: group().__setitem__("nd_version", [3, 3]),
    "the version is below all": lambda: group().__setitem__("nd_version", -3),
    "the version is gone": lambda: group().pop("nd_version"),
    "the shader is gone": lambda: group().nodes.remove(group().nodes["Nested Dielectric Shader"]),
    "the shader is another's": lambda: setattr(group().nodes["Nested Dielectric Shader"], "mode", "EXTERNAL"),
    "the tables' node is gone": lambda: group().nodes.remove(group().nodes["Spectral Tables"]),
    "the lights' node is empty": lambda: setattr(group().nodes["Nested Dielectric Lights"], "node_tree", None),
    "a socket is gone": lambda: group().interface.remove(group().interface.items_tree["Abbe"]),
    "a socket is of another kind": lambda: setattr(
        group().interface.items_tree["Abbe"], "socket_type", "NodeSocketColor"
    ),
    "an analysis' socket is gone": lambda: group().interface.remove(group().interface.items_tree["Surroundings"]),
    "the lights' drivers are gone": lambda: find_lights().animation_data_clear(),
    "a light's driver has lost its target": lambda: [
        curve.driver.variables.remove(curve.driver.variables[0]) for curve in find_lights().animation_data.drivers
    ],
    "a driver of a light is gone": lambda: find_lights().animation_data.drivers.remove(
        find_lights().animation_data.drivers[-1]
    ),
    "the lights' group holds an artist's script": lambda: find_lights().nodes.new("ShaderNodeScript"),
    "another group has the lights' name": lambda: take_name(
        bpy.data.node_groups, "Nested Dielectric Lights", "GeometryNodeTree"
    ),
    "another group has the group's name": lambda: take_name(bpy.data.node_groups, NODE, "CompositorNodeTree"),
    "the lights' group has lost an output": lambda: find_lights().interface.remove(
        find_lights().interface.items_tree["Axis"]
    ),
    "the texts are gone": lambda: [bpy.data.texts.remove(text) for text in list(bpy.data.texts)],
    "the texts are written over": lambda: [text.from_string("junk") for text in bpy.data.texts],
    "an object's facts are a word": lambda: bpy.data.objects["Water"].__setitem__("nd_outside", "junk"),
    "an object's facts are one number": lambda: bpy.data.objects["Water"].__setitem__("nd_outside", 66.0),
    "an object's facts are none": lambda: bpy.data.objects["Water"].__setitem__("nd_outside", [float("nan")] * 4),
    "an object's facts are many": lambda: bpy.data.objects["Water"].__setitem__("nd_outside", [1.0] * 9),
    "an object's facts are a group": lambda: bpy.data.objects["Water"].__setitem__("nd_outside", {"a": 1}),
    "an object's facts are whole numbers": lambda: bpy.data.objects["Water"].__setitem__(
        "nd_outside_transmittance", [1, 1, 1, 1]
    ),
    "the scene's mark is a group": lambda: bpy.context.scene.__setitem__("nd_analysed", {"a": 1}),
}


def test_what_others_changed_is_as_before_after_preparing():
    scene = build()
    for damage, do in DAMAGES.items():
        try:
            do()
            find_problems(scene)
            nd.prepare(scene)
            assert_prepared(scene)
        except Exception as error:
            raise AssertionError(damage) from error
    assert {picture.name: tuple(picture.size) for picture in bpy.data.images}["Photo"] == (8, 8)
    clear_analysis(scene)
    nd.prepare(scene)
    assert_prepared(scene)


def test_a_damaged_node_group_is_named_until_the_scene_is_prepared():
    scene = build()
    DAMAGES["a socket is gone"]()
    texts = "\n".join(map(str, find_problems(scene)))
    assert "'Ball'" in texts and "is damaged" in texts and "press Prepare Scene" in texts
    changes = nd.prepare(scene).changes
    assert "Prism: was damaged" in changes and "Sea: was damaged" in changes


ATTRIBUTES = [("FLOAT_COLOR", "CORNER"), ("INT8", "POINT"), ("BOOLEAN", "FACE"), ("STRING", "POINT"), ("FLOAT", "EDGE")]


def test_attributes_of_another_form_are_replaced_where_ours_are_needed():
    scene = build()
    for kind, domain in ATTRIBUTES:
        clear_analysis(scene)
        for obj in (obj for obj in scene.objects if obj.type == "MESH"):
            obj.modifiers.clear()
            for attribute in [each for each in obj.data.attributes if each.name.startswith(OFFSET_ATTRIBUTE)]:
                obj.data.attributes.remove(attribute)
            obj.data.attributes.new(OFFSET_ATTRIBUTE, kind, domain)
        nd.prepare(scene)
        parted = [obj for obj in scene.objects if any(map(is_offset, obj.modifiers))]
        assert parted
        for obj in parted:
            offsets = [each for each in obj.data.attributes if each.name.startswith(OFFSET_ATTRIBUTE)]
            assert ("FLOAT_VECTOR", "POINT") in [(each.data_type, each.domain) for each in offsets]
        clear_analysis(scene)
        # What was never ours stays.
        far = bpy.data.objects["Far"].data.attributes[OFFSET_ATTRIBUTE]
        assert (far.data_type, far.domain) == (kind, domain)


@pytest.mark.parametrize("end", (nd.analyse, clear_analysis))
def test_what_older_versions_told_the_faces_of_a_mesh_is_taken_away(end):
    scene = build()
    ball, far = (bpy.data.objects[name].data.attributes for name in ("Ball", "Far"))
    ball.new("nd_outside", "INT8", "FACE")
    far.new("nd_outside", "FLOAT", "FACE")  # somebody else's
    end(scene)
    assert "nd_outside" not in ball and "nd_outside" in far


def test_a_modifier_by_our_name_that_does_something_else_is_not_trusted():
    scene = new_scene()
    tree = take_name(bpy.data.node_groups, OFFSET_GROUP, "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    ends = [tree.nodes.new(kind) for kind in ("NodeGroupInput", "GeometryNodeTransform", "NodeGroupOutput")]
    for first, second in itertools.pairwise(ends):
        tree.links.new(first.outputs[0], second.inputs["Geometry"] if second != ends[-1] else second.inputs[0])
    upper = add_box("Upper", (-1, -1, 0), (1, 1, 1), nd.new_material("Glass", preset="glass"))
    lower = add_box("Lower", (-1, -1, -1), (1, 1, 0), nd.new_material("Sea", preset="water"))
    upper.modifiers.new(OFFSET_GROUP, "NODES").node_group = tree
    found = nd.prepare(scene).found
    assert not is_offset(upper.modifiers[0]) and [name for name, _ in found.doubts] == ["Upper"]
    upper.modifiers.clear()
    nd.prepare(scene)
    (modifier,) = lower.modifiers
    assert is_offset(modifier) and modifier.node_group != tree and modifier.node_group.name != OFFSET_GROUP


def test_parting_starts_anew_where_the_modifier_was_removed():
    scene = new_scene()
    add_box("Upper", (-1, -1, 0), (1, 1, 1), nd.new_material("Glass", preset="glass"))
    lower = add_box("Lower", (-1, -1, -1), (1, 1, 0), nd.new_material("Sea", preset="water"))

    def offset():
        nd.prepare(scene)
        values = np.empty(3 * len(lower.data.vertices), np.float32)
        lower.data.attributes[OFFSET_ATTRIBUTE].data.foreach_get("vector", values)
        return values

    before = offset()
    lower.modifiers.clear()
    assert before.any() and offset() == pytest.approx(before, rel=1e-3)


def test_a_node_by_our_name_that_is_another_makes_no_medium():
    scene = build()
    other = bpy.data.materials.new("Other")
    other.node_tree.nodes["Principled BSDF"].name = NODE
    add_box("Block", (3, 3, 3), (4, 4, 4), other)
    frame = bpy.data.materials.new("Group")
    node = frame.node_tree.nodes.new("ShaderNodeGroup")
    node.name = NODE
    add_box("Empty", (4, 4, 4), (5, 5, 5), frame)
    assert_prepared(scene)
    node.node_tree = take_name(bpy.data.node_groups, "Foreign", "ShaderNodeTree")
    assert_prepared(scene)


SETTINGS = {
    "spectral_distribution": 7,
    "spectral_gamut": [1, 2],
    "spectral_saturation": "junk",
    "clamp_negative": {"a": 1},
}


def test_odd_settings_of_a_spectrum_are_named_and_shown_as_the_default():
    scene = build()
    prism = material("Prism")
    usual = spectrum_settings(prism)
    for keyword, value in SETTINGS.items():
        prism[keyword] = value
        (problem,) = nd.prepare(scene).problems
        assert problem.name == "Prism" and keyword in problem.text
        assert usable_spectrum_settings(prism) == usual
        prism.pop(keyword)
    assert_prepared(scene)


def test_a_compositing_group_of_ours_that_lost_a_socket_is_made_anew():
    scene = build()
    add_passes(scene)
    tree = next(tree for tree in bpy.data.node_groups if "nd_passes" in tree)
    tree.interface.remove(tree.interface.items_tree["Direct Refraction"])
    bpy.data.node_groups.new("Other", "ShaderNodeTree")["nd_passes"] = True
    add_passes(scene)
    assert add_passes(scene) == ()


# What an artist does to materials, priorities and colours


def test_a_preset_is_never_what_somebody_has_changed():
    new_scene()
    objects = [add_sphere(name, 1.0, segments=8) for name in "ABCDEF"]
    first = nd.assign(objects[0], "water")
    assert nd.assign(objects[1], "water") == first
    first.node_tree.nodes[NODE].inputs["Transmittance"].default_value = (1.0, 0.2, 0.2, 1.0)
    second = nd.assign(objects[2], "water")
    assert second != first
    assert tuple(second.node_tree.nodes[NODE].inputs["Transmittance"].default_value)[:3] == (1, 1, 1)
    assert nd.assign(objects[3], "water") == second
    second["spectral_saturation"] = 0.5
    third = nd.assign(objects[4], "water")
    assert third not in (first, second)
    third.node_tree.nodes[NODE].inputs["IOR"].keyframe_insert("default_value")
    assert nd.assign(objects[5], "water") not in (first, second, third)


def test_a_preset_of_every_kind_knows_its_own_material_again():
    """One for each group and each set of parameters that a file has."""
    new_scene()
    kinds = {(preset.group, *preset.parameters): preset for preset in map(load_preset, nd.preset_names())}
    for preset in kinds.values():
        assert is_preset(nd.new_material("Any", preset=preset.key), preset), preset.key
        assert not is_preset(nd.new_material("Any", preset=preset.key, roughness=0.0123), preset), preset.key


def test_only_what_animates_the_dispersion_switches_motion_blur_on():
    scene = new_scene()
    glass = nd.new_material("Glass", preset="glass")
    add_sphere("Ball", 1.0, glass, segments=8)
    inputs = glass.node_tree.nodes[NODE].inputs
    inputs["IOR"].keyframe_insert("default_value")
    inputs["Roughness"].driver_add("default_value").driver.expression = "0.2"
    nd.prepare(scene)
    assert not scene.render.use_motion_blur
    inputs["Disperse"].keyframe_insert("default_value")
    nd.prepare(scene)
    assert scene.render.use_motion_blur and scene.render.motion_blur_shutter == 0.0
    inputs["Disperse"].keyframe_delete("default_value")
    changes = nd.prepare(scene).changes
    assert "Motion Blur: on -> off" in changes and not scene.render.use_motion_blur
    assert scene.render.motion_blur_shutter == 0.5 and nd.prepare(scene).changes == ()
    inputs["Disperse"].driver_add("default_value").driver.expression = "1"
    nd.prepare(scene)
    assert scene.render.use_motion_blur


def test_motion_blur_that_blurs_stays_on_where_nothing_disperses():
    scene = new_scene()
    add_sphere("Ball", 1.0, nd.new_material("Glass", preset="glass"), segments=8)
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.25
    nd.prepare(scene)
    assert scene.render.use_motion_blur and scene.render.motion_blur_shutter == 0.25
