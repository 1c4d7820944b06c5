"""Random scenes of media as plain data, the same for the same seed; :mod:`random_bodies` builds them in Blender."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, replace

Triple = tuple[float, float, float]

SCENES = range(200)
"""Seeds of the scenes that only have to keep light's energy and look the same however they are rendered."""

SPLIT_SCENES = range(1000, 1030)
"""Seeds of those that are split by hand as well: one body a medium, of flat-shaded meshes that share no faces."""

ARRANGEMENTS = ("crossing", "contained", "coincident", "crossing", "crowded")
"""How bodies lie, by seed."""

MESHES = ("ball", "geodesic", "box", "cone", "ring", "capsule", "vessel", "shell", "islands")
"""Shapes that are closed meshes; all reach about 1 from their origin."""

OTHERS = ("curve", "text", "metaball")
"""Shapes that become meshes in the end alone."""

ROUND = ("ball", "geodesic", "ring", "capsule", "shell", "metaball")
"""Shapes that are fine enough to be shaded smooth."""

ORDINARY = (1.0, 1.1, 1.31, 1.333, 1.5, 1.52, 1.8, 2.42)
"""Indices that scenes have for the most part."""

LEAST_IOR, MOST_IOR = 0.1, 10.0

SPLITS_BY_TIME, SPLITS_BY_CYCLES = "by time", "by Cycles"
"""How light is split: by wavelengths that paths carry in their time, or by Cycles' own dispersion."""


@dataclass(frozen=True)
class Place:
    """Location, rotation in radians (XYZ Euler angles) and scale, which may be negative."""

    location: Triple = (0.0, 0.0, 0.0)
    rotation: Triple = (0.0, 0.0, 0.0)
    scale: Triple = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Medium:
    """What bodies are filled with; 0 for the Abbe number of what does not disperse."""

    ior: float
    roughness: float = 0.0
    abbe: float = 0.0


@dataclass(frozen=True)
class Body:
    """A shape of one medium. A place and a turned, stretched parent make a skewed transform."""

    shape: str
    medium: int
    place: Place
    parent: Place | None = None
    smooth: bool = False


@dataclass(frozen=True)
class RandomScene:
    """Media, of which the first wins, and the bodies of them."""

    seed: int
    arrangement: str
    media: tuple[Medium, ...]
    bodies: tuple[Body, ...]
    camera_inside: bool = False
    splits: str = ""

    @property
    def rough(self) -> bool:
        """Whether any medium's surface is."""
        return any(medium.roughness > 0.0 for medium in self.media)

    @property
    def disperses(self) -> bool:
        """Whether any medium does."""
        return any(medium.abbe > 0.0 for medium in self.media)


def random_media_scene(seed: int) -> RandomScene:
    """Make the scene of a seed."""
    chance = random.Random(f"media {seed}")
    by_hand = seed in SPLIT_SCENES
    arrangement = ("crossing", "contained")[seed % 2] if by_hand else ARRANGEMENTS[seed % len(ARRANGEMENTS)]
    rough = chance.random() < 0.25
    splits = "" if rough or by_hand else chance.choice(("", "", "", SPLITS_BY_TIME, SPLITS_BY_CYCLES))
    bodies = _arranged(arrangement, chance, by_hand)
    media = tuple(
        _medium(chance, rough, bool(splits), ORDINARY[by_hand:]) for _ in range(1 + max(body.medium for body in bodies))
    )
    if not any(medium.abbe for medium in media):
        splits = ""
    # From within dense media much light is reflected totally for ever, which takes all bounces.
    inside = chance.random() < 0.15 and not by_hand and max(medium.ior for medium in media) < 2.0
    return RandomScene(seed, arrangement, media, tuple(bodies), inside, splits)


def _medium(chance: random.Random, rough: bool, disperses: bool, ordinary: tuple[float, ...]) -> Medium:
    """Draw a medium of any index or of an ordinary one; in rough scenes one that is rough, now and then, and so on."""
    if chance.random() < 0.7 or disperses:
        ior = chance.choice(ordinary)
    else:
        ior = LEAST_IOR * (MOST_IOR / LEAST_IOR) ** chance.random()
    if rough and chance.random() < 0.6:
        return Medium(ior, roughness=chance.choice((0.05, 0.1, 0.3, 0.6, 1.0)))
    if disperses and ior > 1.2 and chance.random() < 0.7:
        return Medium(ior, abbe=chance.choice((15.0, 30.0, 60.0)))
    return Medium(ior)


def _arranged(arrangement: str, chance: random.Random, by_hand: bool) -> list[Body]:
    """Return the bodies of a scene."""
    if arrangement == "contained":
        return _contained(chance, by_hand)
    if arrangement == "coincident":
        return _coincident(chance)
    count = chance.randint(8, 12) if arrangement == "crowded" else chance.randint(3 if by_hand else 2, 5)
    media = list(range(count)) if by_hand else [chance.randrange(min(count, 6)) for _ in range(count)]
    chance.shuffle(media)
    size = 0.6 if arrangement == "crowded" else 1.0
    spread = 0.4 if by_hand else 0.9  # where all overlap, Glass as modelled is farthest from what is right
    bodies = [_scattered(_shape(chance, by_hand), medium, chance, size, spread) for medium in media]
    return [_shaded(body, chance, by_hand) for body in bodies]


