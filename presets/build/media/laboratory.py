"""Laboratory glass: the catalogue of Schott, and fused silica."""

from ..absorption import Measured
from ..indices import Sellmeier
from ..recipe import Recipe

GROUP = "Laboratory Glass"

BK7 = Sellmeier((1.03961212, 0.231792344, 1.01046945), (0.00600069867, 0.0200179144, 103.560653))


def _schott(key: str, glass: str, description: str, tags: str, index: Sellmeier, **keywords) -> Recipe:
    """A glass whose index and absorption are those of Schott's catalogue."""
    return Recipe(
        key,
        f"{glass.removeprefix('N-')} Glass",
        GROUP,
        tags,
        description,
        f"Schott (2017), data sheet {glass}, Sellmeier form, index against air; internal transmittance of the same "
        "sheet, from the refractiveindex.info database.",
        index,
        depth=0.05,
        absorption=(Measured(f"specs/SCHOTT-optical/{glass}"),),
        **keywords,
    )


MEDIA = (
    Recipe(
        "bk7",
        "BK7 Glass",
        GROUP,
        "lens, prism, optical, schott, crown",
        "Borosilicate crown glass, the most common glass for lenses, prisms and windows of instruments.",
        "Schott (2017), data sheet N-BK7, Sellmeier form; index against air.",
        BK7,
    ),
    Recipe(
        "sf11",
        "SF11 Glass",
        GROUP,
        "prism, flint, lens, optical, schott, rainbow",
        "Dense flint glass for prisms that spread white light into a wide spectrum.",
        "Schott (2017), data sheet N-SF11 (the lead-free glass; SF11 has V_d 25.76 in place of 25.68), Sellmeier "
        "form; index against air.",
        Sellmeier((1.73759695, 0.313747346, 1.89878101), (0.013188707, 0.0623068142, 155.23629)),
        disperse=True,
    ),
    _schott(
        "f2",
        "F2",
        "Lead flint glass, the classic glass for prisms of spectroscopes.",
        "prism, flint, lens, optical, schott, rainbow",
        Sellmeier((1.34533359, 0.209073176, 0.937357162), (0.00997743871, 0.0470450767, 111.886764)),
        disperse=True,
    ),
    _schott(
        "sf10",
        "SF10",
        "Dense lead flint glass for prisms and lenses, faintly yellow when thick.",
        "prism, flint, lens, optical, schott, rainbow",
        Sellmeier((1.61625977, 0.259229334, 1.07762317), (0.0127534559, 0.0581983954, 116.60768)),
        disperse=True,
    ),
    _schott(
        "lasf9",
        "N-LASF9",
        "Lanthanum dense flint, a glass of high index for the strong lenses of cameras.",
        "lens, camera, lanthanum, optical, schott, high index",
        Sellmeier((2.00029547, 0.298926886, 1.80691843), (0.0121426017, 0.0538736236, 156.530829)),
    ),
    _schott(
        "lasf35",
        "LASF35",
        "Lanthanum dense flint with an index of 2, one of the highest that optical glass has.",
        "lens, camera, lanthanum, optical, schott, high index",
        Sellmeier((2.45505861, 0.453006077, 2.3851308), (0.0135670404, 0.054580302, 167.904715)),
    ),
    _schott(
        "bak4",
        "N-BAK4",
        "Barium crown glass, as in the prisms of binoculars.",
        "lens, binoculars, barium, crown, optical, schott",
        Sellmeier((1.28834642, 0.132817724, 0.945395373), (0.00779980626, 0.0315631177, 105.965875)),
    ),
    _schott(
        "fk51a",
        "N-FK51A",
        "Fluorophosphate crown, a glass of little dispersion (ED) for lenses without coloured fringes.",
        "lens, ed glass, telescope, apochromat, optical, schott",
        Sellmeier((0.971247817, 0.216901417, 0.904651666), (0.00472301995, 0.0153575612, 168.68133)),
    ),
    Recipe(
        "fused_silica",
        "Fused Silica",
        GROUP,
        "quartz glass, lamp, fibre",
        "Pure silica glass (quartz glass), as in laboratory ware, lamps and fibres.",
        "Malitson (1965), Interspecimen comparison of the refractive index of fused silica, Journal of the Optical "
        "Society of America 55(10), Sellmeier form at 20 C.",
        Sellmeier((0.6961663, 0.4079426, 0.8974794), (0.00467914825849, 0.013512063074, 97.9340025379)),
    ),
    Recipe(
        "coated_lens",
        "Coated Lens",
        GROUP,
        "lens, camera, anti-reflection, coating, magnesium fluoride, spectacles",
        "BK7 with a quarter wave of magnesium fluoride against reflections, whose rest is purple.",
        "Glass as BK7: Schott (2017), data sheet N-BK7. Film: magnesium fluoride of index 1.38 (Dodge, 1984, Applied "
        "Optics 23, ordinary ray at 550 nm), a quarter of 550 nm thick.",
        BK7,
        others=(("thin_film_thickness", 99.6), ("thin_film_ior", 1.38)),
    ),
)
