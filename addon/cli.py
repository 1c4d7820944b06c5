"""The command line: ``python -m nested_dielectric`` and ``blender -b FILE.blend -c nested_dielectric``.

Blender takes only identifiers for commands, hence the underscore there.

Exit codes: 0 done, 1 failed, 2 wrong usage; Ctrl-C ends it as it ends other programs, which shells report as 130.
"""

from __future__ import annotations

import argparse
import io
import os
import sys
from contextlib import ExitStack
from pathlib import Path

import bpy
import numpy as np

from .demo.iced_water import build_scene
from .importers.jf import JfError, read_nodes, report, translate
from .model.files import absolute, ending_at_once, replacing
from .model.parameters import BY_KEYWORD, ParameterError
from .model.spectra import DISTRIBUTIONS, GAMUTS, WAVELENGTHS, SpectrumError, plot, spectral_table
from .nodes.compatibility import BACKENDS, OSL, require_blender
from .nodes.working_space import working_gamut
from .preparation.live import keep_cut
from .preparation.preparation import prepare
from .preparation.versions import update_materials
from .scene.materials import dielectric_node, new_material
from .scene.output import check_picture, reason, save_blend
from .scene.preset_library import catalogue
from .scene.rendering import ProgressLine, file_format_of, render_frame, sampling_time

PROGRAM = "nested-dielectric"
DEMO_OUTPUT = Path("out/iced_water.png")


class _Failure(Exception):
    """A failure with its one line of explanation."""


def main(arguments: list[str] | None = None) -> int:
    """Run one command and return its exit code."""
    try:
        options = _parser().parse_args(arguments)
    except SystemExit as stop:
        return int(stop.code or 0)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # for file names that are no text
    bpy.utils.expose_bundled_modules()  # Script nodes of a file that is opened keep their sockets with it alone
    try:
        with ending_at_once(bpy.app.tempdir):
            options.run(options)
            sys.stdout.flush()
    except BrokenPipeError:  # whoever read it has enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except (_Failure, JfError, ParameterError, SpectrumError, OSError, RuntimeError) as error:
        named = isinstance(error, OSError) and error.filename
        text = f"{error.filename}: {error.strerror}" if named else str(error).replace("Error: ", "")
        print(f"{PROGRAM}: error: {' '.join(text.split())}", file=sys.stderr)
        return 1
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog=PROGRAM, description="Nested dielectrics for Cycles.", allow_abbrev=False)
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")

    demo = commands.add_parser("demo", help="model the glass of iced water and render it", allow_abbrev=False)
    demo.add_argument(
        "-o", "--output", type=_file, default=DEMO_OUTPUT, help=f"picture to write (default: {DEMO_OUTPUT})"
    )
    demo.add_argument("--samples", type=_positive, help="samples per pixel")
    demo.add_argument("--save", type=_blend, metavar="FILE.blend", help="also save the scene")
    demo.set_defaults(run=_demo)

    render = commands.add_parser(
        "render", help="prepare a .blend in memory and render a frame of it", allow_abbrev=False
    )
    _add_file(render)
    render.add_argument(
        "-o", "--output", type=_file, required=True, help="picture to write; its ending chooses the format"
    )
    render.add_argument("--samples", type=_positive, help="samples per pixel (default: the scene's)")
    render.add_argument("--frame", type=int, help="frame to render (default: the current one)")
    render.add_argument(
        "--no-cut",
        action="store_true",
        help="render media as they are; the default cuts their surfaces where they cross",
    )
    _add_backend(render)
    render.set_defaults(run=_render)

    preparation = commands.add_parser(
        "prepare", help="set what a .blend needs, list problems, and save it", allow_abbrev=False
    )
    _add_file(preparation)
    _add_saved(preparation)
    preparation.add_argument(
        "--cut",
        action=argparse.BooleanOptionalAction,
        help="let renders of the file show surfaces cut where media cross, that of its frame kept in the file for farms; or not "
        "(default: as the file has it)",
    )
    _add_backend(preparation)
    preparation.set_defaults(run=_prepare)

    update = commands.add_parser(
        "update", help="bring a .blend's materials to this version of the extension, and save it", allow_abbrev=False
    )
    _add_file(update)
    _add_saved(update)
    update.set_defaults(run=_update)

    presets = commands.add_parser("presets", help="list the presets", allow_abbrev=False)
    presets.set_defaults(run=_presets)

    bake = commands.add_parser("bake", help="write the table that light is split into colours with", allow_abbrev=False)
    bake.add_argument(
        "--distribution",
        default="DAYLIGHT",
        help=f"{', '.join(choice.keyword for choice in DISTRIBUTIONS)}, a CIE illuminant such as FL11, or a CSV file "
        "of wavelength (nm) and power (default: DAYLIGHT)",
    )
    bake.add_argument(
        "--gamut",
        type=str.upper,
        choices=[choice.keyword for choice in GAMUTS],
        default="SCENE",
        help="colour space of the colours (default: SCENE, the working space of the file that Blender has open)",
    )
    bake.add_argument("--saturation", type=float, default=1.0, help="0 (grey) to 1 (default)")
    bake.add_argument(
        "--keep-negative", action="store_true", help="keep the negative parts of colours outside the gamut"
    )
    bake.add_argument(
        "-o", "--output", type=_file, required=True, metavar="TABLE.exr", help="picture to write, a pixel an entry"
    )
    bake.add_argument("--plot", type=_file, metavar="PLOT.png", help="also draw it; needs matplotlib")
    bake.set_defaults(run=_bake)

    migration = commands.add_parser(
        "import-jf",
        help="make materials of Arnold's jf_nested_dielectric nodes, in the open .blend or an empty one",
        allow_abbrev=False,
    )
    migration.add_argument("file", type=Path, metavar="FILE", help="an Arnold scene (.ass), or parameters (.json)")
    migration.add_argument(
        "-o", "--output", type=_file, metavar="FILE.blend", help="file to write (default: beside FILE, if it is new)"
    )
    migration.set_defaults(run=_import_jf)
    return parser


