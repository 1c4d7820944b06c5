"""Rows of the spectrum whose colours are split."""

from __future__ import annotations

from .. import gamuts
from ..native_limits import SPECTRUM_LIMIT
from ..parameter import SPECTRUM_PANEL, Parameter

SPECTRUM: tuple[Parameter, ...] = (
    Parameter(
        "Spectral Distribution",
        SPECTRUM_PANEL,
        "TEXT",
        "DAYLIGHT",
        "Light whose colours are split; its mix is always white: a word of the list below, a CIE illuminant such "
        "as `FL11`, or a CSV file of wavelength (nm) and power. Fluorescent lamps show bands, daylight all "
        "colours",
        label="Light",
        needs=("disperse",),
        limit=SPECTRUM_LIMIT,
    ),
    Parameter(
        "Spectral Gamut",
        SPECTRUM_PANEL,
        "MENU",
        "SCENE",
        "Colour space that split colours are made in: wider ones keep them purer",
        choices=gamuts.GAMUTS,
        label="Gamut",
        needs=("disperse",),
        limit=SPECTRUM_LIMIT,
    ),
    Parameter(
        "Spectral Saturation",
        SPECTRUM_PANEL,
        "FLOAT",
        1.0,
        "Mixes split colours to greys of their brightness; 1 is physical",
        0.0,
        1.0,
        "FACTOR",
        label="Saturation",
        needs=("disperse",),
        limit=SPECTRUM_LIMIT,
    ),
    Parameter(
        "Clamp Negative",
        SPECTRUM_PANEL,
        "BOOL",
        True,
        "Cuts off what of split colours lies outside the gamut, which makes them paler; off, negative values "
        "reach the picture and come right in wider colour spaces",
        needs=("disperse",),
        limit=SPECTRUM_LIMIT,
    ),
)
