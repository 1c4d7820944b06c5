"""Rows of which light is followed."""

from __future__ import annotations

from ..native_limits import APART
from ..parameter import UNLIMITED_REFLECTIONS, Limit, Parameter

SAMPLING: tuple[Parameter, ...] = (
    Parameter(
        "Polarize",
        "Polarizing Filter",
        "BOOL",
        False,
        "Looks at the first surface through a polarizing filter, which takes away or keeps its reflections",
        limit=APART,
    ),
    Parameter(
        "Polarization Angle",
        "Polarizing Filter",
        "FLOAT",
        0.0,
        "Turns the filter, clockwise from the camera's vertical: at 0 reflections on level water vanish near 53 "
        "degrees",
        -1e4,
        1e4,
        "ANGLE",
        label="Angle",
        needs=("polarize",),
    ),
    Parameter(
        "Internal Reflections",
        "Sampling",
        "BOOL",
        True,
        "Shows weak reflections inside media. Off is darker and less noisy; total reflection stays",
        limit=APART,
    ),
    Parameter(
        "Max Interior Reflections",
        "Sampling",
        "INT",
        UNLIMITED_REFLECTIONS,
        "A path that has been reflected this often is not reflected inside media any more: fewer render faster, "
        "and sparkle less. Cycles' glossy bounces end it, too",
        0,
        UNLIMITED_REFLECTIONS,
        label="Max Reflections",
        limit=APART,
    ),
    Parameter(
        "Reflection Probability",
        "Sampling",
        "FLOAT",
        1.0,
        "How often weak reflections inside media are traced: less often is faster and noisier at the same "
        "brightness. 0 and 1 leave the choice to Cycles",
        0.0,
        1.0,
        "FACTOR",
        label="Probability",
        needs=("internal_reflections",),
        limit=Limit("leave the choice to Cycles, which changes the noise alone", decides=False),
    ),
    Parameter(
        "Energy Cutoff Exponent",
        "Sampling",
        "FLOAT",
        -20.0,
        "Gives up reflection or refraction that carries less than 10 to this power of the light, which darkens "
        "deep reflections. -20 gives up nothing",
        -20.0,
        0.0,
        label="Energy Cutoff",
        limit=Limit("give up nothing", alone=True),
    ),
)
