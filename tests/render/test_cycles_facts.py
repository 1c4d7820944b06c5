"""What Cycles does that the design leans on and that no other test would show; see docs/design.md."""

import math

import bpy
import numpy as np
import pytest
from scenes import add_box, add_camera, add_plane, add_sphere, emission, native, new_scene, render, set_world
from shading import evaluate

from nested_dielectric.nodes.osl import add_script, make_script
from nested_dielectric.nodes.shader_nodes import lazily

UPWARDS = """
shader test(output color Result = color(0.0))
{
  float answer = -1.0;
  if (trace(P, vector(0.0, 0.0, 1.0), "mindist", 0.0, "maxdist", 100.0)) {
    answer = 0.0;
    %s
  }
  Result = color(answer);
}
"""
"""What a ray straight up tells; -1 if it meets nothing."""


def ask(statements: str, build=None, text: str = UPWARDS) -> float:
    """What a shader answers on a plane at a height of 0, beside things."""
    return evaluate(text % statements, 2, 2, build=build)[0, 0, 0]


def shaded(*names: str) -> bpy.types.Material:
    """A material that asks for attributes of its objects, of which nothing shows."""
    material = emission(0.5)
    tree = material.node_tree
    total = None
    for name in names:
        attribute = tree.nodes.new("ShaderNodeAttribute")
        attribute.attribute_type, attribute.attribute_name = "OBJECT", name
        total = attribute.outputs["Fac"]
        tree.links.new(total, tree.nodes["Emission"].inputs["Strength"])
    return material


def lid(*names: str, height: float = 2.0) -> bpy.types.Object:
    """A square above the plane and the camera, whose front looks up."""
    return add_plane("Lid", 4.0, (0, 0, height), (0, 0, 1), shaded(*names))


# Rays of shaders


def test_a_shaders_ray_meets_objects_whatever_rays_they_are_visible_to():
    def build():
        obj = lid()
        for kind in ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
            setattr(obj, f"visible_{kind}", kind == "camera")

    distance = 'getmessage("trace", "hitdist", answer);'
    assert ask(distance, build) == pytest.approx(2.0, abs=1e-5)
    assert ask(distance) == -1.0


def test_a_ray_that_meets_nothing_leaves_a_record():
    """Where no device can trace there is none, by which the shader knows."""
    record = """
    shader test(output color Result = color(0.0))
    {
      int hit = 0;
      trace(P, vector(0.0, 0.0, 1.0), "mindist", 0.0);
      Result = color(getmessage("trace", "hit", hit), %s 0.0, 0.0);
    }
    """
    assert ask("", text=record) == 1.0


def test_normals_of_a_hit_face_the_ray_and_derivatives_of_its_place_keep_the_side():
    facing = 'normal n; getmessage("trace", "N", n); answer = n[2] < 0.0;'
    side = """
      float u = 0.0, v = 0.0; point q; point c[3];
      getmessage("trace", "u", u); getmessage("trace", "v", v); getmessage("trace", "P", q);
      getmessage("trace", "geom:trianglevertices", c);
      answer = dot((c[1] - c[0]) * Dx(u) + (c[2] - c[0]) * Dx(v), Dx(q)) < 0.0;"""

    def turned():
        add_plane("Lid", 4.0, (0, 0, 2), (0, 0, -1), shaded())

    assert [ask(facing, build) for build in (lid, turned)] == [1.0, 1.0]
    assert [ask(side, build) for build in (lid, turned)] in ([1.0, 0.0], [0.0, 1.0])


# Attributes


def test_a_hit_tells_only_attributes_that_its_own_material_asks_for():
    read = r'float told = 0.0; answer = getmessage("trace", "\001object:told", told); if (answer > 0.0) answer = told;'

    def build(*names):
        lid(*names)["told"] = 3.5

    assert ask(read, lambda: build("told")) == pytest.approx(3.5)
    assert ask(read, build) == 0.0


KINDS = {"FLOAT": 2.5, "INTEGER": 2, "BOOLEAN": True, "MENU": None}


