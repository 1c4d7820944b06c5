"""Syrups, oils, alcohols and other liquids of the household."""

from ..absorption import Band, Caramel
from ..indices import Abbe, Drink, Index, Page, Sellmeier
from ..recipe import FLOATING, LIQUID, Recipe

GROUP = "Liquids"

REGULATION = "(Regulation (EU) 231/2012)"

# Pheophytin a: its bands relative to that at 670 nm (Lichtenthaler, 1987, Methods in Enzymology 148).
PHEOPHYTIN = (
    (411.0, 2.1, 2700.0),
    (505.0, 0.23, 900.0),
    (535.0, 0.19, 900.0),
    (610.0, 0.15, 700.0),
    (670.0, 1.0, 500.0),
)
# Lutein, relative to its absorbance at 470 nm.
LUTEIN = ((424.0, 0.87, 1500.0), (448.0, 1.21, 1300.0), (477.0, 1.04, 1000.0))


def _liquid(
    key: str, name: str, tags: str, description: str, source: str, depth: float, index: Index, *absorption, **keywords
) -> Recipe:
    keywords.setdefault("priority", LIQUID)
    return Recipe(key, name, GROUP, tags, description, source, index, depth=depth, absorption=absorption, **keywords)


def _pigments(bands: tuple[tuple[float, float, float], ...], absorbance: float) -> tuple[Band, ...]:
    return tuple(Band(nm, strength * absorbance, width) for nm, strength, width in bands)