def _add_file(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file", type=Path, nargs="?", metavar="FILE", help="the .blend (default: the one Blender has open)"
    )


def _add_saved(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-o", "--output", type=_blend, metavar="OUT.blend", help="file to write (default: FILE itself)")


def _add_backend(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--backend",
        type=str.upper,
        choices=[choice.keyword for choice in BACKENDS],
        help="what renders media: Cycles' own nodes, the shader in OSL, or what fits best (default: as the file has it)",
    )


def _file(text: str) -> Path:
    if not text or text.endswith(("/", os.sep)):
        raise argparse.ArgumentTypeError(f"{text!r} is no file's name")
    return Path(text)


def _blend(text: str) -> Path:
    path = _file(text)
    if path.suffix.lower() != ".blend":
        raise argparse.ArgumentTypeError(f"{text}: the ending must be .blend")
    return path


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{number} is not a positive number")
    return number


def _open(file: Path | None) -> bpy.types.Scene:
    if file is None:
        if not bpy.data.filepath:
            raise _Failure("no file is open; name a .blend")
    elif not file.is_file():
        raise _Failure(f"{file}: no such file")
    else:
        try:
            bpy.ops.wm.open_mainfile(filepath=str(absolute(file)))
        except RuntimeError as error:
            raise _Failure(f"{file}: {error}") from None
    return bpy.context.scene


def _demo(options: argparse.Namespace) -> None:
    require_blender()
    file_format_of(options.output)  # before any work is done
    scene = build_scene()
    print(prepare(scene, cut=True), flush=True)
    if options.save:
        save_blend(options.save)
    print(render_frame(scene, options.output, options.samples, progress=ProgressLine()))
    print(_saving(scene))


TRIAL_SAMPLES, TRIAL_PERCENTAGE = 32, 15
"""Of the small pictures that are compared."""


def _saving(scene: bpy.types.Scene) -> str:
    """What a scene saves by being cut, in a sentence."""
    cut = sampling_time(scene, TRIAL_SAMPLES, TRIAL_PERCENTAGE)
    prepare(scene, cut=False, backend=OSL)
    asking = sampling_time(scene, TRIAL_SAMPLES, TRIAL_PERCENTAGE)
    return f"a sample takes {cut / asking:.2f} of the time that it takes without cut surfaces (CPU, a small picture)"


def _render(options: argparse.Namespace) -> None:
    file_format_of(options.output)
    scene = _open(options.file)
    print(prepare(scene, not options.no_cut, options.backend), flush=True)
    print(render_frame(scene, options.output, options.samples, options.frame, ProgressLine()))


def _prepare(options: argparse.Namespace) -> None:
    scene = _open(options.file)
    print(prepare(scene, options.cut, options.backend))
    if options.cut:
        hindrance = keep_cut(scene)
        print(
            f"each frame is cut as it is rendered: {hindrance}"
            if hindrance
            else f"the cut of frame {scene.frame_current} is in the file"
        )
    print(f"wrote {save_blend(options.output or bpy.data.filepath)}")


def _update(options: argparse.Namespace) -> None:
    _open(options.file)
    changes = update_materials()
    print("\n".join(changes) or "nothing to change")
    if changes or options.output:
        print(f"wrote {save_blend(options.output or bpy.data.filepath)}")


def _presets(options: argparse.Namespace) -> None:
    found = catalogue()
    width = max(map(len, found.presets))
    for key, preset in found.presets.items():
        index = preset.parameters.get("ior", BY_KEYWORD["ior"].default)
        print(f"{key:{width}} {index:<9} {preset.description}{' (yours)' if key in found.own else ''}")
    for problem in found.problems:
        print(f"{PROGRAM}: {problem}", file=sys.stderr)


def _bake(options: argparse.Namespace) -> None:
    if options.output.suffix.lower() != ".exr":
        raise _Failure(f"{options.output}: the ending must be .exr")
    gamut = working_gamut() if options.gamut == "SCENE" else options.gamut
    table = spectral_table(options.distribution, gamut, options.saturation, not options.keep_negative)
    drawing = _draw(options.plot, options.distribution, table) if options.plot else None
    metadata = {
        "Software": PROGRAM,
        "distribution": options.distribution,
        "gamut": gamut,
        "saturation": options.saturation,
        "clamp_negative": int(not options.keep_negative),
        "wavelength_range": f"{WAVELENGTHS[0]:g} to {WAVELENGTHS[1]:g} nm",
        "rgb": "weights of scene-linear red, green and blue; their mean is white",
        "alpha": "wavelength in nm",
    }
    with ExitStack() as undo:
        if drawing:
            undo.enter_context(replacing(options.plot)).write_bytes(drawing)
        _write_table(undo.enter_context(replacing(options.output)), options.output, table, metadata)
    written = f"{len(table)} entries in {gamut} to {absolute(options.output)}"
    if drawing:
        written += f", and {absolute(options.plot)}"
    print(f"wrote {written}")


def _import_jf(options: argparse.Namespace) -> None:
    translations = [translate(node) for node in read_nodes(options.file)]
    output = options.output or options.file.with_suffix(".blend")
    if output.suffix.lower() != ".blend":
        raise _Failure(f"{output}: the ending must be .blend")
    if options.output is None and output.exists():
        raise _Failure(f"{output} is there already; name the file to write with --output")
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


def _draw(path: Path, distribution: str, table: np.ndarray) -> bytes:
    """The plot as a file of the format that the path's ending names."""
    figure = plot(distribution, table)
    formats = figure.canvas.get_supported_filetypes()
    ending = path.suffix.lower().removeprefix(".")
    if ending not in formats:
        raise _Failure(f"{path}: the ending must be one of {', '.join(f'.{name}' for name in formats)}")
    drawing = io.BytesIO()
    figure.savefig(drawing, format=ending, dpi=120)
    return drawing.getvalue()


def _write_table(draft: Path, path: Path, table: np.ndarray, metadata: dict[str, str | float | int]) -> None:
    import OpenImageIO as oiio  # Blender's own copy

    picture = oiio.ImageSpec(len(table), 1, 4, oiio.FLOAT)
    picture.channelnames = ("R", "G", "B", "A")
    for name, value in metadata.items():
        picture.attribute(name, value)
    file = oiio.ImageOutput.create("exr")
    done = file.open(os.fsencode(draft), picture) and file.write_image(table[None])
    if not (file.close() and done):
        raise _Failure(f"{path}: was not written whole ({reason(file.geterror(), draft, path)})")
    check_picture(draft, path, (len(table), 1), 4)