def _shape(chance: random.Random, by_hand: bool) -> str:
    return chance.choice(OTHERS) if not by_hand and chance.random() < 0.12 else chance.choice(MESHES)


def _shaded(body: Body, chance: random.Random, by_hand: bool) -> Body:
    return replace(body, smooth=not by_hand and body.shape in ROUND and chance.random() < 0.4)


def _turn(chance: random.Random) -> Triple:
    return tuple(chance.uniform(-math.pi, math.pi) for _ in range(3))


def _scattered(shape: str, medium: int, chance: random.Random, size: float, spread: float = 0.9) -> Body:
    """Draw a place that far from the middle at most: plainly scaled, stretched, mirrored or skewed by a parent."""
    kind = chance.choice(("plain", "stretched", "mirrored", "skewed"))
    scale = [size * chance.uniform(0.5, 1.1)] * 3
    if kind != "plain":
        scale = [value * chance.uniform(0.6, 1.3) for value in scale]
    if kind == "mirrored":
        for axis in chance.choice(((0,), (1,), (2,), (0, 1, 2))):
            scale[axis] *= -1.0
    parent = None
    if kind == "skewed":
        stretch = [chance.uniform(0.5, 1.5) * chance.choice((1.0, 1.0, -1.0)) for _ in range(3)]
        parent = Place(tuple(chance.uniform(-0.2, 0.2) for _ in range(3)), _turn(chance), tuple(stretch))
    location = tuple(chance.uniform(-spread, spread) for _ in range(3))
    return Body(shape, medium, Place(location, _turn(chance), tuple(scale)), parent)


def _contained(chance: random.Random, by_hand: bool) -> list[Body]:
    """Return balls and boxes, each wholly within the one before it, in any order of priorities; rarely one across them."""
    count = chance.randint(3 if by_hand else 2, 7)
    order = list(range(count))
    chance.shuffle(order)
    bodies, room, centre = [], 1.3, (0.0, 0.0, 0.0)
    for medium in order:
        shape = chance.choice(("ball", "geodesic", "box"))
        # A body's inner ball holds the next, so room shrinks by the thickness of what is between.
        half = room / math.sqrt(3.0) if shape == "box" else room
        scale = [half * chance.choice((1.0, 1.0, -1.0))] * 3
        bodies.append(Body(shape, medium, Place(centre, _turn(chance), tuple(scale))))
        inner = half * (1.0 if shape == "box" else 0.94)  # facets of balls lie within the round one
        room = inner * chance.uniform(0.7, 0.95)
        way = [chance.gauss(0.0, 1.0) for _ in range(3)]
        slack = 0.9 * (inner - room) * chance.random() / math.dist(way, (0.0, 0.0, 0.0))
        centre = tuple(value + slack * part for value, part in zip(centre, way))
    if chance.random() < 0.3:
        bodies.append(_scattered(_shape(chance, by_hand), count, chance, 0.7))
    return [_shaded(body, chance, by_hand) for body in bodies]


def _coincident(chance: random.Random) -> list[Body]:
    """Return bodies of which some share faces exactly, in a turned frame."""
    frame = Place(tuple(chance.uniform(-0.2, 0.2) for _ in range(3)), chance.choice(((0.0, 0.0, 0.0), _turn(chance))))
    make = chance.choice((_flush_blocks, _flush_fill, _duplicates))
    bodies = [replace(body, parent=frame) for body in make(chance)]
    if chance.random() < 0.5:
        medium = max(body.medium for body in bodies) + 1
        bodies.append(_scattered(chance.choice(MESHES), medium, chance, 0.6))
    media = list(range(1 + max(body.medium for body in bodies)))
    chance.shuffle(media)
    return [replace(body, medium=media[body.medium]) for body in bodies]


def _block(medium: int, low: Triple, high: Triple) -> Body:
    middle = tuple((a + b) / 2.0 for a, b in zip(low, high))
    return Body("box", medium, Place(middle, scale=tuple((b - a) / 2.0 for a, b in zip(low, high))))


def _flush_blocks(chance: random.Random) -> list[Body]:
    """Return blocks on a plane: on all of a face, shifted along it, or beside each other in corners."""
    shift = chance.choice(((0.0, 0.0), (0.5, 0.5), (0.5, 0.0), (0.001, 0.0)))
    x, y = shift
    bodies = [_block(0, (-1, -1, -1), (1, 1, 0)), _block(1, (x - 1, y - 1, 0), (x + 1, y + 1, 0.75))]
    if chance.random() < 0.5:
        bodies.append(_block(2, (-0.5, -1, -1), (0.5, 1, -0.25)))
    return bodies


def _flush_fill(chance: random.Random) -> list[Body]:
    """Return a shell and what fills it to the wall, or to half of a wall."""
    scale = (0.7, 0.7, 0.7)  # as :func:`random_bodies.build_shell` makes its cavity
    bodies = [Body("shell", 0, Place()), Body("ball", 1, Place(scale=scale))]
    if chance.random() < 0.5:
        bodies.append(Body("box", 2, Place((0.1, 0.05, 0.0), (0.3, 0.2, 0.1), (0.3, 0.3, 0.3))))
    return bodies


def _duplicates(chance: random.Random) -> list[Body]:
    """Return one shape two or three times in the same place, of one medium or of several."""
    shape = chance.choice(("ball", "box", "cone", "ring"))
    return [Body(shape, min(index, chance.randint(0, 2)), Place()) for index in range(chance.randint(2, 3))]
