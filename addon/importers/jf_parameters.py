"""Parameters of JF Nested Dielectric, a shader for Arnold, with their kinds and defaults.

Reference: JF Nested Dielectric 1.0.5 (2015), its manual and its published interface.
"""

from __future__ import annotations

from typing import Any

NODE_TYPE = "jf_nested_dielectric"
"""Arnold's name of the shader; case and underscores do not matter."""


class JfError(ValueError):
    """A file or a value that cannot be read. The text names it and the remedy."""


# Words of JF's enumerations, in the order of their numbers.
_LOBES = ("stretched_phong", "cook_torrance", "ward_rayTangent", "ward_userTangent")
_SPECTRA = ("full", "daylight", "bluesky", "sunset", "LED", "flourescent", "sodium")  # spelt as in JF
_GAMUTS = ("sRGB", "AdobeRGB", "WideGamut", "ProPhotoRGB", "ACES")
_SHADOWS = ("black", "transmit_only", "transmit_and_outer_fresnels", "transmit_and_all_fresnels")
_RAY_TYPES = ("Glossy", "Reflected")

JF_PARAMETERS: dict[str, tuple[str | tuple[str, ...], Any]] = {
    "mediumPriority": ("INT", 0),
    "mediumIOR": ("FLOAT", 1.33),
    "mediumTransmittance": ("RGB", (1.0, 1.0, 1.0)),
    "mediumTransmittance_scale": ("FLOAT", 1.0),
    "polarize": ("BOOL", False),
    "polarization_angle": ("FLOAT", 0.0),
    "refraction_scale": ("FLOAT", 1.0),
    "btdf": (_LOBES, "cook_torrance"),
    "refraction_roughness_u": ("FLOAT", 0.0),
    "refraction_roughness_v": ("FLOAT", 0.0),
    "indirect_refraction": ("FLOAT", 1.0),
    "direct_refraction": ("FLOAT", 1.0),
    "dr_roughnessOffset": ("FLOAT", 0.05),
    "dr_roughnessDepthMultiplier": ("FLOAT", 1.0),
    "dr_roughnessDepthAdder": ("FLOAT", 0.0),
    "dr_use_refraction_btdf": ("BOOL", True),
    "dr_btdf": (_LOBES, "cook_torrance"),
    "dr_roughness_u": ("FLOAT", 0.0),
    "dr_roughness_v": ("FLOAT", 0.0),
    "dr_second_scale": ("FLOAT", 0.0),
    "dr_second_roughnessMultiplier": ("FLOAT", 2.0),
    "disperse": ("BOOL", False),
    "dispersion": ("FLOAT", 0.03),
    "spectral_distribution": (_SPECTRA, "daylight"),
    "spectral_gamut": (_GAMUTS, "sRGB"),
    "spectral_clamp_negative_colors": ("BOOL", True),
    "spectral_saturation": ("FLOAT", 1.0),
    "specular_scale": ("FLOAT", 1.0),
    "brdf": (_LOBES, "cook_torrance"),
    "direct_specular": ("FLOAT", 1.0),
    "indirect_specular": ("FLOAT", 1.0),
    "specular_roughness_u": ("FLOAT", 0.0),
    "specular_roughness_v": ("FLOAT", 0.0),
    "specular_ray_type": (_RAY_TYPES, "Glossy"),
    "blur_anisotropic_poles": ("FLOAT", 0.0),
    "enable_internal_reflections": ("BOOL", True),
    "russian_roulette_probability": ("FLOAT", 0.5),
    "energy_cutoff_exponent": ("INT", -5),
    "ward_tangent": ("VECTOR", (0.0, 1.0, 0.0)),
    "refract_skydomes": ("BOOL", False),
    "refract_skies": ("BOOL", True),
    "reflect_skydomes": ("BOOL", True),
    "reflect_skies": ("BOOL", True),
    "emission_at_interfaces": ("RGB", (0.0, 0.0, 0.0)),
    "emission_at_exits": ("RGB", (0.0, 0.0, 0.0)),
    "emission_at_entrances": ("RGB", (0.0, 0.0, 0.0)),
    "shadow_mode": (_SHADOWS, "transmit_and_outer_fresnels"),
    "caustic_mode": ("INT", 0),
    "caustic_refractions_direct": ("BOOL", True),
    "caustic_dr_roughness_offset": ("FLOAT", 0.1),
    "caustic_refractions_indirect": ("BOOL", False),
    "caustic_TIR": ("BOOL", False),
    "caustic_internal_speculars": ("BOOL", False),
    "caustic_dispersion": ("BOOL", False),
    "caustic_specular_direct": ("BOOL", False),
    "caustic_specular_indirect": ("BOOL", False),
    "caustic_max_distance": ("FLOAT", -1.0),
    "aov_direct_refraction": ("TEXT", ""),
    "aov_indirect_refraction": ("TEXT", "Refraction"),
    "aov_direct_specular": ("TEXT", "Direct_Specular"),
    "aov_indirect_specular": ("TEXT", "Indirect_Specular"),
}
"""Every parameter of JF 1.0.5: its kind, or its words in the order of their numbers, and its default."""
