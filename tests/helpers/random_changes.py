"""Random changes to a scene of many media: `python tests/helpers/random_changes.py CHANGES [SEED]` makes thousands.

No handler may raise anything, and every render among them is that of a scene which was never prepared.
"""

from __future__ import annotations

import random
import sys
import traceback
from collections.abc import Callable

import bpy  # before bmesh, which lives inside it
import numpy as np
from changes_of_media import IORS, MEDIA, scatter, scene_now
from changes_of_scenes import CHANGES, leave_mode
from scenes import add_camera, add_sphere, new_scene, render, set_striped_world

import nested_dielectric as nd
from nested_dielectric.analysis import surroundings
from nested_dielectric.preparation import live

SAMPLES = 4
SAME = 2e-3
"""Root mean square beyond which two pictures differ by more than the noise of tint at 64 times the samples (up to 1.5e-3); all
others are equal but for last bits.
"""


def build_scene(chance: random.Random) -> bpy.types.Scene:
    """Balls, some in others, of few materials and priorities."""
    scene = new_scene(20)
    set_striped_world()
    materials = [nd.new_material(f"Medium {ior}", ior=ior) for ior in IORS]
    materials.append(nd.new_material("Tinted", ior=1.4, transmittance=(0.8, 0.8, 0.8), transmittance_depth=1.0))
    for index in range(MEDIA):
        ball = add_sphere(f"Ball {index}", 0.5, chance.choice(materials), chance.randrange(9), segments=10)
        scatter(ball, chance)
    add_camera((0.13, -12.0, 0.41), (0.02, 0.0, 0.01), angle=35)
    nd.analyse(scene)
    return scene


def compare(samples: int) -> tuple[float, int]:
    """Render the scene as it is known and without an analysis; return how much the pictures differ, as a root mean square, and
    how many media knew what surrounds them.
    """
    known = render(samples)
    found = surroundings.last_found(scene_now())
    nd.clear_analysis(scene_now())
    live.remove()
    difference = float(np.sqrt(((render(samples) - known) ** 2).mean()))
    nd.analyse(scene_now())
    return difference, len(found.known)


def make_changes(seed: int, count: int, every: int, look: Callable[[str, float, int], None]) -> list[str]:
    """Make random changes to a scene, and render after every few of them with what is known and without.

    :param look: called with the names of the latest changes, how much the two pictures differ, as a root mean square, and how
        many media knew what surrounds them.
    :returns: what handlers raised, with the names of the changes before it.
    """
    chance = random.Random(seed)
    build_scene(chance)
    raised: list[str] = []
    latest: list[str] = []
    hook = sys.excepthook
    sys.excepthook = lambda *error: raised.append(f"{latest[-3:]}: {''.join(traceback.format_exception(*error))}")
    try:
        for index in range(1, count + 1):
            make = chance.choice(CHANGES)
            latest.append(make.__name__)
            make(chance)
            bpy.context.view_layer.update()
            if index % every == 0:
                leave_mode(chance)
                difference, knowing = compare(SAMPLES)
                if difference > SAME:
                    # What charges for tint decides which lobes Cycles draws; that is noise.
                    difference, knowing = compare(64 * SAMPLES)
                look(f"change {index} of seed {seed}, after {latest[-every:]}", difference, knowing)
    finally:
        sys.excepthook = hook
    return raised


def main(arguments: list[str]) -> int:
    """Make changes by the thousand, each scene from another seed."""
    count = int(arguments[0])
    seed = int(arguments[1]) if len(arguments) > 1 else 0
    looked: list[tuple[float, str, int]] = []
    raised: list[str] = []
    while count > 0:
        some_changes = min(count, 500)
        raised += make_changes(
            seed, some_changes, 10, lambda what, *numbers: looked.append((numbers[0], what, numbers[1]))
        )
        count -= some_changes
        seed += 1
    looked.sort(reverse=True)
    for difference, what, _ in looked[:10]:
        print(f"{difference:.5f}  {what}")
    differ, knew = (sum(flags) for flags in zip(*((one > SAME, bool(known)) for one, _, known in looked)))
    print(f"{len(looked)} renders, in {knew} media knew something, {differ} differ, {len(raised)} errors", *raised[:5])
    return bool(raised or differ)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
