"""The words that parameters choose from."""

from __future__ import annotations

from .choice import Choice

SHADOW_MODES = (
    Choice("BLACK", "Black", "No light passes a shadow; light arrives by paths alone, as caustics"),
    Choice("TRANSMISSION", "Transmission Only", "Shadows take the colour that absorption leaves"),
    Choice(
        "OUTSIDE_FRESNEL",
        "Transmission and Outside Fresnel",
        "Also darker by what the surface reflects where a shadow ray enters from air",
    ),
    Choice(
        "ALL_FRESNEL",
        "Transmission and All Fresnel",
        "Also darker by what every interface reflects; total reflection shows as black edges",
    ),
)

DISTRIBUTIONS = (
    Choice("GGX", "GGX", "Single scattering: rough surfaces lose some energy"),
    Choice(
        "MULTI_GGX", "Multiscatter GGX", "Keeps the energy of light that scatters several times on the microsurface"
    ),
    Choice("BECKMANN", "Beckmann", "A narrower lobe with shorter tails"),
)

TANGENTS = (
    Choice("TANGENT", "Tangent", "The socket Tangent; without a link, around the object's Z axis"),
    Choice("REFRACTION", "Refraction", "The way of the refracted light along the surface"),
)

DISPERSION_MODELS = (
    Choice("ABBE", "Abbe", "Cauchy's two terms, from the index and the Abbe number"),
    Choice("SELLMEIER", "Sellmeier", "Three terms, as most measured curves are published"),
    Choice("JF", "JF", "The spread of JF Nested Dielectric, for scenes that come from there"),
)
