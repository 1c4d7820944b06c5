"""Glass of tableware, windows and bottles."""

from ..absorption import Band, Measured, Term
from ..indices import Index, Sellmeier
from ..recipe import Recipe

GROUP = "Glass"
IRON = 0.0703
"""Percent of Fe2O3 in the glass of Vogt et al."""

SODA_LIME = Sellmeier((-8.25902649, 9.54814027, 2.85896563), (0.0, 0.001256335, 300.0))

RUBIN = (
    "Rubin (1985), Optical properties of soda lime silica glasses, Solar Energy Materials 12(4): n = 1.5130 - "
    "0.003169 L^2 + 0.003962 / L^2 with L in micrometres. Three Sellmeier terms fitted to it: within 1e-7 from 380 "
    "to 780 nm."
)
BAMFORD = (
    "(Bamford, 1977, Colour generation and control in glass; Bates, 1962, in Modern aspects of the vitreous state 2)"
)
VOGT = "iron of {} % of Fe2O3, scaled from the k of glass with 0.0703 % (Vogt et al., 2016)"

# Chromium(III): 18 l/mol/cm in both of its bands; 0.2 % of Cr2O3 are 0.066 mol/l of it.
CHROMIUM = (Band(450.0, 1.19, 3300.0), Band(650.0, 1.19, 3000.0))
# Cobalt(II) among four oxygens, 0.06 % of CoO: 0.02 mol/l with 170 l/mol/cm in the middle one of its three bands.
COBALT = (Band(535.0, 2.4, 2400.0), Band(590.0, 3.4, 1600.0), Band(645.0, 3.5, 1500.0, 1200.0))
# Iron and sulphur, the amber chromophore; iron(II).
AMBER = (Band(412.0, 6.3, 9000.0), Band(1050.0, 0.5, 5200.0))


def _iron(percent: float) -> Term:
    """What Fe2O3 absorbs in soda-lime glass."""
    return Measured("glass/soda-lime/Vogt-703ppm", percent / IRON)


def _glass(
    key: str, name: str, tags: str, description: str, source: str, depth: float, *absorption, **keywords
) -> Recipe:
    """A soda-lime glass."""
    index: Index = keywords.pop("index", SODA_LIME)
    return Recipe(key, name, GROUP, tags, description, source, index, depth=depth, absorption=absorption, **keywords)


