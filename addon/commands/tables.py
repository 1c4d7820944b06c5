"""``presets`` and ``bake``: the presets as a list, and spectral tables as pictures."""

from __future__ import annotations

import argparse
import io
import os
import sys
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from ..model.distributions import DISTRIBUTIONS
from ..model.files import absolute, replacing
from ..model.gamuts import GAMUTS
from ..model.parameters import BY_KEYWORD
from ..model.spectra import WAVELENGTHS
from ..model.spectral_tables import spectral_table
from ..model.spectrum_plots import plot
from ..nodes.working_space import working_gamut
from ..scene.output import check_picture, picture_files, reason
from ..scene.preset_library import catalogue
from .shared import PROGRAM, AddParser, Failure, file_name


def add_presets(add_parser: AddParser) -> None:
    add_parser("presets", help="list the presets").set_defaults(run=_list)


def _list(options: argparse.Namespace) -> None:
    """List all presets."""
    found = catalogue()
    width = max(map(len, found.presets), default=0)
    for key, preset in found.presets.items():
        index = preset.parameters.get("ior", BY_KEYWORD["ior"].default)
        print(f"{key:{width}} {index:<9} {preset.description}{' (yours)' if key in found.own else ''}")
    for problem in found.problems:
        print(f"{PROGRAM}: {problem}", file=sys.stderr)


def add_bake(add_parser: AddParser) -> None:
    bake = add_parser("bake", help="write the table that light is split into colours with")
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
        "-o", "--output", type=file_name, required=True, metavar="TABLE.exr", help="picture to write, a pixel an entry"
    )
    bake.add_argument("--plot", type=file_name, metavar="PLOT.png", help="also draw it; needs matplotlib")
    bake.set_defaults(run=_bake)


def _bake(options: argparse.Namespace) -> None:
    """Write a spectral table, and its plot if that is wanted."""
    if options.output.suffix.lower() != ".exr":
        raise Failure(f"{options.output}: the ending must be .exr")
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


def _draw(path: Path, distribution: str, table: np.ndarray) -> bytes:
    """Return the plot as a file of the format that the path's ending names.

    :raises Failure: for an ending that no format has.
    """
    figure = plot(distribution, table)
    formats = figure.canvas.get_supported_filetypes()
    ending = path.suffix.lower().removeprefix(".")
    if ending not in formats:
        raise Failure(f"{path}: the ending must be one of {', '.join(f'.{name}' for name in formats)}")
    drawing = io.BytesIO()
    figure.savefig(drawing, format=ending, dpi=120)
    return drawing.getvalue()


def _write_table(draft: Path, path: Path, table: np.ndarray, metadata: dict[str, str | float | int]) -> None:
    oiio = picture_files()
    picture = oiio.ImageSpec(len(table), 1, 4, oiio.FLOAT)
    picture.channelnames = ("R", "G", "B", "A")
    for name, value in metadata.items():
        picture.attribute(name, value)
    file = oiio.ImageOutput.create("exr")
    done = file.open(os.fsencode(draft), picture) and file.write_image(table[None])
    if not (file.close() and done):
        raise Failure(f"{path}: was not written whole ({reason(file.geterror(), draft, path)})")
    check_picture(draft, path, (len(table), 1), 4)
