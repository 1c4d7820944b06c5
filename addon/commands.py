"""What the commands of the command line do, each with the options that were parsed for it."""

from __future__ import annotations

import argparse
import io
import json
import os
import sys
from contextlib import ExitStack, nullcontext
from pathlib import Path

import bpy
import numpy as np

from .checking.check import check
from .checking.finding import Finding, to_json
from .checking.kinds import Severity
from .demo.iced_water import build_scene
from .fixing.fix import fix_all
from .importers.jf_reader import read_nodes
from .importers.jf_translation import report, translate
from .model.files import absolute, replacing
from .model.parameters import BY_KEYWORD
from .model.spectra import WAVELENGTHS
from .model.spectral_tables import spectral_table
from .model.spectrum_plots import plot
from .model.streams import log_to_stderr
from .nodes.compatibility import require_blender
from .nodes.render_with import OSL
from .nodes.working_space import working_gamut
from .preparation.live import bake_cut
from .preparation.prepare_scene import prepare
from .preparation.versions import update_materials
from .scene.materials import dielectric_node
from .scene.new_materials import new_material
from .scene.output import check_picture, reason, save_blend
from .scene.preset_library import catalogue
from .scene.rendering import ProgressLine, file_format_of, render_frame, sampling_time

PROGRAM = "nested-dielectric"


class Failure(Exception):
    """A failure with its one line of explanation."""


def _open(file: Path | None) -> bpy.types.Scene:
    """Open a file, or take the one that Blender has open, and return its scene.

    :raises Failure: if there is none.
    """
    if file is None:
        if not bpy.data.filepath:
            raise Failure("no file is open; name a .blend")
    elif not file.is_file():
        raise Failure(f"{file}: no such file")
    else:
        try:
            bpy.ops.wm.open_mainfile(filepath=str(absolute(file)))
        except RuntimeError as error:
            raise Failure(f"{file}: {error}") from None
    return bpy.context.scene


def run_demo(options: argparse.Namespace) -> None:
    """Model the glass of iced water, render it and say what cutting it saves."""
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
    """Say in a sentence what a scene saves by being cut."""
    cut = sampling_time(scene, TRIAL_SAMPLES, TRIAL_PERCENTAGE)
    prepare(scene, cut=False, backend=OSL)
    asking = sampling_time(scene, TRIAL_SAMPLES, TRIAL_PERCENTAGE)
    return f"a sample takes {cut / asking:.2f} of the time that it takes without cut surfaces (CPU, a small picture)"


def run_render(options: argparse.Namespace) -> None:
    """Prepare a file in memory and render a frame of it."""
    file_format_of(options.output)
    scene = _open(options.file)
    print(prepare(scene, not options.no_cut, options.backend), flush=True)
    print(render_frame(scene, options.output, options.samples, options.frame, ProgressLine()))


def run_prepare(options: argparse.Namespace) -> None:
    """Prepare a file and save it."""
    scene = _open(options.file)
    print(prepare(scene, options.cut, options.backend))
    if options.cut:
        hindrance = bake_cut(scene)
        print(
            f"each frame is cut as it is rendered: {hindrance}"
            if hindrance
            else f"the cut of frame {scene.frame_current} is in the file"
        )
    print(f"wrote {save_blend(options.output or bpy.data.filepath)}")


CHECK_SCHEMA = 1
"""Version of the JSON that ``check`` writes; it is counted on when a key changes its meaning or goes."""

FOUND = 3
"""Exit code of ``check`` where something is wrong."""


def run_check(options: argparse.Namespace) -> int:
    """Say what is wrong with the media of all scenes of a file, and with ``--fix`` mend what is safe and save it.

    :returns: 0, or :data:`FOUND` where pictures would be wrong; with ``--strict`` also where they would be slow.
    """
    if options.fix and options.output is None:
        raise Failure("--fix needs a file to write: name it with --output")
    with log_to_stderr() if options.json else nullcontext(sys.stdout) as output:
        _open(options.file)
        changes = {scene.name: list(fix_all(scene).changes) if options.fix else [] for scene in bpy.data.scenes}
        findings = {scene.name: check(scene) for scene in bpy.data.scenes}
        saved = save_blend(options.output) if options.fix else None
        if options.json:
            print(_as_json(findings, changes, saved), file=output, flush=True)
        else:
            for name, found in findings.items():
                print("\n".join(_in_lines(name, found, changes[name])))
            if saved:
                print(f"wrote {saved}")
    counts = {Severity.WRONG, Severity.SLOW} if options.strict else {Severity.WRONG}
    return FOUND if any(each.severity in counts for found in findings.values() for each in found) else 0


def _as_json(findings: dict[str, list[Finding]], changes: dict[str, list[str]], saved: Path | None) -> str:
    """Return what ``check`` has found as JSON."""
    scenes = [
        {"scene": name, "findings": list(map(to_json, found)), "changes": changes[name]}
        for name, found in findings.items()
    ]
    report = {
        "schema": CHECK_SCHEMA,
        "file": bpy.data.filepath,
        "blender": bpy.app.version_string,
        "saved": None if saved is None else str(saved),
        "scenes": scenes,
    }
    return json.dumps(report, indent=2, ensure_ascii=False)


def _in_lines(scene: str, found: list[Finding], changes: list[str]) -> list[str]:
    """Return what ``check`` has found in a scene as lines of text."""
    lines = [f"{scene}: {_headline(found)}", *(f"changed: {change}" for change in changes)]
    for finding in found:
        lines += [f"{finding.severity}: {finding}", f"  shows: {finding.shows}"]
        if finding.place.point is not None:
            lines.append("  at: " + ", ".join(f"{x:.6g}" for x in finding.place.point))
    return lines


def _headline(found: list[Finding]) -> str:
    """Return in one line how much of each severity was found."""
    counts = {severity: sum(finding.severity == severity for finding in found) for severity in Severity}
    return ", ".join(f"{count} {severity}" for severity, count in counts.items() if count) or "nothing is wrong"


def run_update(options: argparse.Namespace) -> None:
    """Bring a file's materials to this version and save it."""
    _open(options.file)
    changes = update_materials()
    print("\n".join(changes) or "nothing to change")
    if changes or options.output:
        print(f"wrote {save_blend(options.output or bpy.data.filepath)}")


def run_presets(options: argparse.Namespace) -> None:
    """List all presets."""
    found = catalogue()
    width = max(map(len, found.presets), default=0)
    for key, preset in found.presets.items():
        index = preset.parameters.get("ior", BY_KEYWORD["ior"].default)
        print(f"{key:{width}} {index:<9} {preset.description}{' (yours)' if key in found.own else ''}")
    for problem in found.problems:
        print(f"{PROGRAM}: {problem}", file=sys.stderr)


def run_bake(options: argparse.Namespace) -> None:
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


def run_import_jf(options: argparse.Namespace) -> None:
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
    import OpenImageIO as oiio  # Blender's own copy

    picture = oiio.ImageSpec(len(table), 1, 4, oiio.FLOAT)
    picture.channelnames = ("R", "G", "B", "A")
    for name, value in metadata.items():
        picture.attribute(name, value)
    file = oiio.ImageOutput.create("exr")
    done = file.open(os.fsencode(draft), picture) and file.write_image(table[None])
    if not (file.close() and done):
        raise Failure(f"{path}: was not written whole ({reason(file.geterror(), draft, path)})")
    check_picture(draft, path, (len(table), 1), 4)
