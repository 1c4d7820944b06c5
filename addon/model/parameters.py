"""Every parameter of the material, written down once.

Sockets of the node group, keyword arguments of :func:`nested_dielectric.new_material`, the names a preset file may
use, the inputs of the OSL shader and the manual's table all come from :data:`PARAMETERS`.

A spectral table is baked from the parameters of the panel `Spectrum`, so these are settings of a material and no
sockets.
"""

from __future__ import annotations

from typing import Any

from .parameter import (
    SPECTRUM_PANEL,
    Parameter,
    ParameterError,
)
from .rows.caustics import CAUSTICS
from .rows.direct_light import DIRECT_LIGHT
from .rows.emission import EMISSION
from .rows.medium import MEDIUM
from .rows.sampling import SAMPLING
from .rows.spectrum import SPECTRUM
from .rows.surface import SURFACE
from .rows.weights import WEIGHTS

PARAMETERS: tuple[Parameter, ...] = (
    *MEDIUM,
    *SURFACE,
    *WEIGHTS,
    *DIRECT_LIGHT,
    *SAMPLING,
    *CAUSTICS,
    *EMISSION,
    *SPECTRUM,
)

BY_KEYWORD = {parameter.keyword: parameter for parameter in PARAMETERS}

BY_NAME = {parameter.name: parameter for parameter in PARAMETERS}

SOCKETS = tuple(parameter for parameter in PARAMETERS if parameter.panel != SPECTRUM_PANEL)
"""Parameters that are sockets of the node group."""

SETTINGS = tuple(parameter for parameter in PARAMETERS if parameter.panel == SPECTRUM_PANEL)
"""Parameters that a spectral table is baked from."""

NEIGHBOUR_PARAMETERS = (
    "Priority",
    "IOR",
    "Transmittance",
    "Transmittance Depth",
    *(parameter.name for parameter in PARAMETERS if parameter.panel == "Dispersion"),
)
"""Sockets whose values other media read while they render; a link into them is not seen by neighbours."""


def check_keywords(keywords: dict[str, Any]) -> dict[Parameter, Any]:
    """Match keyword arguments to parameters, and check their values.

    Raise :class:`ParameterError` for the first that is wrong.
    """
    checked = {}
    for keyword, value in keywords.items():
        if keyword not in BY_KEYWORD:
            raise ParameterError(f"unknown parameter {keyword!r}; known are: {', '.join(BY_KEYWORD)}")
        parameter = BY_KEYWORD[keyword]
        checked[parameter] = parameter.check(value)
    return checked
