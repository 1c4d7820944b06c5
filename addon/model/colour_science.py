"""The package colour-science: the CIE's tables, and spaces of colours."""

from __future__ import annotations

import sys
import warnings
from functools import cache
from types import ModuleType

import numpy as np


class SpectrumError(ValueError):
    """A spectrum, gamut or saturation that no table can be made of. The text names what is wrong and the remedy."""


@cache
def colour_science() -> ModuleType:
    """Import colour-science when it is first needed, which takes a second, and return it.

    Without SciPy and matplotlib it warns, puts mock modules in their place, which would make other add-ons believe that
    they are there, and changes how NumPy prints. So warnings are silent, the mock modules go and NumPy prints as before.

    :raises SpectrumError: where it is missing.
    """
    with warnings.catch_warnings(), np.printoptions():
        warnings.simplefilter("ignore")
        try:
            import colour
        except ImportError as error:
            raise SpectrumError(
                f"spectra need colour-science ({error}); install the extension's zip again, or pip install "
                "colour-science"
            ) from None
    for name, module in list(sys.modules.items()):
        if type(module).__module__ == "unittest.mock":
            del sys.modules[name]
    return colour
