"""Twenty variants of one shot: five colours of a drink at four levels, on one contact sheet, with a table of what was made.

Run it from top to bottom, or cell by cell (``# %%``) in an editor that knows cells:

    python examples/variants.py -o out/variants
    blender -b --python examples/variants.py -- -o out/variants

The shot is built and prepared once; a variant then changes a colour or a body of liquid, and nothing else.
"""

# %% What varies, and where it goes

import argparse
import csv
import sys
from pathlib import Path
from time import perf_counter

sys.path.insert(0, str(Path(__file__).resolve().parent))  # Blender leaves out a script's own folder

import bpy
import numpy as np
import product_shot as shots
from bodies import MM, height_at, liquid_outline, rounded, turned

bpy.utils.expose_bundled_modules()
import OpenImageIO as oiio  # noqa: E402 - Blender's own

HERE = Path(__file__).resolve().parent

DEPTH = 60.0
"""Millimetres after which white light has a drink's colour."""

COLOURS = {
    "lemon": (0.92, 0.80, 0.16),
    "orange": (0.90, 0.36, 0.04),
    "raspberry": (0.72, 0.04, 0.12),
    "mint": (0.12, 0.66, 0.36),
    "blueberry": (0.10, 0.14, 0.60),
}
LEVELS = (0.3, 0.5, 0.7, 0.9)

parser = argparse.ArgumentParser("variants.py", description="Render 20 variants of a drink.")
parser.add_argument("-o", "--output", type=Path, default=Path("out/variants"), help="folder of pictures and table")
parser.add_argument("--percentage", type=int, default=100, help="of the description's resolution")
parser.add_argument("--samples", type=int, help="instead of the description's")
options = shots.arguments(parser)

# %% Build and prepare the shot once

shot = shots.read_shot(HERE / "vial.json", shots.nd.preset_names())
shot.render.samples = options.samples or shot.render.samples
scene = shots.prepared(shots.build(shot))
scene.render.resolution_percentage = options.percentage
drink = scene.objects["Liquid 1"]

# %% What a variant changes: the body that stands in the vessel, and two values of its material


def fill(level):
    """Exchange the drink's mesh for one that ends at a level, a fraction of the vessel's inside."""
    material = drink.active_material
    inside = rounded(shot.vessel.inside)
    mesh = turned("Liquid", liquid_outline(inside, None, height_at(inside, level)))
    mesh.materials.append(material)
    drink.data = mesh


def tint(colour):
    """Give the drink a colour."""
    node = drink.active_material.node_tree.nodes["Nested Dielectric"]
    node.inputs["Transmittance"].default_value = (*colour, 1.0)
    node.inputs["Transmittance Depth"].default_value = DEPTH * MM


# %% Render them all; media are looked at anew before each render, as after any change of a scene

table = []
for level in LEVELS:
    fill(level)
    for name, colour in COLOURS.items():
        begin = perf_counter()
        tint(colour)
        picture = shots.render(scene, options.output / f"{name}_{100 * level:.0f}.png")
        table.append(
            {"colour": name, "level": level, "file": picture.name, "seconds": round(perf_counter() - begin, 2)}
        )

# %% One sheet of all pictures, a row for each level, and the table


def pixels(file):
    """Return a picture's pixels: (height, width, 3) bytes."""
    return np.asarray(oiio.ImageBuf(str(file)).get_pixels(oiio.UINT8))[..., :3]


pictures = [pixels(options.output / row["file"]) for row in table]
rows = [np.hstack(pictures[first : first + len(COLOURS)]) for first in range(0, len(pictures), len(COLOURS))]
sheet = np.vstack(rows[::-1])
canvas = oiio.ImageBuf(oiio.ImageSpec(sheet.shape[1], sheet.shape[0], 3, oiio.UINT8))
canvas.set_pixels(canvas.roi, np.ascontiguousarray(sheet))
canvas.write(str(options.output / "sheet.png"))

with open(options.output / "variants.csv", "w", newline="", encoding="utf-8") as file:
    writer = csv.DictWriter(file, table[0])
    writer.writeheader()
    writer.writerows(table)

print(f"{len(table)} variants, {sum(row['seconds'] for row in table) / len(table):.2f} s each, in {options.output}")
