"""What every renderer gets of a scene: bodies, a camera and a sky, as plain arrays."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np


@dataclass(frozen=True, eq=False)
class Body:
    """A closed surface and what is in it.

    `vertices` (n, 3) float64 in world space; `triangles` (m, 3) int, counter-clockwise seen from outside. The lowest
    `priority` wins where bodies overlap; bodies of one priority do not overlap. `ior` is the index at 587.56 nm, `abbe`
    the Abbe number of a medium that disperses, 0 of one that does not. Bodies that share one shape share one array
    `triangles`.
    """

    name: str
    vertices: np.ndarray
    triangles: np.ndarray
    priority: int
    ior: float
    smooth: bool = False
    abbe: float = 0.0


@dataclass(frozen=True)
class View:
    """A pinhole camera for square pictures, Z up; `angle_degrees` is the whole field of view."""

    location: tuple[float, float, float]
    target: tuple[float, float, float]
    angle_degrees: float


@dataclass(frozen=True, eq=False)
class BenchScene:
    """What is rendered.

    `environment` (h, w, 3) float32, linear: radiance by direction as in :func:`directions`.
    `nested_media_cross` is whether surfaces of bodies cross; where not, they are apart or one wholly inside another.
    """

    name: str
    title: str
    bodies: tuple[Body, ...]
    view: View
    environment: np.ndarray
    nested_media_cross: bool


def directions(height: int, width: int) -> np.ndarray:
    """Unit vectors that the pixels of an equirectangular picture stand for, (height, width, 3).

    As in Blender: the first row is up (+Z), the middle column is +X, and columns to the left of it turn towards +Y.
    """
    azimuth = pi - 2.0 * pi * (np.arange(width) + 0.5) / width
    polar = pi * (np.arange(height) + 0.5) / height
    x = np.sin(polar)[:, None] * np.cos(azimuth)
    y = np.sin(polar)[:, None] * np.sin(azimuth)
    z = np.broadcast_to(np.cos(polar)[:, None], x.shape)
    return np.stack([x, y, z], axis=-1)


def banded_sky(frequency: float = 9.0, height: int = 512) -> np.ndarray:
    """Soft tilted bands, from a warm ground to a blue zenith; (height, 2 height, 3) float32 between 0.1 and 1.3.

    `frequency` is that of the bands, in radians over a unit of direction.
    """
    ways = directions(height, 2 * height)
    up = 0.5 + 0.5 * ways[..., 2:]
    blend = up * up * (3.0 - 2.0 * up)
    ground, zenith = np.array([1.3, 0.85, 0.45]), np.array([0.35, 0.75, 1.3])
    tilted = np.array([0.48, -0.2, 0.85])
    bands = 0.5 + 0.5 * np.sin(frequency * ways @ (tilted / np.linalg.norm(tilted)) + 0.7)
    return ((ground + (zenith - ground) * blend) * (0.3 + 0.7 * bands[..., None])).astype(np.float32)
