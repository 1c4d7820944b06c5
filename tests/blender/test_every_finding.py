"""Every kind of finding is made once, and says where it is; other tests ask for its words, and mend it."""

import re
from pathlib import Path

import bpy  # before mathutils, which lives inside it
import numpy as np
import pytest
from drinks import add_scattering, lit_floor, see_through, tea_with_a_bubble
from object_types import metaball
from places_of_nodes import GROUP, plug
from scenes import add, add_box, add_camera, add_point_light, add_sphere, native, new_scene
from slabs import tinted

import nested_dielectric as nd
from nested_dielectric.checking import kinds, ray_checks
from nested_dielectric.model.parameter import ParameterError
from nested_dielectric.preparation import prepare_scene


def glass(name: str = "Glass", **keywords) -> bpy.types.Material:
    return nd.new_material(name, **keywords)


def box(name: str = "Box", material=None, size: float = 1.0) -> bpy.types.Object:
    return add_box(name, (-size,) * 3, (size,) * 3, material or glass())


def nothing():
    add("Empty Mesh", bpy.data.meshes.new("Nothing"), (2, 0, 0)).data.materials.append(glass())


def no_number():
    box().data.vertices[0].co.x = float("nan")


def two_media():
    box(material=glass("Water", ior=1.33)).data.materials.append(glass("Oil", ior=1.47))
    bpy.data.objects["Box"].data.polygons[0].material_index = 1


def merging_metaballs():
    metaball(glass("Water", ior=1.33))
    nd.set_priority(bpy.data.objects["Blob.001"], 7)


def hair():
    data = bpy.data.hair_curves.new("Hair")
    data.add_curves([3])
    data.materials.append(glass())
    add("Hair", data)


def many_shells(monkeypatch):
    monkeypatch.setattr(ray_checks, "PROBE_HITS", 5)
    for index in range(4):
        nd.assign(add_sphere(f"Ball {index}", 1.0 - 0.2 * index), glass(priority=4 - index))
    add_camera((0, -5, 0.31), (0, 0, 0), angle=28)


def unmasked_dirt():
    water = glass("Water", ior=1.33, priority=2)
    box("Water", water)
    mix = water.node_tree.nodes.new("ShaderNodeMixShader")
    water.node_tree.links.new(water.node_tree.nodes[GROUP].outputs["Surface"], mix.inputs[1])
    water.node_tree.links.new(water.node_tree.nodes.new("ShaderNodeBsdfDiffuse").outputs[0], mix.inputs[2])
    plug(water, mix.outputs[0])
    box("Winner", glass(priority=1), 0.5)


def unusable_table(monkeypatch):
    def refuse(_):
        raise ParameterError("the file is gone")

    monkeypatch.setattr(prepare_scene, "refresh_spectrum", refuse)
    box(material=glass("Prism", disperse=True))


def label_on_tint():
    bottle = add_box("Bottle", (-1, -1, -1), (1, 1, 1), tinted("Beer", 1.33), 1)
    bottle.data.materials.append(see_through(0.5))


def light_in_tint_that_moves():
    lit_floor("POINT", (0.3, 1.4), (0.5, 0.7))
    bpy.data.objects["Ice"].keyframe_insert("location", frame=1)


def volume_without_mask():
    tea_with_a_bubble(True, None, add_scattering)
    tree = bpy.data.materials["Tea"].node_tree
    tree.links.remove(tree.nodes[GROUP].outputs["Volume Mask"].links[0])


def light_that_nothing_carries():
    box()
    add_point_light((0, 0, 4), 50.0)
    lamp = next(obj for obj in bpy.context.scene.objects if obj.type == "LIGHT")
    lamp.visible_transmission = lamp.visible_glossy = False
    lamp.data.normalize = False


def lights_that_came_later():
    box()
    nd.prepare(bpy.context.scene)
    add_point_light((0, 0, 4), 50.0)
    lamp = next(obj for obj in bpy.context.scene.objects if obj.type == "LIGHT")
    lamp.visible_transmission = lamp.visible_glossy = False


