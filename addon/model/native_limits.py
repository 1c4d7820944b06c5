"""Where Cycles' own nodes render otherwise than the shader does."""

from __future__ import annotations

from dataclasses import replace

from .parameter import TINTED_MEDIA, Limit

APART = Limit(
    "weigh reflection by the surface, not by its facets, where it is rough or has a film",
    needs=("roughness", "reflection_roughness", "thin_film_thickness"),
)

LOBES = Limit("have no lobes of their own for lights and the world", alone=True, neutral=False)

LOBE_SHAPES = replace(LOBES, decides=False)

ANISOTROPIC = Limit("are isotropic before Blender 5.3", before=(5, 3, 0))

ANISOTROPIC_WAYS = replace(ANISOTROPIC, decides=False)

DISPERSION = Limit("split light by an Abbe number, in daylight, and not before Blender 5.3")

DISPERSION_CURVE = Limit("take its Abbe number alone", decides=False)

SPECTRUM_LIMIT = Limit("split light in daylight, in the working space, unclamped", alone=True, decides=False)

GLOW = Limit("do not tint what glows behind a medium", needs=(TINTED_MEDIA,))
