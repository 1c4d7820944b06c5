"""A nested dielectric is found wherever an artist puts its node, or named with the remedy."""

import bpy
import numpy as np
import pytest
from scenes import add_camera, add_sphere, new_scene, render, set_striped_world

import nested_dielectric as nd
from nested_dielectric import registration
from nested_dielectric.model.parameters import BY_KEYWORD
from nested_dielectric.nodes.trees import dielectric_places, socket_value
from nested_dielectric.preparation import live
from nested_dielectric.preparation.checks import find_problems
from nested_dielectric.scene.materials import dielectric_node, get_parameter, medium_material, parameter_socket

GROUP = "Nested Dielectric"


def problems() -> list[str]:
    return [str(problem) for problem in find_problems(bpy.context.scene)]


def output_of(material: bpy.types.Material) -> bpy.types.Node:
    return material.node_tree.get_output_node("CYCLES")


def plug(material: bpy.types.Material, socket: bpy.types.NodeSocket) -> None:
    material.node_tree.links.new(socket, output_of(material).inputs["Surface"])


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


def renamed(material) -> None:
    material.node_tree.nodes[GROUP].name = "Glass Node"


def duplicated(material) -> None:
    """The copy is plugged in; the first node is not, and has other values."""
    tree = material.node_tree
    old = tree.nodes[GROUP]
    copy = tree.nodes.new("ShaderNodeGroup")
    copy.node_tree = old.node_tree
    copy_values(old, copy)
    tree.links.new(copy.outputs["Volume"], output_of(material).inputs["Volume"])
    plug(material, copy.outputs["Surface"])
    old.inputs["IOR"].default_value, old.inputs["Priority"].default_value = 2.5, 9


def copy_values(old: bpy.types.Node, new: bpy.types.Node) -> None:
    for source, target in zip(old.inputs, new.inputs):
        if hasattr(source, "default_value"):
            target.default_value = socket_value(source)


def grouped(material, name: str = GROUP, exposed=("IOR",)) -> None:
    """The node is put into a group (Ctrl+G), some of whose values are the group's own sockets."""
    tree = material.node_tree
    old = tree.nodes[name]
    own = bpy.data.node_groups.new("My Glass", "ShaderNodeTree")
    inside = own.nodes.new("ShaderNodeGroup")
    inside.node_tree, inside.name = old.node_tree, old.name
    copy_values(old, inside)
    source, sink = own.nodes.new("NodeGroupInput"), own.nodes.new("NodeGroupOutput")
    outputs = [socket.name for socket in old.outputs if socket.is_linked]
    for output in outputs:
        own.interface.new_socket(output, in_out="OUTPUT", socket_type="NodeSocketShader")
        own.links.new(inside.outputs[output], sink.inputs[output])
    for socket in exposed:
        kind = old.inputs[socket].bl_idname
        plain = kind.removesuffix("Factor").removesuffix("Distance")
        own.interface.new_socket(socket, in_out="INPUT", socket_type=plain)
        reroute = own.nodes.new("NodeReroute")
        own.links.new(source.outputs[socket], reroute.inputs[0])
        own.links.new(reroute.outputs[0], inside.inputs[socket])
    group = tree.nodes.new("ShaderNodeGroup")
    group.node_tree, group.name = own, "My Glass"
    for socket in exposed:
        group.inputs[socket].default_value = old.inputs[socket].default_value
        inside.inputs[socket].default_value = 3.0  # nobody's value
    for output in outputs:
        for link in list(old.outputs[output].links):
            tree.links.new(group.outputs[output], link.to_socket)
    tree.nodes.remove(old)


def twice_grouped(material) -> None:
    grouped(material)
    grouped(material, "My Glass")


def grouped_and_dirty(material) -> None:
    through_mix(material, 0.0)
    grouped(material, exposed=())


WAYS = (through_reroute, through_mix, through_muted_mix, renamed, duplicated, grouped, twice_grouped, grouped_and_dirty)


@pytest.mark.quick
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


@pytest.mark.quick
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


@pytest.mark.quick
def test_assigning_a_material_makes_its_node_readable():
    new_scene()
    for way in (renamed, duplicated, grouped):
        material = nd.new_material("Water", ior=1.33, priority=4)
        way(material)
        ball = add_sphere("Ball", 1.0, segments=8)
        nd.assign(ball, material)
        assert nd.get_priority(ball) == 4


@pytest.mark.quick
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


@pytest.mark.quick
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


@pytest.mark.quick
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


@pytest.mark.quick
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


@pytest.mark.quick
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


@pytest.mark.quick
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


@pytest.mark.quick
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


def test_media_whose_nodes_are_grouped_renamed_or_copied_render_as_plain_ones():
    """Each reads the other's index, on both sides of a common surface."""
    pictures = []
    for ways in ((), (twice_grouped, duplicated), (renamed, grouped)):
        new_scene(24)
        set_striped_world()
        tint = {"transmittance": (0.5, 0.7, 0.9), "transmittance_depth": 0.5}
        media = nd.new_material("Glass", ior=1.5, priority=1, **tint), nd.new_material("Water", ior=1.33, priority=2)
        for material, way in zip(media, ways):
            way(material)
        glass, water = media
        add_sphere("Outer", 1.0, water, segments=32)
        add_sphere("Inner", 0.6, glass, None, (0.5, 0, 0), segments=32)
        add_camera((0.1, -6, 0.3), (0.05, 0, 0), angle=24)
        assert nd.prepare(bpy.context.scene).problems == ()
        pictures.append(render(8))
    for picture in pictures[1:]:
        # The same rays; what surrounds a surface is asked here and known there, which rounding tells apart at few samples, and
        # the tint is the surface's here and the volume's there, so that Cycles draws some lobes otherwise.
        assert np.mean(np.abs(picture - pictures[0]).max(axis=-1) > 1e-3) < 0.05
        assert picture.mean() == pytest.approx(pictures[0].mean(), rel=1e-3)


@pytest.mark.quick
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
