"""Gems and crystals.

Absorption of gems depends on the direction in the crystal; here is that of the ordinary ray, or a mean of all. Concentrations
vary from stone to stone: where no published one is named, the strength is that of a good stone 5 mm deep.
"""

from ..absorption import Band, Edge
from ..indices import Gem, Page, Sellmeier
from ..recipe import Recipe

GROUP = "Gems and Crystals"
SIZE = 0.005
"""Depth of a cut stone of about a carat, m."""

CORUNDUM = Sellmeier((1.4313493, 0.65054713, 5.3414021), (0.00527992610161, 0.0142382647056, 325.017834119))
QUARTZ = Sellmeier((0.28604141, 1.07044083, 1.10202242), (0.0, 0.0100585997, 100.0))

MALITSON = (
    "Malitson and Dodge (1972), Refractive index and birefringence of synthetic sapphire, Journal of the Optical "
    "Society of America 62, 1405, with the Sellmeier form printed by Dodge (1986), Handbook of Laser Science and "
    "Technology IV, at 20 C. Ordinary ray; birefringence (0.008) is left out."
)
GHOSH = (
    "Ghosh (1999), Dispersion-equation coefficients for the refractive index and birefringence of calcite and quartz "
    "crystals, Optics Communications 163, Sellmeier form. Ordinary ray; birefringence (0.009) is left out."
)
WEBSTER = "Index {} and fire {} (the index at the G line above that at the B line): Webster (1994), Gems."
STRENGTH = "No published concentration: its strength is that of a good stone 5 mm deep."


def _gem(key: str, name: str, tags: str, description: str, source: str, index, *absorption, **keywords) -> Recipe:
    depth = keywords.pop("depth", SIZE if absorption else 0.0)
    return Recipe(key, name, GROUP, tags, description, source, index, depth=depth, absorption=absorption, **keywords)


