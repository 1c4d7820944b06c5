"""Bubbles and films."""

from ..indices import Abbe
from ..recipe import BUBBLE, LIQUID, Recipe
from .water import FRESH

GROUP = "Bubbles and Films"

AIR = Abbe(1.0, 0.0)

MEDIA = (
    Recipe(
        "air_bubble",
        "Air Bubble",
        GROUP,
        "bubble, air, foam, fizz",
        "A closed pocket of air: wins over every other preset, so it can be put inside glass, ice or water.",
        "The index of air (1.0003) is 1 here, as that of the air around the scene.",
        AIR,
        priority=BUBBLE,
    ),
    Recipe(
        "soap_bubble",
        "Soap Bubble",
        GROUP,
        "bubble, iridescent, rainbow, soap, foam",
        "A ball of air in a film of soapy water that shimmers; link a texture to Thin Film Thickness for swirls.",
        "Film: water with soap, n 1.33, whose thickness of 100 to 1000 nm gives the colours (Isenberg, 1992, The "
        "science of soap films and soap bubbles); 400 nm here. Inside is air.",
        AIR,
        # Where a bubble lies on water it is a pocket of air in it.
        priority=BUBBLE,
        others=(("thin_film_thickness", 400.0), ("thin_film_ior", 1.33)),
    ),
    Recipe(
        "soap_film",
        "Soap Film",
        GROUP,
        "film, iridescent, rainbow, soap, membrane",
        "A flat film of soapy water as in a wire frame, thinner than on a bubble and so of stronger colour; give it "
        "a thin box.",
        "Film: water with soap, n 1.33 (Isenberg, 1992, The science of soap films and soap bubbles); 250 nm here, of "
        "the first order. Between its two faces is air, so each face carries a film of its own.",
        AIR,
        priority=BUBBLE,
        others=(("thin_film_thickness", 250.0), ("thin_film_ior", 1.33)),
    ),
    Recipe(
        "oil_film",
        "Oil Film on Water",
        GROUP,
        "puddle, petrol, iridescent, rainbow, oil slick, street",
        "Water under a film of oil, as the rainbow on a puddle; link a texture to Thin Film Thickness for its bands.",
        "Water: Daimon and Masumura (2007), Applied Optics 46(18). Film: mineral oil of n 1.46 (1.46 to 1.48 by "
        "makers' sheets), thick enough for rainbow colours by the Bonn Agreement's (2009) Oil Appearance Code, 0.3 "
        "to 5 micrometres; 350 nm here.",
        FRESH,
        priority=LIQUID,
        others=(("thin_film_thickness", 350.0), ("thin_film_ior", 1.46)),
    ),
)
