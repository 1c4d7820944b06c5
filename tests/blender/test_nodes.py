"""A nested dielectric is found wherever an artist puts its node, or named with the remedy."""

import os
import subprocess
import sys

import bpy
import pytest
from places_of_nodes import GROUP, duplicated, grouped, output_of, plug, renamed, twice_grouped
from scenes import add_sphere, new_scene

import nested_dielectric as nd
from nested_dielectric import registration
from nested_dielectric.checking.check import check as find_problems
from nested_dielectric.model.parameters import BY_KEYWORD
from nested_dielectric.nodes.places import dielectric_places
from nested_dielectric.preparation import live
from nested_dielectric.scene.materials import dielectric_node, get_parameter, medium_material, parameter_socket


def problems() -> list[str]:
    return [str(problem) for problem in find_problems(bpy.context.scene)]


def through_reroute(material) -> None:
    reroute = material.node_tree.nodes.new("NodeReroute")
    material.node_tree.links.new(material.node_tree.nodes[GROUP].outputs["Surface"], reroute.inputs[0])
    plug(material, reroute.outputs[0])


def through_mix(material, factor: float = 0.0) -> None:
    """What is mixed in is a foreign surface."""
    tree = material.node_tree
    mix, other = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeBsdfDiffuse")
    mix.inputs[0].default_value = factor
    tree.links.new(tree.nodes[GROUP].outputs["Surface"], mix.inputs[1])
    tree.links.new(other.outputs[0], mix.inputs[2])
    plug(material, mix.outputs[0])


def through_muted_mix(material) -> None:
    """A muted node lets its first shader through, whatever its factor is."""
    through_mix(material, 1.0)
    output_of(material).inputs["Surface"].links[0].from_node.mute = True


def hidden_by_mix(material) -> None:
    through_mix(material, 1.0)


def muted(material) -> None:
    material.node_tree.nodes[GROUP].mute = True


def unplugged(material) -> None:
    tree = material.node_tree
    tree.links.remove(output_of(material).inputs["Surface"].links[0])


def cut(material) -> None:
    """A muted link."""
    output_of(material).inputs["Surface"].links[0].is_muted = True


def grouped_and_dirty(material) -> None:
    through_mix(material, 0.0)
    grouped(material, exposed=())


WAYS = (through_reroute, through_mix, through_muted_mix, renamed, duplicated, grouped, twice_grouped, grouped_and_dirty)


def test_a_node_that_reaches_the_output_is_found_however():
    new_scene()
    tint = {"transmittance": (0.9, 0.5, 0.4), "transmittance_depth": 0.25}
    balls = {}
    for place, way in enumerate(WAYS):
        material = nd.new_material(way.__name__, ior=1.33, priority=4, abbe=40.0, **tint)
        balls[material] = add_sphere("Ball", 1.0, material, None, (3 * place, 0, 0), segments=8)
        way(material)
    named = "\n".join(problems())
    first = nd.prepare(bpy.context.scene)
    assert first.problems == () and nd.prepare(bpy.context.scene).changes == ()
    for way, (material, ball) in zip(WAYS, balls.items()):
        readable = way in WAYS[:3]
        assert (f"{material.name!r}" not in named) == readable
        assert any(change.startswith(f"{material.name}:") for change in first.changes) != readable
        assert medium_material(ball) == material and nd.get_priority(ball) == 4
        node = dielectric_node(material)
        assert node.name == GROUP and len(dielectric_places(material)) == 1
        for keyword, value in (tint | {"ior": 1.33, "abbe": 40.0}).items():
            assert get_parameter(node, BY_KEYWORD[keyword]) == pytest.approx(value)
        # What is set where the artist sets it, neighbours read from then on.
        parameter_socket(material, "IOR").default_value = 1.7
        parameter_socket(material, "Priority").default_value = 6
    nd.prepare(bpy.context.scene)
    for material, ball in balls.items():
        assert get_parameter(dielectric_node(material), BY_KEYWORD["ior"]) == pytest.approx(1.7)
        assert nd.get_priority(ball) == 6


