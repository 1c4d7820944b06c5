"""What a medium brings into its file, each once."""

import bpy
from nested_balls import build_scene
from scenes import new_scene

import nested_dielectric as nd


def test_the_source_travels_with_the_file_in_one_text():
    build_scene()
    text = bpy.data.texts["nested_dielectric.osl"].as_string()
    assert "#include" not in text
    assert text.count("struct Medium") == 1


def test_materials_of_one_file_share_one_group():
    build_scene()
    names = [tree.name for tree in bpy.data.node_groups]
    assert [name for name in names if not name.startswith(".")] == ["Nested Dielectric", "Nested Dielectric Lights"]
    assert not any(name[-3:].isdigit() for name in names)  # as copies would be


def test_eevee_multiplies_the_colours_of_new_media():
    new_scene(16)
    assert nd.new_material("Medium").surface_render_method == "BLENDED"
