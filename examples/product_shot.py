"""A product shot from a JSON description: a vessel, liquids, ice, and a camera that goes round them.

    blender -b --python examples/product_shot.py -- examples/tumbler.json -o 'out/shot_####.png'
    python examples/product_shot.py examples/tumbler.json --save out/shot.blend

README.md beside this file explains descriptions. They are checked before anything is built, the scene before anything is
rendered. Descriptions are in millimetres and scenes in metres, so that presets have the colours of real thicknesses.
"""

from __future__ import annotations

import argparse
import re
import sys
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

sys.path.insert(0, str(Path(__file__).resolve().parent))  # Blender leaves out a script's own folder

import bpy

try:
    import nested_dielectric as nd  # beside the bpy wheel
except ModuleNotFoundError:  # installed in Blender, from whichever repository
    names = [addon.module for addon in bpy.context.preferences.addons if addon.module.endswith(".nested_dielectric")]
    if not names:
        sys.exit("Nested Dielectric is not enabled: install it in Edit > Preferences > Get Extensions")
    nd = import_module(names[0])

from bodies import MM, height_at, ice_cube, ice_places, liquid_outline, rounded, turned
from description import DescriptionError, read_shot
from studio import add, add_studio, set_render

AIR_BELOW = 0.2
"""Millimetres of air between the vessel and what it stands on, as faces must not lie in the same place."""

LIQUID_PRIORITY = 30
"""Of the lowest liquid; each wins over the one below it, so that their surface is the underside of what floats."""

FORMATS = {".png": "PNG", ".jpg": "JPEG", ".exr": "OPEN_EXR"}


def build(shot: SimpleNamespace) -> bpy.types.Scene:
    """Empty the file, build a shot in it, and return its scene."""
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    inside = rounded(shot.vessel.inside)
    vessel = turned("Vessel", rounded(shot.vessel.outside + shot.vessel.inside[::-1]))
    nd.assign(add("Vessel", vessel), medium("Vessel", shot.vessel))
    low = None
    for index, liquid in enumerate(shot.liquids):
        high = height_at(inside, liquid.level)
        obj = add(f"Liquid {index + 1}", turned("Liquid", liquid_outline(inside, low, high)))
        nd.assign(obj, medium(obj.name, liquid), priority=LIQUID_PRIORITY - index)
        low = high
    if shot.ice.count:
        ice = medium("Ice", shot.ice)
        for index, place in enumerate(ice_places(inside, low, shot.ice)):
            cube = add(f"Ice {index + 1}", ice_cube(shot.ice.size, shot.ice.seed + index))
            cube.matrix_world = place
            nd.assign(cube, ice)
    for obj in bpy.context.scene.objects:
        obj.location.z += AIR_BELOW * MM
    add_studio(shot)
    set_render(shot.render)
    return bpy.context.scene


def medium(name: str, described: SimpleNamespace) -> bpy.types.Material:
    """Return a material of what is described: of its preset, but for the colour and the depth of its own that it may have."""
    values = {"shadow_mode": "BLACK"}  # light goes through by paths, so shadows leave it out
    if getattr(described, "colour", None) is not None:
        values["transmittance"] = described.colour
    if getattr(described, "depth", None) is not None:
        values["transmittance_depth"] = described.depth * MM
    return nd.new_material(name, preset=described.preset, **values)


def arguments(parser: argparse.ArgumentParser) -> argparse.Namespace:
    """Return what the script was called with: what stands after "--", as Blender leaves that to scripts, or else all."""
    words = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]
    return parser.parse_args(words)


def frame_range(text: str) -> tuple[int, int]:
    """Return the first and the last frame of "7" or "1-24"."""
    match = re.fullmatch(r"(\d+)(?:-(\d+))?", text)
    first, last = (int(match[1]), int(match[2] or match[1])) if match else (0, 0)
    if not 1 <= first <= last:
        raise argparse.ArgumentTypeError(f"{text!r} must be a frame such as 7, or frames such as 1-24")
    return first, last


def prepared(scene: bpy.types.Scene) -> bpy.types.Scene:
    """Return a scene, ready to render with its surfaces cut where media cross.

    :raises DescriptionError: if something would be wrong with the picture.
    """
    problems = nd.prepare(scene, cut=True).problems
    if problems:
        raise DescriptionError("; ".join(map(str, problems)))
    return scene


def render(scene: bpy.types.Scene, output: Path) -> Path:
    """Render the scene's frame to a file, in whose name # stand for its number, and return its path."""
    number = str(scene.frame_current)
    path = output.absolute().with_name(re.sub("#+", lambda match: number.zfill(len(match[0])), output.name))
    path.parent.mkdir(parents=True, exist_ok=True)
    scene.render.image_settings.file_format = FORMATS[path.suffix]
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    return path


def main() -> None:
    """Build, check, save and render the shot that the command line names; exit with 2 if something is wrong with it."""
    parser = argparse.ArgumentParser("product_shot.py", description="Build and render a product shot.")
    parser.add_argument("description", type=Path, help="JSON, explained in examples/README.md")
    parser.add_argument("-o", "--output", type=Path, help="pictures; #### stands for the frame's number")
    parser.add_argument("--save", type=Path, metavar="FILE.blend", help="keep the scene, ready to render anywhere")
    parser.add_argument("--frames", type=frame_range, metavar="A-B", help="which to render; all unless given")
    parser.add_argument("--percentage", type=int, default=100, help="of the description's resolution")
    parser.add_argument("--samples", type=int, help="instead of the description's")
    options = arguments(parser)
    try:
        shot = read_shot(options.description, nd.preset_names())
        first, last = options.frames or (1, shot.camera.frames)
        check_output(options.output, several=first != last)
        check_places(options.output, options.save)
        shot.render.samples = options.samples or shot.render.samples
        scene = prepared(build(shot))
    except DescriptionError as error:
        parser.exit(2, f"product_shot.py: {error}\n")
    except nd.UnsupportedError as error:
        parser.exit(1, f"product_shot.py: {error}\n")
    scene.render.resolution_percentage = options.percentage
    if options.save:
        bpy.ops.wm.save_as_mainfile(filepath=str(options.save.absolute()))
    for frame in range(first, last + 1) if options.output else ():
        scene.frame_set(frame)
        print(render(scene, options.output), flush=True)


def check_output(output: Path | None, several: bool) -> None:
    """Refuse a file for pictures that has no known ending, or one name for several frames."""
    if output and output.suffix not in FORMATS:
        raise DescriptionError(f"{output.name}: must end in {', '.join(FORMATS)}")
    if output and several and "#" not in output.name:
        raise DescriptionError(
            f"{output.name}: needs # for the frame's number, such as {output.stem}_####{output.suffix}"
        )


def check_places(output: Path | None, save: Path | None) -> None:
    """Make the folders of what is written; refuse a scene's file of another ending, and places that no folder can be."""
    if save and save.suffix != ".blend":
        raise DescriptionError(f"{save.name}: must end in .blend")
    for path in filter(None, (output, save)):
        try:
            path.absolute().parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise DescriptionError(f"{path}: cannot be written ({error.strerror})") from None


if __name__ == "__main__":
    main()