def test_a_node_that_does_not_reach_the_output_makes_no_medium_and_is_named(capsys):
    new_scene()
    for way in (hidden_by_mix, muted, unplugged, cut):
        material = nd.new_material(way.__name__, ior=1.33)
        ball = add_sphere(f"Ball {way.__name__}", 1.0, material, segments=8)
        way(material)
        assert medium_material(ball) is None
        expected = f"{ball.name!r} has a nested dielectric in material {material.name!r} that does not reach the output"
        assert any(text.startswith(expected) for text in problems())
        registration.warn_before_render(bpy.context.scene)
        assert expected in capsys.readouterr().err
        with pytest.raises(nd.ParameterError, match="reaches its output"):
            nd.assign(ball, material)


def test_assigning_a_material_makes_its_node_readable():
    new_scene()
    for way in (renamed, duplicated, grouped):
        material = nd.new_material("Water", ior=1.33, priority=4)
        way(material)
        ball = add_sphere("Ball", 1.0, segments=8)
        nd.assign(ball, material)
        assert nd.get_priority(ball) == 4


def test_two_nested_dielectrics_in_one_material_are_named():
    new_scene()
    material = nd.new_material("Water", ior=1.33)
    add_sphere("Ball", 1.0, material)
    tree = material.node_tree
    mix, other = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeGroup")
    other.node_tree = tree.nodes[GROUP].node_tree
    tree.links.new(tree.nodes[GROUP].outputs["Surface"], mix.inputs[1])
    tree.links.new(other.outputs["Surface"], mix.inputs[2])
    plug(material, mix.outputs[0])
    (found,) = nd.prepare(bpy.context.scene).problems
    assert "2 nested dielectrics plugged into material 'Water'" in str(found)


def test_values_inside_a_group_that_neighbours_cannot_follow_are_named():
    new_scene()
    material = nd.new_material("Water", ior=1.33)
    add_sphere("Ball", 1.0, material)
    grouped(material)
    nd.prepare(bpy.context.scene)
    live.remove()
    own = material.node_tree.nodes["My Glass"].node_tree
    inside = own.nodes[GROUP]
    inside.inputs["Transmittance Depth"].keyframe_insert("default_value", frame=1)
    material.node_tree.nodes["My Glass"].inputs["IOR"].default_value = 1.4
    noise = own.nodes.new("ShaderNodeTexNoise")
    own.links.new(noise.outputs[0], inside.inputs["Abbe"])
    found = "\n".join(problems())
    assert "keyframes or a driver of 'Transmittance Depth'" in found and "Ungroup" in found
    assert "another 'IOR' in material 'Water' than its neighbours read: press Prepare Scene" in found
    assert "a link into 'Abbe'" in found


def test_a_muted_link_into_a_socket_is_none():
    new_scene()
    material = nd.new_material("Water", ior=1.33)
    add_sphere("Ball", 1.0, material)
    tree = material.node_tree
    link = tree.links.new(tree.nodes.new("ShaderNodeValue").outputs[0], tree.nodes[GROUP].inputs["IOR"])
    assert "a link into 'IOR'" in "\n".join(problems())
    link.is_muted = True
    assert problems() == []


def added_by_hand(name: str, **keywords) -> bpy.types.Material:
    """Add > Group > Nested Dielectric in a new material, with Surface alone plugged into the output that is there."""
    group = nd.new_material("Other").node_tree.nodes[GROUP].node_tree
    material = bpy.data.materials.new(name)
    node = material.node_tree.nodes.new("ShaderNodeGroup")
    node.node_tree = group
    plug(material, node.outputs["Surface"])
    for keyword, value in keywords.items():
        node.inputs[keyword].default_value = value
    return material


def test_a_node_added_by_hand_is_named_until_prepare_completes_it():
    new_scene()
    material = added_by_hand("Wine", Transmittance=(0.6, 0.1, 0.2, 1.0))
    ball = add_sphere("Ball", 1.0, material)
    assert medium_material(ball) is None and "whose node is named 'Group'" in "\n".join(problems())
    material.node_tree.nodes["Group"].name = GROUP
    found = "\n".join(problems())
    assert "whose Volume is not plugged in" in found and "EEVEE does not show" in found
    assert nd.prepare(bpy.context.scene).problems == ()
    node = material.node_tree.nodes[GROUP]
    wires = ("CYCLES", "Surface", "Surface"), ("CYCLES", "Volume", "Volume"), ("EEVEE", "Surface", "Preview")
    for target, socket, output in wires:
        (link,) = material.node_tree.get_output_node(target).inputs[socket].links
        assert link.from_socket == node.outputs[output]
    assert nd.prepare(bpy.context.scene).changes == ()