MEDIA = (
    _glass(
        "glass",
        "Glass",
        "drinking glass, tumbler, bottle, window, soda lime, clear",
        "Clear soda-lime glass, as in tumblers, bottles and windows.",
        RUBIN.replace("12(4):", "12(4), clear glass:"),
        0.0,
    ),
    _glass(
        "drinking_glass",
        "Drinking Glass",
        "tumbler, wine glass, cup, goblet, tableware, clear, jar",
        "Glass of tableware, low in iron: colourless, with the faintest green where one looks along it.",
        f"{RUBIN} Absorption: k of its low-iron glass, as measured.",
        0.004,
        Measured("glass/soda-lime/Rubin-lowiron"),
    ),
    _glass(
        "window_glass",
        "Window Glass",
        "pane, float glass, green edge, shelf, mirror, table top",
        "Float glass: clear through the pane, green along its edge.",
        f"{RUBIN} Absorption: k of its clear window glass, as measured.",
        0.004,
        Measured("glass/soda-lime/Rubin-clear"),
    ),
    _glass(
        "green_glass",
        "Green Tinted Glass",
        "window, car, solar, facade, tinted",
        "Window glass tinted green with iron, as in cars and facades.",
        f"{RUBIN} Absorption: k of its green glass, as measured.",
        0.006,
        Measured("glass/soda-lime/Rubin-green"),
    ),
    _glass(
        "grey_glass",
        "Grey Tinted Glass",
        "window, car, solar, facade, smoked, tinted, sunglasses",
        "Window glass tinted grey, as in cars, facades and smoked table tops.",
        f"{RUBIN} Absorption: k of its grey glass, as measured.",
        0.006,
        Measured("glass/soda-lime/Rubin-grey"),
    ),
    _glass(
        "bronze_glass",
        "Bronze Tinted Glass",
        "window, solar, facade, brown, smoked, tinted, sunglasses",
        "Window glass tinted bronze, as in facades and shower screens.",
        f"{RUBIN} Absorption: k of its bronze glass, as measured.",
        0.006,
        Measured("glass/soda-lime/Rubin-bronze"),
    ),
    _glass(
        "frosted_glass",
        "Frosted Glass",
        "ground, etched, satin, sandblasted, milky, bathroom, lamp",
        "Ground glass. The frost is the roughness of its surface, not scattering inside.",
        f"{RUBIN} Roughness: an alpha of GGX of about 0.4 (roughness is its square root), as Walter, Marschner, Li "
        "and Torrance (2007), Microfacet models for refraction through rough surfaces, fitted to ground glass.",
        0.0,
        others=(("roughness", 0.63), ("distribution", "GGX")),
    ),
    _glass(
        "antiglare_glass",
        "Anti-glare Glass",
        "picture frame, screen, matt, satin",
        "Glass with a slightly matt surface, as over pictures and screens.",
        f"{RUBIN} Roughness: an alpha of GGX of about 0.03 (roughness is its square root), as Walter, Marschner, Li "
        "and Torrance (2007), Microfacet models for refraction through rough surfaces, fitted to antiglare glass.",
        0.0,
        others=(("roughness", 0.17), ("distribution", "GGX")),
    ),
    _glass(
        "crystal",
        "Lead Crystal",
        "crystal glass, cut glass, decanter, chandelier, wine glass, fire, rainbow",
        "Lead glass of cut decanters, chandeliers and wine glasses, with more sparkle and fire than window glass.",
        "Schott (2017), data sheet LLF1, a lead silicate glass with the index of lead crystal, Sellmeier form, index "
        "against air; internal transmittance of the same sheet, from the refractiveindex.info database.",
        0.005,
        Measured("specs/SCHOTT-optical/LLF1"),
        index=Sellmeier((1.21640125, 0.13366454, 0.883399468), (0.00857807248, 0.0420143003, 107.59306)),
        disperse=True,
    ),
    _glass(
        "borosilicate_glass",
        "Borosilicate Glass",
        "pyrex, duran, oven, teapot, beaker, flask, test tube, laboratory",
        "Heat-resisting glass of oven dishes, teapots and laboratory ware.",
        "Schott (2021), BOROFLOAT 33 - Optical Properties: Sellmeier form fitted to its table, and k from its "
        "transmittance, both as in the refractiveindex.info database.",
        0.004,
        Measured("specs/SCHOTT-misc/BOROFLOAT33"),
        index=Sellmeier((0.3542, 0.78657, 0.18285), (0.0, 0.0117852736, 19.598329)),
    ),
    _glass(
        "bottle_green",
        "Green Bottle Glass",
        "wine bottle, beer bottle, emerald, champagne, container",
        "Emerald green container glass, as of wine bottles.",
        f"{RUBIN} Absorption: bands of chromium(III) at 450 and 650 nm, about 18 l/mol/cm, for 0.2 % of Cr2O3 "
        f"{BAMFORD}; {VOGT.format(0.3)}.",
        0.005,
        *CHROMIUM,
        _iron(0.3),
    ),
    _glass(
        "bottle_amber",
        "Amber Bottle Glass",
        "beer bottle, brown, medicine bottle, pharmacy, container",
        "Amber container glass, as of beer and medicine bottles.",
        f"{RUBIN} Absorption: the band of iron and sulphur at 412 nm (Harding, 1972, Glass Technology 13) and that of "
        "iron(II) at 1050 nm. No published strength: that of a wall of 2.5 mm that lets a third of the light of 550 "
        "nm through.",
        0.003,
        *AMBER,
    ),
    _glass(
        "bottle_cobalt",
        "Cobalt Blue Glass",
        "blue bottle, perfume bottle, apothecary, vase, container, stained glass",
        "Glass made deep blue by a trace of cobalt, as of perfume and apothecary bottles.",
        f"{RUBIN} Absorption: bands of cobalt(II) at 535, 590 and 645 nm, about 170 l/mol/cm in the middle one, for "
        f"0.06 % of CoO {BAMFORD}.",
        0.004,
        *COBALT,
    ),
    _glass(
        "bottle_flint",
        "Flint Bottle Glass",
        "clear bottle, jar, jam, vodka, container, white glass",
        "Colourless container glass (glassmakers call it flint), faintly green where it is thick.",
        f"{RUBIN} Absorption: {VOGT.format(0.04)}.",
        0.004,
        _iron(0.04),
    ),
)
