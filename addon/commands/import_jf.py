"""``import-jf``: materials of Arnold's nodes."""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

from ..importers.jf_reader import read_nodes
from ..importers.jf_translation import report, translate
from ..scene.materials import dielectric_node
from ..scene.new_materials import new_material
from ..scene.output import save_blend
from .shared import AddParser, Failure, file_name


def add_command(add_parser: AddParser) -> None:
    migration = add_parser(
        "import-jf",
        help="make materials of Arnold's jf_nested_dielectric nodes, in the open .blend or an empty one",
    )
    migration.add_argument("file", type=Path, metavar="FILE", help="an Arnold scene (.ass), or parameters (.json)")
    migration.add_argument(
        "-o",
        "--output",
        type=file_name,
        metavar="FILE.blend",
        help="file to write (default: beside FILE, if it is new)",
    )
    migration.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> None:
    """Make materials of Arnold's nodes and save them in a file."""
    translations = [translate(node) for node in read_nodes(options.file)]
    output = options.output or options.file.with_suffix(".blend")
    if output.suffix.lower() != ".blend":
        raise Failure(f"{output}: the ending must be .blend")
    if options.output is None and output.exists():
        raise Failure(f"{output} is there already; name the file to write with --output")
    if not bpy.data.filepath:
        bpy.ops.wm.read_homefile(use_empty=True)
    for line in report(translations):
        print(line)
    for translation in translations:
        material = new_material(translation.name, **translation.keywords)
        if material.name != translation.name:
            print(f"{translation.name}: name: the material is called {material.name!r}")
        material.use_fake_user = True  # or the file would lose it
        for socket, colour in translation.emission.items():
            _add_emission(material, socket, colour)
    saved = save_blend(output)
    print(f"wrote {len(translations)} material{'s' * (len(translations) != 1)} to {saved}")


def _add_emission(material: bpy.types.Material, socket: str, colour: tuple[float, float, float]) -> None:
    tree, dielectric = material.node_tree, dielectric_node(material)
    emission = tree.nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (*colour, 1.0)
    emission.label = socket
    emission.location = (-260.0, -160.0 * len(tree.nodes))
    tree.links.new(emission.outputs["Emission"], dielectric.inputs[socket])