@pytest.mark.parametrize("kind, value", KINDS.items())
def test_numbers_of_a_neighbours_sockets_are_read_by_path_and_menus_are_not(kind, value):
    def build():
        material = shaded(path)
        tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
        kinds = {"FLOAT": "Float", "INTEGER": "Int", "BOOLEAN": "Bool", "MENU": "Menu"}
        tree.interface.new_socket("Value", in_out="INPUT", socket_type=f"NodeSocket{kinds[kind]}")
        node = material.node_tree.nodes.new("ShaderNodeGroup")
        node.name, node.node_tree = "ND", tree
        if value is not None:
            node.inputs["Value"].default_value = value
        add_plane("Lid", 4.0, (0, 0, 2.0), (0, 0, 1), material)

    path = 'active_material.node_tree.nodes["ND"].inputs["Value"].default_value'
    name = r"\001object:" + path.replace('"', r"\"")
    told = ask(f'float told[4]; answer = getmessage("trace", "{name}", told) ? told[0] + 10.0 * told[3] : 0.0;', build)
    assert told == (0.0 if value is None else pytest.approx(float(value) + 10.0))


def test_whole_numbers_are_read_exactly_below_2_to_the_22nd():
    """Cycles takes the mean of three of them."""
    read = r'float told; answer = getmessage("trace", "\001object:told", told) ? told - {number}.0 : 0.5;'
    for number in (2**22 - 1, 2**22 - 3, 4_000_001):

        def build(number=number):
            lid("told")["told"] = number

        assert ask(read.format(number=number), build) == 0.0


# Lengths and numbers


def picture_of(material, between=None) -> np.ndarray:
    """The middle of a plane, 3 from the camera, of a material that is made in a new scene; behind another 1 from the camera."""
    new_scene(4)
    add_camera((0, 0, 3), (0, 0, 0), width=1.0)
    add_plane("Plane", 4.0, (0, 0, 0), (0, 0, 1), material())
    if between is not None:
        add_plane("Between", 4.0, (0, 0, 2), (0, 0, 1), between())
    return render(1)[1, 1]


def light_path(output: str) -> bpy.types.Material:
    material = emission()
    tree = material.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeLightPath").outputs[output], tree.nodes["Emission"].inputs["Strength"])
    return material


def test_a_rays_length_grows_through_transparent_surfaces_and_begins_anew_at_refraction():
    between = (
        lambda: native("Clear", "ShaderNodeBsdfTransparent", Color=(1, 1, 1, 1)),
        lambda: native("Refracts", "ShaderNodeBsdfRefraction", IOR=1.0),
    )
    lengths = [picture_of(lambda: light_path("Ray Length"), each)[0] for each in between]
    assert lengths == pytest.approx([3.0, 2.0], abs=1e-4)


def test_a_struct_in_a_list_that_makes_another_is_left_out():
    """A list within the list is not."""
    text = """
    struct Inner { float a; };
    struct Outer { Inner inner; float b; };
    shader test(output color Result = color(0.0))
    {
      Inner inner = {u + 1.0};
      Outer outer = {inner, u + 2.0}, written = {{u + 1.0}, u + 2.0};
      Result = color(outer.inner.a, written.inner.a, outer.b) %s;
    }
    """
    left_out, written, other = evaluate(text % "", 2, 2)[0, 0]
    assert left_out != written == other - 1.0


def test_time_is_a_half_without_motion_blur_and_runs_over_all_of_it_with():
    text = "shader test(output color Result = 0) { Result = color(time) %s; }"
    assert ask("", text=text) == 0.5

    def build():
        scene = bpy.context.scene
        scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 0.0

    times = evaluate(text % "", 64, 64, build=build)[..., 0].ravel()
    shares, _ = np.histogram(times, bins=8, range=(0, 1))
    assert np.all(np.abs(shares / len(times) - 1 / 8) < 5 * math.sqrt(1 / 8 * 7 / 8 / len(times)))


# Nodes


@pytest.mark.parametrize("linked", [False, True])
def test_a_way_that_unlinked_sockets_choose_is_taken_and_a_linked_condition_counts_as_0(linked):
    """Of two values, as the extension's nodes choose."""

    def material() -> bpy.types.Material:
        material = emission()
        tree = material.node_tree
        if linked:
            condition = tree.nodes.new("ShaderNodeLightPath").outputs["Is Camera Ray"]
        else:
            node = tree.nodes.new("ShaderNodeMath")
            node.operation = "ADD"
            node.inputs[0].default_value, node.inputs[1].default_value = 0.5, 0.5
            condition = node.outputs[0]
        tree.links.new(lazily(tree, "FLOAT", condition, 0.25, 0.75), tree.nodes["Emission"].inputs["Strength"])
        return material

    assert picture_of(material)[0] == pytest.approx(0.25 if linked else 0.75)


