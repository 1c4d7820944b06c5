"""Plastics and resins."""

from ..absorption import Caramel
from ..indices import Abbe, Page, Sellmeier
from ..recipe import Recipe

GROUP = "Plastics and Resins"


def _plastic(key: str, name: str, tags: str, description: str, source: str, index, **keywords) -> Recipe:
    return Recipe(key, name, GROUP, tags, description, source, index, **keywords)


MEDIA = (
    _plastic(
        "pmma",
        "Acrylic Glass",
        "acrylic, plexiglass, perspex, aquarium, display, award, pmma",
        "Acrylic glass (PMMA, plexiglass), as in displays, light guides and aquariums.",
        "Szczurowski (2013), measurement at 23 C from 405 to 1083 nm with its Sellmeier form, published in the "
        "refractiveindex.info database. It agrees with the table of Sultanova, Kasarova and Nikolov (2009), "
        "Dispersion properties of optical polymers, Acta Physica Polonica A 116(4), within that table's accuracy "
        "(0.001).",
        Sellmeier((0.99654, 0.18964, 0.00411), (0.00787, 0.02191, 3.85727)),
    ),
    _plastic(
        "polycarbonate",
        "Polycarbonate",
        "visor, lens, safety glazing, helmet, compact disc, phone case",
        "Polycarbonate, as in spectacle lenses, visors and safety glazing.",
        "Sultanova, Kasarova and Nikolov (2009), Dispersion properties of optical polymers, Acta Physica Polonica A "
        "116(4), 437 to 1052 nm at 20 C, accurate to 0.001; one Sellmeier term fitted to it in the "
        "refractiveindex.info database. Its V_d is 27.9, the paper's 29.1.",
        Sellmeier((1.4182, 0.0, 0.0), (0.021304, 0.0, 0.0)),
    ),
    _plastic(
        "pet",
        "PET Plastic",
        "bottle, water bottle, polyester, film, packaging, blister",
        "PET (polyester), as in drink bottles, films and packaging.",
        "Zhang, Qiu, Li, Zhao and Liu (2020), Complex refractive indices measurements of polymers in visible and "
        "near-infrared bands, Applied Optics 59, from 400 nm on; three Sellmeier terms fitted from 400 to 780 nm. "
        "Colourless: its k is too small to measure.",
        Page("organic/polyethylene_terephthalate/Zhang", start=400.0),
    ),
    _plastic(
        "polystyrene",
        "Polystyrene",
        "disposable cup, jewel case, ruler, packaging, clear plastic, cutlery",
        "Clear polystyrene, as in disposable cups and jewel cases.",
        "Sultanova, Kasarova and Nikolov (2009), Dispersion properties of optical polymers, Acta Physica Polonica A "
        "116(4), 437 to 1052 nm at 20 C; one Sellmeier term fitted to it in the refractiveindex.info database.",
        Sellmeier((1.4435, 0.0, 0.0), (0.020216, 0.0, 0.0)),
    ),
    _plastic(
        "cr39",
        "CR-39",
        "spectacles, glasses, eyeglasses, lens, optician, sunglasses",
        "CR-39 (allyl diglycol carbonate), the plastic of spectacle lenses.",
        "PPG Industries (2006), CR-39 monomer, product information: n_D 1.498 and Abbe number 58 at 20 C when cured.",
        Abbe(1.498, 58.0),
    ),
    _plastic(
        "epoxy",
        "Epoxy Resin",
        "resin, river table, casting, jewellery, glue, coating, glossy",
        "Clear cast epoxy, as of river tables and jewellery.",
        "Index: 1.532 at 589 nm (Epoxy Technology, data sheet EPO-TEK 301-2, 2014). No published Abbe number: 40, "
        "between acrylic glass and polycarbonate. Colourless; yellowing by age has no published number.",
        Abbe(1.532, 40.0),
    ),
    _plastic(
        "uv_resin",
        "UV Resin",
        "resin, uv glue, nail gel, 3d print, adhesive, casting, jewellery",
        "Resin hardened by light, as of nails, jewellery and clear 3D prints.",
        "Norland (2016), data sheet of Optical Adhesive 61, cured, Cauchy form from 450 nm on; three Sellmeier terms "
        "fitted from 450 to 780 nm.",
        Page("other/Norland_NOA-61/Norland", start=450.0),
    ),
    _plastic(
        "silicone",
        "Silicone",
        "rubber, pdms, gel, contact lens, baking mould, sealant, soft",
        "Clear silicone rubber, as of seals, moulds and soft lenses.",
        "Gupta et al. (2019), Mechanotunable surface lattice resonances in the visible optical range by soft "
        "lithography templates and directed self-assembly, ACS Applied Materials and Interfaces 11: Sylgard 184, "
        "measured from 300 to 1690 nm; three Sellmeier terms fitted from 380 to 780 nm.",
        Page("organic/polydimethylsiloxane/Gupta"),
    ),
    _plastic(
        "amber",
        "Amber",
        "fossil resin, baltic, insect, jewel, bead, rosin, copal, honey colour",
        "Baltic amber, a fossil resin the colour of honey.",
        "Index: 1.540 (Webster, 1994, Gems); no published Abbe number: 40, as epoxy. No published spectrum in "
        "numbers: it falls from the ultraviolet as caramel with a hue index of 7 does (Linner, 1970), with the "
        "strength of Amber honey (USDA, 1985: an optical density of 3 at 560 nm in 3.15 cm).",
        Abbe(1.540, 40.0),
        depth=0.015,
        absorption=(Caramel(560.0, 0.6, 7.0),),
    ),
)
