"""Water and ice."""

from ..absorption import Measured, Phytoplankton, PureWater, YellowMatter
from ..indices import SeaWater, Sellmeier
from ..recipe import ICE, LIQUID, Recipe

GROUP = "Water and Ice"

FRESH = Sellmeier((0.597697292, 0.164183063, 0.112898603), (0.00540490195, 0.0204680679, 10.6838606))
FROZEN = Sellmeier((0.70100236, 0.11420435, 0.0), (0.00896696, 9.6, 0.0))

DAIMON = "Index: Daimon and Masumura (2007), Applied Optics 46(18), water at 20 C."
QUAN = (
    "Index: Quan and Fry (1995), Empirical equation for the index of refraction of seawater, Applied Optics 34(18), "
    "35 g/kg and 20 C, fitted from 400 to 700 nm."
)
POPE = (
    "Absorption of water: Pope and Fry (1997), Applied Optics 36(33), beyond 727.5 nm Smith and Baker (1981), "
    "Applied Optics 20(2)."
)
MOREL = (
    "Phytoplankton: Morel (1991), Progress in Oceanography 26, with the spectrum of Prieur and Sathyendranath "
    "(1981), Limnology and Oceanography 26(4)."
)
WARREN = (
    "Warren and Brandt (2008), Optical constants of ice from the ultraviolet to the microwave: A revised "
    "compilation, Journal of Geophysical Research 113, D14220, -7 C."
)


def _natural(key: str, name: str, description: str, tags: str, source: str, depth: float, **keywords) -> Recipe:
    """Water that is coloured by what lives and is dissolved in it."""
    return Recipe(key, name, GROUP, tags, description, source, priority=LIQUID, depth=depth, **keywords)


MEDIA = (
    Recipe(
        "water",
        "Water",
        GROUP,
        "liquid, drink, clear, tap, rain, glass of water",
        "Clear water at 20 C. Its own blue tint needs metres to show and is left out; Pool Water has it.",
        "Daimon and Masumura (2007), Measurement of the refractive index of distilled water from the near-infrared "
        "region to the ultraviolet region, Applied Optics 46(18), Sellmeier form of four terms at 20.0 C. Two of its "
        "three ultraviolet terms lie close together; the three terms here are fitted to all four: within 1e-8 from "
        "380 to 780 nm.",
        FRESH,
        priority=LIQUID,
    ),
    _natural(
        "pool_water",
        "Pool Water",
        "Pure water with its own blue, as in a swimming pool 2 m deep.",
        "swimming pool, blue, aquarium, tank, fountain",
        f"{DAIMON} {POPE}",
        2.0,
        index=FRESH,
        absorption=(PureWater(),),
    ),
    _natural(
        "tropical_sea",
        "Tropical Sea Water",
        "The blue water of warm, clear seas, in which little lives.",
        "ocean, lagoon, caribbean, blue, salt water, reef",
        f"{QUAN} {POPE} {MOREL} Chlorophyll 0.05 mg/m3, with the dissolved matter that Morel gives it.",
        5.0,
        index=SeaWater(35.0, 20.0),
        absorption=(PureWater(), Phytoplankton(0.05), YellowMatter(0.003)),
    ),
    _natural(
        "sea_water",
        "Sea Water",
        "The blue-green water of temperate seas near the coast.",
        "ocean, coast, waves, salt water, atlantic",
        f"{QUAN} {POPE} {MOREL} Chlorophyll 1 mg/m3; dissolved matter absorbs 0.05/m at 440 nm and falls by 0.014/nm "
        "(Bricaud, Morel and Prieur, 1981, Limnology and Oceanography 26(1)).",
        5.0,
        index=SeaWater(35.0, 20.0),
        absorption=(PureWater(), Phytoplankton(1.0), YellowMatter(0.05)),
    ),
    _natural(
        "lake_water",
        "Lake Water",
        "The green water of a lake in summer.",
        "lake, river, green, fresh water, reservoir",
        f"{DAIMON} {POPE} {MOREL} Chlorophyll 5 mg/m3, as in lakes of middling nutrients (OECD, 1982: 2.5 to 8); "
        "dissolved matter absorbs 0.5/m at 440 nm and falls by 0.014/nm (Bricaud, Morel and Prieur, 1981, Limnology "
        "and Oceanography 26(1)).",
        2.0,
        index=FRESH,
        absorption=(PureWater(), Phytoplankton(5.0), YellowMatter(0.5)),
    ),
    _natural(
        "pond_water",
        "Pond Water",
        "The brown water of ponds and moors, stained by peat and leaves.",
        "pond, moor, swamp, bog, brown, forest, river",
        f"{DAIMON} {POPE} {MOREL} Chlorophyll 10 mg/m3; dissolved matter absorbs 5/m at 440 nm, within the 0.1 to "
        "20/m of lakes (Kirk, 1994, Light and photosynthesis in aquatic ecosystems), and falls by 0.014/nm.",
        1.0,
        index=FRESH,
        absorption=(PureWater(), Phytoplankton(10.0), YellowMatter(5.0)),
    ),
    Recipe(
        "ice",
        "Ice",
        GROUP,
        "cube, frozen, clear, ice cube, cold",
        "Clear ice Ih. It wins over water, so a cube that floats is whole below the surface.",
        f"{WARREN} The table holds four decimals; two Sellmeier terms fitted from 390 to 780 nm stay within their "
        "rounding (5e-5).",
        FROZEN,
        priority=ICE,
    ),
    Recipe(
        "cloudy_ice",
        "Cloudy Ice",
        GROUP,
        "cube, frozen, frosted, white, ice cube, icicle",
        "Ice with a frosted surface. Fine bubbles inside would scatter, which this material does not: add Air "
        "Bubbles or a volume.",
        f"Index: {WARREN} No published roughness: 0.4 was chosen by eye.",
        FROZEN,
        priority=ICE,
        others=(("roughness", 0.4),),
    ),
    Recipe(
        "glacier_ice",
        "Glacier Ice",
        GROUP,
        "iceberg, blue, frozen, arctic, crevasse, cave",
        "Thick ice without bubbles, blue by its own absorption, as in crevasses and icebergs.",
        f"{WARREN} Index fitted as for Ice; absorption from its k.",
        FROZEN,
        priority=ICE,
        depth=5.0,
        absorption=(Measured("main/H2O/Warren-2008"),),
    ),
)