MEDIA = (
    _gem(
        "diamond",
        "Diamond",
        "gem, jewel, brilliant, fire, ring, sparkle",
        "Cut diamond, with its fire.",
        "Peter (1923), Über Brechungsindizes und Absorptionskonstanten des Diamanten zwischen 644 und 226 mµ, "
        "Zeitschrift für Physik 15, Sellmeier form of two terms, as in the refractiveindex.info database; used "
        "beyond 644 nm too.",
        Sellmeier((0.3306, 4.3356, 0.0), (0.030625, 0.011236, 0.0)),
        disperse=True,
    ),
    _gem(
        "moissanite",
        "Moissanite",
        "gem, jewel, silicon carbide, imitation diamond, fire, ring, sparkle",
        "Cut silicon carbide, with twice the fire of diamond.",
        "Wang et al. (2013), 4H-SiC: A new nonlinear material for midinfrared lasers, Laser and Photonics Reviews 7: "
        "6H-SiC, ordinary ray, 436 to 2325 nm; three Sellmeier terms fitted from 436 to 780 nm. Birefringence "
        "(0.043) is left out.",
        Page("main/SiC/Wang-6H-o", start=436.0),
        disperse=True,
    ),
    _gem(
        "cubic_zirconia",
        "Cubic Zirconia",
        "cz, gem, jewel, imitation diamond, zirconia, ring, sparkle",
        "Cut cubic zirconia, the imitation of diamond with still more fire.",
        "Wood and Nassau (1982), Refractive index of cubic zirconia stabilized with yttria, Applied Optics 21(16), "
        "Sellmeier form for 12.0 mol % of yttria at 25 C.",
        Sellmeier((1.347091, 2.117788, 9.452943), (0.003911626849, 0.027801894121, 591.490125125)),
        disperse=True,
    ),
    _gem(
        "ruby",
        "Ruby",
        "gem, jewel, red, corundum, ring, laser",
        "Ruby: corundum made red by chromium.",
        f"{MALITSON} Absorption: bands of chromium(III) at 404 and 554 nm, about 3200/cm wide, which absorb 3.0 and "
        "2.1/cm (natural, mean of both rays) for 0.05 % of Cr2O3 (Cronemeyer, 1966, Journal of the Optical Society "
        "of America 56; Koechner, Solid-State Laser Engineering); here 0.6 %, of the 0.1 to 1 % of gems.",
        CORUNDUM,
        # 36 and 25.2/cm natural are 15.6 and 10.9 decadic.
        Band(404.0, 15.6, 3600.0),
        Band(554.0, 10.9, 3200.0, 2400.0),
    ),
    _gem(
        "sapphire",
        "Sapphire",
        "corundum, watch glass, gem, white sapphire, clear, screen",
        "Colourless sapphire (corundum), as in watch glasses.",
        MALITSON,
        CORUNDUM,
    ),
    _gem(
        "blue_sapphire",
        "Blue Sapphire",
        "gem, jewel, blue, corundum, ring, kashmir, ceylon",
        "Blue sapphire: corundum coloured by iron and titanium.",
        f"{MALITSON} Absorption: iron(II) to titanium(IV) at 580 and 700 nm, iron(III) at 450 and 388 nm (Ferguson "
        "and Fielding, 1971, Chemical Physics Letters 10; Nassau, 1983, The physics and chemistry of color). "
        f"{STRENGTH}",
        CORUNDUM,
        Band(580.0, 2.0, 4200.0),
        Band(700.0, 0.7, 4200.0),
        Band(450.0, 0.25, 700.0),
        Band(388.0, 0.5, 1300.0),
    ),
    _gem(
        "emerald",
        "Emerald",
        "gem, jewel, green, beryl, ring, colombia",
        "Emerald: beryl made green by chromium.",
        f"{WEBSTER.format('1.578', '0.014')} Absorption: bands of chromium(III) in beryl at 430 and 600 nm, of like "
        f"strength and 3000 to 3700/cm wide (Wood and Nassau, 1968, American Mineralogist 53). {STRENGTH}",
        Gem(1.578, 0.014),
        Band(430.0, 1.5, 3700.0),
        Band(600.0, 1.5, 3300.0, 2800.0),
    ),
    _gem(
        "aquamarine",
        "Aquamarine",
        "gem, jewel, pale blue, beryl, ring, sea blue",
        "Aquamarine: beryl made pale blue by iron.",
        f"{WEBSTER.format('1.577', '0.014')} Absorption: iron(II) at 820 nm, iron(II) to iron(III) at 620 nm (Wood "
        f"and Nassau, 1968, American Mineralogist 53). {STRENGTH}",
        Gem(1.577, 0.014),
        Band(820.0, 0.55, 3600.0),
        Band(620.0, 0.18, 4500.0),
    ),
    _gem(
        "amethyst",
        "Amethyst",
        "gem, jewel, purple, violet, quartz, geode, crystal",
        "Amethyst: quartz made violet by iron(IV).",
        f"{GHOSH} Absorption: bands at 545, 345 and 950 nm (Rossman, 1994, Reviews in Mineralogy 29). {STRENGTH}",
        QUARTZ,
        Band(545.0, 1.3, 4700.0),
        Band(345.0, 2.6, 7000.0),
        Band(950.0, 0.35, 3000.0),
    ),
    _gem(
        "citrine",
        "Citrine",
        "gem, jewel, yellow, orange, quartz, crystal",
        "Citrine: quartz made yellow by iron(III).",
        f"{GHOSH} Absorption: an edge that rises smoothly to the ultraviolet (Rossman, 1994, Reviews in Mineralogy "
        f"29). {STRENGTH}",
        QUARTZ,
        Edge(400.0, 2.4, 0.013),
    ),
    _gem(
        "quartz",
        "Quartz",
        "rock crystal, mineral, crystal, crystal ball, clear",
        "Clear quartz (rock crystal).",
        GHOSH,
        QUARTZ,
    ),
    _gem(
        "topaz",
        "Topaz",
        "gem, jewel, golden, imperial topaz, yellow, orange, sherry",
        "Golden topaz, as the imperial topaz of Brazil.",
        f"{WEBSTER.format('1.630', '0.014')} Absorption: the colour centre's edge into the visible and weak "
        f"chromium(III) at 405 and 555 nm (Nassau, 1983, The physics and chemistry of color). {STRENGTH}",
        Gem(1.630, 0.014),
        Edge(400.0, 1.8, 0.011),
        Band(405.0, 0.3, 3500.0),
        Band(555.0, 0.2, 3000.0),
    ),
    _gem(
        "blue_topaz",
        "Blue Topaz",
        "gem, jewel, sky blue, swiss blue, ring",
        "Topaz turned blue by radiation.",
        f"{WEBSTER.format('1.619', '0.014')} Absorption: the colour centre's broad band at 620 nm (Nassau, 1983, The "
        f"physics and chemistry of color). {STRENGTH}",
        Gem(1.619, 0.014),
        Band(620.0, 0.6, 4600.0),
    ),
    _gem(
        "garnet",
        "Garnet",
        "gem, jewel, red, almandine, pyrope, dark red, ring",
        "Almandine garnet, deep red.",
        f"{WEBSTER.format('1.790', '0.024')} Absorption: iron(II) at 505, 527 and 576 nm, weaker at 461 and 617 nm, "
        "on an edge of iron and titanium that rises to the ultraviolet (Manning, 1967, Canadian Mineralogist 9). "
        f"{STRENGTH}",
        Gem(1.790, 0.024),
        Band(505.0, 3.0, 900.0),
        Band(527.0, 2.5, 900.0),
        Band(576.0, 3.2, 1000.0),
        Band(461.0, 0.4, 900.0),
        Band(617.0, 0.3, 600.0),
        Edge(400.0, 5.5, 0.009),
    ),
    _gem(
        "peridot",
        "Peridot",
        "gem, jewel, green, olivine, yellow green, chrysolite",
        "Peridot (olivine), yellow green by its own iron.",
        f"{WEBSTER.format('1.672', '0.020')} Absorption: iron(II) at 1050 and 850 nm, weak and narrow at 453, 473 and "
        "493 nm, and an edge into the blue (Burns, 1993, Mineralogical applications of crystal field theory). "
        f"{STRENGTH}",
        Gem(1.672, 0.020),
        Band(1050.0, 5.0, 4300.0),
        Band(850.0, 2.5, 5000.0),
        Band(453.0, 0.2, 350.0),
        Band(473.0, 0.2, 350.0),
        Band(493.0, 0.2, 350.0),
        Edge(400.0, 1.5, 0.012),
    ),
    _gem(
        "tanzanite",
        "Tanzanite",
        "gem, jewel, violet blue, zoisite, purple, ring",
        "Tanzanite: zoisite made violet blue by vanadium.",
        f"{WEBSTER.format('1.695', '0.021')} Absorption: vanadium(III) at 595, 528 and 455 nm (Webster, 1994, Gems); "
        f"widths as of other vanadium(III). {STRENGTH}",
        Gem(1.695, 0.021),
        Band(595.0, 1.5, 2300.0),
        Band(528.0, 0.7, 2200.0),
        Band(455.0, 0.25, 1500.0),
    ),
    _gem(
        "spinel",
        "Spinel",
        "gem, jewel, synthetic, clear, window, magnesium aluminate",
        "Colourless spinel, as synthetic gems and armoured windows.",
        "Tropf and Thomas (1991), Magnesium aluminum spinel, in Palik, Handbook of optical constants of solids II, "
        "Sellmeier form as improved in Handbook of Optics (2009), 3rd edition, 4.",
        Sellmeier((1.8938, 3.0755, 0.0), (0.0098843364, 250.462276, 0.0)),
    ),
    _gem(
        "fluorite",
        "Fluorite",
        "calcium fluoride, mineral, crystal, lens, telescope, clear",
        "Clear fluorite, as of minerals and of lenses with little dispersion.",
        "Malitson (1963), A redetermination of some optical properties of calcium fluoride, Applied Optics 2, "
        "Sellmeier form at 24 C.",
        Sellmeier((0.5675888, 0.4710914, 3.8484723), (0.002526429989, 0.010078332801, 1200.5559729)),
    ),
    _gem(
        "rock_salt",
        "Rock Salt",
        "halite, salt crystal, mineral, sodium chloride, grain, lamp",
        "Clear crystals of table salt.",
        "Li (1976), Refractive index of alkali halides and its wavelength and temperature derivatives, Journal of "
        "Physical and Chemical Reference Data 5, at 24 C; three Sellmeier terms fitted to its seven.",
        Page("main/NaCl/Li"),
    ),
)
