"""What the scene says of cut surfaces beside what their faces say (:mod:`~nested_dielectric.model.contract`)."""

from __future__ import annotations

CUT_WITH_COLOUR, CUT_WITH_DISPERSION = 2.0, 3.0
"""What a scene's property of cut surfaces is from where faces tell the colour of media outside, and how they disperse."""