def linked_lobes(tmp_path):
    bpy.data.libraries.write(str(tmp_path / "glass.blend"), {glass("Linked")})
    new_scene(with_group=True)
    with bpy.data.libraries.load(str(tmp_path / "glass.blend"), link=True) as (_, wanted):
        wanted.materials = ["Linked"]
    box(material=bpy.data.materials["Linked"])
    add_point_light((0, 0, 4), 50.0)
    lamp = next(obj for obj in bpy.context.scene.objects if obj.type == "LIGHT")
    lamp.visible_transmission = lamp.visible_glossy = False


def portal():
    box(material=glass("Prism", disperse=True))
    add_box("Gate", (2, 2, 2), (3, 3, 3), native("Gate", "ShaderNodeBsdfRayPortal"))


def vectors():
    box(material=glass("Prism", disperse=True))
    bpy.context.scene.view_layers[0].use_pass_vector = True


def own_nodes_and_an_open_mesh():
    sheet = box("Sheet")
    sheet.data.clear_geometry()
    sheet.data.from_pydata([(-1, 0, -1), (1, 0, -1), (1, 0, 1)], [], [(0, 1, 2)])
    nd.prepare(bpy.context.scene, backend="NATIVE")


def own_nodes_and_a_cutoff():
    box(material=glass(energy_cutoff_exponent=-3.0))
    nd.prepare(bpy.context.scene, backend="NATIVE")


def priority_in_words():
    box()["nd_priority"] = "first"


MADE = {
    kinds.BAD_PRIORITY: priority_in_words,
    kinds.NO_FACES: nothing,
    kinds.NOT_FINITE: no_number,
    kinds.SEVERAL_MEDIA: two_media,
    kinds.METABALL_FAMILY: merging_metaballs,
    kinds.NO_INSIDE: hair,
    kinds.RAY_LIMIT: many_shells,
    kinds.UNMASKED_MIX: unmasked_dirt,
    kinds.SPECTRAL_TABLE: unusable_table,
    kinds.TINTED_LABEL: label_on_tint,
    kinds.TINT_IN_PART: light_in_tint_that_moves,
    kinds.VOLUME_IN_WINNER: volume_without_mask,
    kinds.LOST_LIGHT: light_that_nothing_carries,
    kinds.LIGHTS_CHANGED: lights_that_came_later,
    kinds.LINKED_LOBES: linked_lobes,
    kinds.PORTAL: portal,
    kinds.VECTOR_PASS: vectors,
    kinds.MUST_ASK: own_nodes_and_an_open_mesh,
    kinds.NATIVE_LIMIT: own_nodes_and_a_cutoff,
}
"""What makes findings of the kinds that no other test names by their kind."""


@pytest.mark.parametrize("kind", MADE, ids=lambda kind: kind.key)
def test_it_is_found_where_it_is_and_with_a_remedy(kind, request):
    scene = new_scene(with_group=True)
    make = MADE[kind]
    make(*(request.getfixturevalue(name) for name in make.__code__.co_varnames[: make.__code__.co_argcount]))
    scene = bpy.context.scene
    found = list(nd.prepare(scene).problems) if kind == kinds.SPECTRAL_TABLE else nd.check(scene)
    made = [finding for finding in found if finding.kind == kind]
    assert made, [finding.kind.key for finding in found]
    for finding in made:
        assert finding.text and finding.remedy and finding.severity == kind.severity
        obj = scene.objects.get(finding.name)
        if obj is not None:
            assert np.isfinite(finding.place.point).all()


def test_every_kind_is_made_by_some_test():
    text = "\n".join(
        path.read_text(encoding="utf-8") for path in Path(__file__).parent.glob("*.py") if path != Path(__file__)
    )
    names = {value.key: name for name, value in vars(kinds).items() if isinstance(value, kinds.Kind)}
    elsewhere = {key for key, name in names.items() if f'"{key}"' in text or re.search(rf"\b{name}\b", text)}
    assert kinds.KINDS.keys() - elsewhere - {kind.key for kind in MADE} == set()