def test_a_group_that_gives_its_surface_alone_is_completed_beside_it():
    new_scene()
    material = nd.new_material("Wine", transmittance=(0.6, 0.1, 0.2))
    add_sphere("Ball", 1.0, material)
    tree = material.node_tree
    tree.nodes.remove(tree.get_output_node("EEVEE"))
    for link in tree.nodes[GROUP].outputs["Volume"].links:
        tree.links.remove(link)
    grouped(material)
    tree.nodes["My Glass"].name = GROUP  # as artists may name it
    assert nd.prepare(bpy.context.scene).problems == ()
    assert nd.prepare(bpy.context.scene).changes == ()
    node = tree.nodes[GROUP]
    assert get_parameter(node, BY_KEYWORD["transmittance"]) == pytest.approx((0.6, 0.1, 0.2))
    assert [output.name for output in node.outputs if output.is_linked] == ["Volume", "Preview"]
    assert dielectric_node(material) == node


def test_what_an_artist_has_plugged_in_stays_and_what_is_missing_is_named():
    new_scene()
    material = nd.new_material("Wine", transmittance=(0.6, 0.1, 0.2))
    add_sphere("Ball", 1.0, material)
    tree = material.node_tree
    scatter = tree.nodes.new("ShaderNodeVolumeScatter")
    tree.links.new(scatter.outputs[0], output_of(material).inputs["Volume"])
    own = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(own.outputs[0], tree.get_output_node("EEVEE").inputs["Surface"])
    material.use_transparent_shadow = False
    result = nd.prepare(bpy.context.scene)
    assert result.changes == ()
    texts = "\n".join(map(str, result.problems))
    assert "with an Add Shader node" in texts and "no Transparent Shadows" in texts
    both = tree.nodes.new("ShaderNodeAddShader")
    tree.links.new(scatter.outputs[0], both.inputs[0])
    tree.links.new(tree.nodes[GROUP].outputs["Volume"], both.inputs[1])
    tree.links.new(both.outputs[0], output_of(material).inputs["Volume"])
    material.use_transparent_shadow = True
    assert problems() == []


def test_a_dispersing_node_added_by_hand_gets_its_spectral_table():
    new_scene()
    material = added_by_hand("Prism", Disperse=True)
    add_sphere("Ball", 1.0, material)
    nd.prepare(bpy.context.scene)
    means, others = (
        tuple(each.node_tree.nodes[GROUP].inputs["Spectral Table Means"].default_value)
        for each in (material, bpy.data.materials["Other"])
    )
    assert means == others and any(means)


def test_what_changes_in_nodes_of_a_prepared_scene_is_read_at_once():
    new_scene()
    nd.register()
    try:
        glass, water = nd.new_material("Glass", ior=1.5), nd.new_material("Water", ior=1.33)
        grouped(glass, exposed=())
        add_sphere("Glass", 1.0, glass)
        ball = add_sphere("Water", 1.0, water, None, (0, 0, 5))
        nd.prepare(bpy.context.scene)
        parameter_socket(glass, "IOR").default_value = 2.0
        bpy.context.view_layer.update()
        assert dielectric_node(glass).inputs["IOR"].default_value == 2.0
        duplicated(water)
        water.node_tree.nodes[-1].inputs["Priority"].default_value = 3
        bpy.context.view_layer.update()
        assert nd.get_priority(ball) == 3
        assert get_parameter(dielectric_node(water), BY_KEYWORD["ior"]) == pytest.approx(1.33)
        assert problems() == []
    finally:
        nd.unregister()


MADE_WITH_OSLQUERY = """
import sys, tempfile
import bpy
from pathlib import Path
sys.path[:0] = map(str, Path(bpy.utils.resource_path("LOCAL")).glob("python/lib/*/site-packages"))
import oslquery  # or Cycles compiles no script that it is given
import nested_dielectric as nd
bpy.context.scene.render.engine = "CYCLES"
nd.new_material("Glass")
print(sorted(path.name for path in Path(tempfile.gettempdir()).iterdir() if path.suffix in (".osl", ".oso")))
"""


def test_a_new_material_leaves_no_compiled_shader_among_the_temporary_files(tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", MADE_WITH_OSLQUERY],
        env=os.environ | {"TMPDIR": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines()[-1] == "[]"
