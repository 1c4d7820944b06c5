"""Rows of the shaders that glow at the surface."""

from __future__ import annotations

from ..native_limits import GLOW
from ..parameter import Parameter

EMISSION: tuple[Parameter, ...] = (
    Parameter(
        "Emission at Interfaces",
        "Emission",
        "SHADER",
        None,
        "Shader that glows wherever two media, or a medium and air, meet",
        label="At Interfaces",
        limit=GLOW,
    ),
    Parameter(
        "Emission at Entrances",
        "Emission",
        "SHADER",
        None,
        "Shader that glows where rays enter a medium from air",
        label="At Entrances",
        limit=GLOW,
    ),
    Parameter(
        "Emission at Exits",
        "Emission",
        "SHADER",
        None,
        "Shader that glows where rays leave all media into air",
        label="At Exits",
        limit=GLOW,
    ),
)
