"""Drinks."""

from ..absorption import Band, Beer, Caramel, Edge, Wine
from ..indices import Drink
from ..recipe import LIQUID, Recipe

GROUP = "Drinks"

SUMS = "Index: water with {} at 20 C (ICUMSA; CRC Handbook), with water's dispersion."
DELANGE = (
    "Absorption: the spectrum of an average beer (deLange, 2016, Color, in Bamforth (ed.), Brewing materials and "
    "processes) for {}."
)
OIV = (
    "Absorption: {} by the method of the OIV (MA-AS2-07B); between these, bands of the red and the blue forms of "
    "anthocyanins at 520 and 620 nm (Glories, 1984, Connaissance de la vigne et du vin 18) and the tannins' edge."
)


def _drink(
    key: str, name: str, tags: str, description: str, source: str, depth: float, index: Drink, *absorption
) -> Recipe:
    return Recipe(key, name, GROUP, tags, description, source, index, LIQUID, depth, absorption)


MEDIA = (
    _drink(
        "tea",
        "Tea",
        "black tea, cup, hot, breakfast, iced tea, brown",
        "Clear black tea without milk.",
        f"{SUMS.format('0.3 % of dissolved matter')} Absorption: falls as caramel does. No published absorbance of a "
        "cup: 0.9 in 1 cm at 460 nm, where Roberts and Smith (1961, The Analyst 86) measure the colour of tea.",
        0.06,
        Drink(0.3),
        Caramel(460.0, 0.9, 7.0),
    ),
    _drink(
        "coffee",
        "Coffee",
        "black coffee, espresso, cup, mug, hot, breakfast",
        "Filter coffee without milk: black in the cup, red brown at its edge.",
        f"{SUMS.format('1.25 % of dissolved matter')} Absorption: melanoidins (Bekedam et al., 2006, Journal of "
        "Agricultural and Food Chemistry 54), which fall as caramel does. No published absorbance of a cup: 3.4 at "
        "420 nm in 1 cm.",
        0.06,
        Drink(1.25),
        Caramel(420.0, 3.4, 6.0),
    ),
    _drink(
        "cola",
        "Cola",
        "coke, soda, soft drink, fizzy, caramel, brown",
        "Cola, still; add Air Bubbles for its fizz.",
        f"{SUMS.format('10.6 % of sugar')} Absorption: caramel of class IV (E150d), of which 0.1 % in water absorbs "
        "0.26 at 610 nm in 1 cm (makers' sheets; JECFA: 0.1 to 0.6), with a hue index of 5 (Linner, 1970).",
        0.06,
        Drink(10.6),
        Caramel(610.0, 0.26, 5.0),
    ),
    _drink(
        "beer_pale",
        "Pale Beer",
        "lager, pilsner, pils, blond, glass, pint, golden",
        "Golden lager, clear and still; add Air Bubbles for its fizz.",
        f"{SUMS.format('4 % of extract and 4 % of alcohol')} {DELANGE.format('3.5 SRM (7 EBC)')}",
        0.07,
        Drink(4.0, 4.0),
        Beer(3.5),
    ),
    _drink(
        "beer_amber",
        "Amber Beer",
        "ale, bitter, vienna, pale ale, glass, pint, copper",
        "Amber ale, clear and still; add Air Bubbles for its fizz.",
        f"{SUMS.format('4.5 % of extract and 4 % of alcohol')} {DELANGE.format('12 SRM (24 EBC)')}",
        0.07,
        Drink(4.5, 4.0),
        Beer(12.0),
    ),
    _drink(
        "beer_dark",
        "Dark Beer",
        "stout, porter, dunkel, glass, pint, brown, black",
        "Dark beer: black in the glass, ruby against the light.",
        f"{SUMS.format('5 % of extract and 4 % of alcohol')} {DELANGE.format('30 SRM (59 EBC)')}",
        0.07,
        Drink(5.0, 4.0),
        Beer(30.0),
    ),
    _drink(
        "wine_white",
        "White Wine",
        "riesling, chardonnay, champagne, prosecco, sparkling wine, glass, yellow",
        "Dry white wine, pale straw yellow.",
        f"{SUMS.format('2 % of extract and 9.6 % of alcohol (12 % by volume)')} Absorption: 0.08 at 420 nm in 1 cm, "
        "within the 0.04 to 0.15 of young white wines, and falls as dissolved phenols do.",
        0.06,
        Drink(2.0, 9.6),
        Edge(420.0, 0.08, 0.018),
    ),
    _drink(
        "wine_rose",
        "Rosé Wine",
        "rose, pink, provence, blush, sparkling, glass",
        "Pale rosé wine, as from Provence.",
        f"{SUMS.format('2 % of extract and 10 % of alcohol (12.5 % by volume)')} "
        f"{OIV.format('0.15, 0.17 and 0.03 at 420, 520 and 620 nm in 1 cm, a pale rosé,')}",
        0.06,
        Drink(2.0, 10.0),
        Wine(0.15, 0.17, 0.03),
    ),
    _drink(
        "wine_red",
        "Red Wine",
        "pinot noir, bordeaux, burgundy, merlot, glass, claret",
        "Red wine of a light grape such as Pinot Noir, red through a whole glass.",
        f"{SUMS.format('2.5 % of extract and 10 % of alcohol (12.5 % by volume)')} "
        f"{OIV.format('0.8, 1.0 and 0.12 at 420, 520 and 620 nm in 1 cm, a light red wine (intensity 2 of 2 to 20),')}",
        0.07,
        Drink(2.5, 10.0),
        Wine(0.8, 1.0, 0.12),
    ),
    _drink(
        "wine_port",
        "Port Wine",
        "dessert wine, sherry, fortified, cabernet, dark red wine, glass",
        "Sweet, dark wine such as ruby port: nearly black in a full glass.",
        f"{SUMS.format('11 % of extract, most of it sugar, and 15 % of alcohol (20 % by volume)')} "
        f"{OIV.format('1.6, 2.0 and 0.3 at 420, 520 and 620 nm in 1 cm, a deep red wine,')}",
        0.05,
        Drink(11.0, 15.0),
        Wine(1.6, 2.0, 0.3),
    ),
    _drink(
        "whisky",
        "Whisky",
        "whiskey, scotch, bourbon, brandy, cognac, rum, tumbler, on the rocks, amber",
        "Whisky, brandy or dark rum: spirit coloured by its cask.",
        f"{SUMS.format('33.3 % of alcohol (40 % by volume)')} Absorption: 0.1 at 525 nm in 1 cm, of the 0.03 to 0.37 "
        "of the AOAC's (1982, Journal of the AOAC 65(2)) whiskeys; falls as spirit caramel with a hue index of 6 "
        "does (Linner, 1970).",
        0.05,
        Drink(0.0, 33.3),
        Caramel(525.0, 0.1, 6.0),
    ),
    _drink(
        "vodka",
        "Vodka",
        "gin, white rum, clear spirit, schnapps, tequila, shot, cocktail",
        "A clear spirit of 40 % alcohol.",
        SUMS.format("33.3 % of alcohol (40 % by volume)") + " Colourless.",
        0.0,
        Drink(0.0, 33.3),
    ),
    _drink(
        "apple_juice",
        "Apple Juice",
        "juice, cider, clear, breakfast, yellow, glass",
        "Clear apple juice or cider.",
        f"{SUMS.format('11.2 % of sugar')} Absorption: half of the light of 440 nm is left after 1 cm, as the trade "
        "asks of clear juice (about 40 to 60 %); falls as dissolved phenols do. No published spectrum.",
        0.06,
        Drink(11.2),
        Edge(440.0, 0.3, 0.018),
    ),
    _drink(
        "cranberry_juice",
        "Cranberry Juice",
        "juice, red, cherry, redcurrant, pomegranate, cocktail, glass",
        "Clear red juice of cranberries, redcurrants or sour cherries.",
        f"{SUMS.format('12 % of sugar')} Absorption: 35 mg/l of anthocyanins (no published amount; that of a light "
        "juice drink) of 449.2 g/mol and 26900 l/mol/cm (Lee, Durst and Wrolstad, 2005, Journal of AOAC "
        "International 88(5)), six tenths of them red at its acidity: a band at 515 nm, and a yellow edge a third as "
        "strong.",
        0.06,
        Drink(12.0),
        Band(515.0, 1.26, 4000.0, 2900.0),
        Edge(420.0, 0.4, 0.015),
    ),
)