# Scenes


def test_an_object_that_no_ray_meets_is_not_there_with_its_volume():
    def build():
        box = add_box("Box", (-1, -1, 0.2), (2, 2, 0.8), native("Volume", "ShaderNodeVolumeAbsorption", Density=5.0))
        tree = box.active_material.node_tree
        output = tree.nodes["Material Output"]
        absorption = next(node for node in tree.nodes if node.type == "VOLUME_ABSORPTION")
        tree.links.clear()
        tree.links.new(absorption.outputs[0], output.inputs["Volume"])
        for kind in ("camera", "diffuse", "glossy", "transmission", "volume_scatter", "shadow"):
            setattr(box, f"visible_{kind}", seen)

    text = "shader test(output color Result = 0) { Result = color(1.0) %s; }"
    seen = False
    assert ask("", build, text) == 1.0
    seen = True
    assert ask("", build, text) == pytest.approx(math.exp(-0.6), abs=1e-5)


def dark(material) -> float:
    """The part of a floor that one ray finds dark under a small glow of a material: little if Cycles takes that for a light."""
    new_scene(16)
    add_camera((0, 0, 3), (0, 0, 0), width=1.0)
    add_plane("Floor", 4.0, (0, 0, 0), (0, 0, 1), native("Floor", "ShaderNodeBsdfDiffuse"))
    add_plane("Glow", 0.2, (0, 1, 1), (0, 0, -1), material())
    return float((render(1)[..., 0] == 0.0).mean())


def test_a_mesh_is_a_light_only_if_it_may_emit_more_than_a_half():
    assert dark(lambda: emission(0.6)) < 0.1 and dark(lambda: emission(0.4)) > 0.9


def test_a_script_that_makes_light_itself_is_a_light_and_one_that_makes_a_glow_stronger_is_not():
    """Cycles looks through Script nodes to what is linked to them, and takes those that have the word emission for lights."""

    def scripted(text: str, strength: float | None = None) -> bpy.types.Material:
        material = emission(strength or 0.0)
        tree = material.node_tree
        inputs = {} if strength is None else {"Inner": "SHADER"}
        node = add_script(tree, "Script", make_script("test.osl", text), inputs, {"Surface": "SHADER"})
        for socket in node.inputs:
            tree.links.new(tree.nodes["Emission"].outputs[0], socket)
        tree.links.new(node.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
        return material

    own = "shader test(output closure color Surface = 0) { Surface = 0.4 * emission(); }"
    stronger = "shader test(closure color Inner = 0, output closure color Surface = 0) { Surface = Inner * 100.0; }"
    assert dark(lambda: scripted(own)) < 0.1 and dark(lambda: scripted(stronger, 0.01)) > 0.9


@pytest.mark.parametrize("path, again", [("frame_current", True), ("frame_float", False)])
def test_what_reads_the_whole_frame_is_evaluated_in_every_render(path, again):
    scene = new_scene(4)
    scene.render.use_persistent_data = True
    set_world()
    add_camera((0, 0, 3), (0, 0, 0), width=1.0)
    material = emission()
    attribute = material.node_tree.nodes.new("ShaderNodeAttribute")
    attribute.attribute_type, attribute.attribute_name = "VIEW_LAYER", path
    material.node_tree.links.new(attribute.outputs["Fac"], material.node_tree.nodes["Emission"].inputs["Strength"])
    add_sphere("Ball", 0.5, material)
    updates: list[set[str]] = []

    def watch(scene, depsgraph):
        if depsgraph.mode == "RENDER":
            updates.append({update.id.name for update in depsgraph.updates})

    bpy.app.handlers.frame_change_post.append(watch)
    try:
        for _ in range(2):
            render(1)
    finally:
        bpy.app.handlers.frame_change_post.remove(watch)
    assert ("Ball" in updates[-1]) is again