MEDIA = (
    _liquid(
        "honey",
        "Honey",
        "syrup, sweet, bee, jar, golden, amber, food",
        "Clear, golden honey, as in a jar or on a spoon.",
        "Index: 1.4915 at 20 C for 18 % of water (International Honey Commission, 2009), with water's dispersion. "
        "Absorption: 0.315 at 560 nm in 1 cm, the middle of Light Amber (USDA, 1985, Standards for grades of "
        "extracted honey: optical densities of 0.595 to 1.389 in 3.15 cm of caramel in glycerol); a hue index of 6 "
        "(Linner, 1970).",
        0.03,
        Abbe(1.4915, 55.7),
        Caramel(560.0, 0.315, 6.0),
    ),
    _liquid(
        "maple_syrup",
        "Maple Syrup",
        "syrup, pancake, sweet, caramel, golden syrup, amber, food",
        "Amber maple syrup, as over pancakes.",
        "Index: sucrose of 66.9 % at 20 C (ICUMSA), with water's dispersion. Absorption: 62 % of the light of 560 nm "
        "is left after 1 cm, the middle of Amber (USDA, 2015: 50 to 75 %); falls as caramel with a hue index of 6 "
        "does (Linner, 1970).",
        0.03,
        Drink(66.9),
        Caramel(560.0, 0.2076, 6.0),
    ),
    _liquid(
        "grenadine",
        "Grenadine",
        "syrup, cocktail, bar, raspberry, strawberry, red, sweet",
        "Red syrup of bars, as in cocktails.",
        "Index: sucrose of 60 % at 20 C (ICUMSA), with water's dispersion. Absorption: 50 mg/l of the dye Allura Red "
        f"(E129), of which 1 % absorbs 540 in 1 cm at 504 nm {REGULATION}; the width of its band is that of azo dyes.",
        0.03,
        Drink(60.0),
        Band(504.0, 2.7, 4600.0, 2900.0),
    ),
    _liquid(
        "blue_curacao",
        "Blue Curaçao",
        "liqueur, cocktail, bar, blue, mouthwash, sports drink, lagoon",
        "Blue liqueur, as in cocktails.",
        "Index: water with 28 % of sugar and 20 % of alcohol at 20 C (ICUMSA; CRC Handbook), with water's "
        "dispersion. Absorption: 10 mg/l of the dye Brilliant Blue (E133), of which 1 % absorbs 1630 in 1 cm at 630 "
        f"nm {REGULATION}.",
        0.03,
        Drink(28.0, 20.0),
        Band(630.0, 1.63, 1300.0),
        Band(590.0, 0.35, 1900.0),
    ),
    _liquid(
        "olive_oil",
        "Olive Oil",
        "oil, cooking, salad, green, vinaigrette, food",
        "Virgin olive oil, golden with a touch of green. It wins over water, on which it floats.",
        "Index: 1.4690 at 20 C (Codex Alimentarius 33-1981: 1.4677 to 1.4705); no published Abbe number: 55. "
        "Absorption: 8 mg/kg of pheophytin and 3 mg/kg of carotenoids, as in a mild oil, by the extinctions of "
        "Minguez-Mosquera et al. (1991), Journal of the American Oil Chemists' Society 68: 1 % absorbs 613 at 670 nm "
        "and 2000 at 470 nm in 1 cm.",
        0.05,
        Abbe(1.4690, 55.0),
        *_pigments(PHEOPHYTIN, 0.45),
        *_pigments(LUTEIN, 0.55),
        # An oil in a glass of water is seen to end where it ends.
        priority=FLOATING,
    ),
    _liquid(
        "sunflower_oil",
        "Sunflower Oil",
        "oil, cooking, frying, vegetable, rapeseed, pale yellow, food",
        "Refined cooking oil, pale yellow. It wins over water, on which it floats.",
        "Index: 1.4735 at 20 C (Codex Alimentarius 210-1999: 1.461 to 1.468 at 40 C, 0.00036 less per degree); no "
        "published Abbe number: 55. Absorption: 0.3 mg/kg of carotenoids, which refining leaves, by the extinction "
        "of 2000 for 1 % at 470 nm in 1 cm. No published spectrum of a bottle.",
        0.05,
        Abbe(1.4735, 55.0),
        *_pigments(LUTEIN, 0.055),
        priority=FLOATING,
    ),
    _liquid(
        "dish_soap",
        "Dish Soap",
        "washing up liquid, detergent, kitchen, green, shampoo, shower gel, soap",
        "Green washing-up liquid or shampoo.",
        "No published index or spectrum: index of water with 30 % of dissolved matter (ICUMSA); colour of 1 mg/l of "
        "the dye Brilliant Blue (E133) and 4 mg/l of Tartrazine (E102), of which 1 % absorbs 1630 and 530 in 1 cm at "
        f"630 and 426 nm {REGULATION}.",
        0.05,
        Drink(30.0),
        Band(630.0, 0.163, 1300.0),
        Band(590.0, 0.035, 1900.0),
        Band(426.0, 0.212, 5300.0),
    ),
    _liquid(
        "perfume",
        "Perfume",
        "eau de toilette, cologne, fragrance, bottle, flacon, cosmetic",
        "Eau de parfum: alcohol with scented oils, faintly yellow.",
        "Index: 73 % of ethanol in water (80 % by volume) at 20 C (CRC Handbook), with water's dispersion. No "
        "published spectrum: colour matched to the dye Tartrazine (E102), 1 mg/l, of which 1 % absorbs 530 in 1 cm "
        f"at 426 nm {REGULATION}.",
        0.03,
        Drink(0.0, 73.0),
        Band(426.0, 0.053, 5300.0),
    ),
    _liquid(
        "vinegar",
        "Balsamic Vinegar",
        "vinegar, soy sauce, dressing, salad, brown, black, food",
        "Dark vinegar or soy sauce: black but in a thin layer.",
        "Index: water with 30 % of dissolved matter (ICUMSA), with water's dispersion. No published spectrum: that "
        "of caramel with a hue index of 5 (Linner, 1970), five times as strong as in cola.",
        0.01,
        Drink(30.0),
        Caramel(610.0, 1.3, 5.0),
    ),
    _liquid(
        "ethanol",
        "Ethanol",
        "alcohol, spirit, liquid, thermometer, lamp",
        "Pure alcohol, as in thermometers and spirit lamps.",
        "Kedenburg, Vieweg, Gissibl and Giessen (2012), Linear refractive index and absorption measurements of "
        "nonlinear optical liquids in the visible and near-infrared spectral region, Optical Materials Express "
        "2(11), 500 to 1600 nm at 20 C. The second of its two Sellmeier terms has a negative C; two terms without "
        "are fitted to them: within 4e-7 from 380 to 780 nm.",
        0.0,
        Sellmeier((0.831868305, 0.922902242, 0.0), (0.0093022, 300.0, 0.0)),
    ),
    _liquid(
        "methanol",
        "Methanol",
        "alcohol, wood spirit, fuel, liquid",
        "Methyl alcohol, as in burners and model fuel.",
        "Moutzouris et al. (2013), Refractive, dispersive and thermo-optic properties of twelve organic solvents in "
        "the visible and near-infrared, Applied Physics B 116, 450 to 1551 nm at 27 C; three Sellmeier terms fitted "
        "from 450 to 780 nm.",
        0.0,
        Page("organic/methanol/Moutzouris", start=450.0),
    ),
    _liquid(
        "isopropanol",
        "Isopropyl Alcohol",
        "isopropanol, rubbing alcohol, cleaner, disinfectant, sanitizer, liquid",
        "Isopropyl alcohol, as in cleaners and disinfectants.",
        "Sani and Dell'Oro (2016), Spectral optical constants of ethanol and isopropanol from ultraviolet to far "
        "infrared, Optical Materials 60, Sellmeier form from 185 to 2800 nm at room temperature.",
        0.0,
        Sellmeier((0.0107, 0.8702, 0.0), (8.88, 0.01036, 0.0)),
    ),
    _liquid(
        "acetone",
        "Acetone",
        "nail polish remover, solvent, thinner, liquid",
        "Acetone, as in nail polish remover.",
        "Rheims, Koeser and Wriedt (1997), Refractive-index measurements in the near-IR using an Abbe refractometer, "
        "Measurement Science and Technology 8, 477 to 830 nm; three Sellmeier terms fitted from 477 to 780 nm.",
        0.0,
        Page("organic/acetone/Rheims", start=477.0),
    ),
    _liquid(
        "glycerol",
        "Glycerol",
        "glycerin, glycerine, syrup, gel, slime, thick liquid",
        "Glycerol (glycerin): thick, clear and of the index of some plastics.",
        "Index: 1.4746 at 20 C (CRC Handbook of Chemistry and Physics). Abbe number: 64.4 by Gupta et al. (2022), "
        "measured from 400 to 710 nm, as in the refractiveindex.info database.",
        0.0,
        Abbe(1.4746, 64.4),
    ),
)
