"""Plots of a distribution and of the spectral table that is made of it."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np

from .colour_science import SpectrumError
from .distributions import spectrum
from .spectra import WAVELENGTHS
from .spectral_tables import preview

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def plot(distribution: str | os.PathLike, table: np.ndarray) -> Figure:
    """Draw a distribution's power, its table's weights and their colours over the wavelength.

    :raises SpectrumError: where matplotlib is missing, as in Blender's own Python.
    """
    light = spectrum(distribution)
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise SpectrumError(
            "plots need matplotlib, which this Python lacks; leave the plot out, or install matplotlib"
        ) from None
    figure = Figure(figsize=(8.0, 7.0), layout="constrained")
    power, weights, strip = figure.subplots(3, sharex=True, height_ratios=(3, 3, 1))
    largest = max(light.power) or 1.0
    power.fill_between(light.wavelengths, np.array(light.power) / largest, color="0.8")
    power.plot(light.wavelengths, np.array(light.power) / largest, color="0.3", label="per nm, over the largest")
    if light.lines:
        strongest = max(strength for _, strength in light.lines)
        power.vlines(
            *zip(*((nm, 0.0, strength / strongest) for nm, strength in light.lines)),
            color="tab:red",
            label="lines, over the strongest",
        )
        power.legend()
    power.set(title=light.name, ylabel="power", ylim=(0.0, 1.05))
    for channel, name in enumerate("RGB"):
        weights.plot(table[:, 3], table[:, channel], color=f"tab:{('red', 'green', 'blue')[channel]}", label=name)
    weights.axhline(0.0, color="0.3", linewidth=0.5)
    weights.set(ylabel="weight")
    weights.legend()
    shown = preview(table, 400, 60)
    shown[..., :3] **= 1 / 2.2
    strip.imshow(shown, origin="lower", aspect="auto", extent=(*WAVELENGTHS, 0, 1))
    strip.set(xlabel="wavelength (nm)", ylabel="drawn", yticks=(), xlim=WAVELENGTHS)
    return figure
