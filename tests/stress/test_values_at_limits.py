"""Media with a parameter at either of its limits make no light, nor anything that is no light."""

import bpy  # before numpy's users
import pytest
from random_bodies import stage
from scenes import add_box, add_sphere, rarely
from ways import FIT, NATIVE, PREPARE, ROUNDING, SAMPLES, asked, can_be_native, take

import nested_dielectric as nd
from nested_dielectric.model.parameters import BY_KEYWORD

LIMITED = [keyword for keyword, parameter in BY_KEYWORD.items() if parameter.minimum is not None]


def values_for(keyword: str, value: float) -> dict:
    """The parameter at a value, with what it needs to show."""
    parameter = BY_KEYWORD[keyword]
    values = {}
    for need in parameter.needs:
        other = BY_KEYWORD[need]
        if other.kind == "BOOL":
            values[need] = True
        elif other.kind == "FLOAT" and other.default == 0.0:
            values[need] = 0.3
    values[keyword] = (value,) * 3 if parameter.kind in ("COLOR", "VECTOR") else value
    return values


def crossing(keyword: str, value: float) -> None:
    stage(16)
    add_sphere("Ball", 1.0, nd.new_material("Limited", **{"ior": 1.5} | values_for(keyword, value)), 1, segments=32)
    add_box("Block", (-0.9, -0.9, -0.8), (1.1, 0.9, 0.1), nd.new_material("Plain", ior=1.33), 2)
    bpy.context.view_layer.update()


@pytest.mark.parametrize("keyword", rarely(LIMITED, ("ior",)))
def test_media_with_a_parameter_at_a_limit_make_no_light(keyword, record):
    """Two of rough lobes may exceed 1 by their fit, single wavelengths by their weights."""
    parameter = BY_KEYWORD[keyword]
    for end, value in (("least", parameter.minimum), ("most", parameter.maximum)):
        crossing(keyword, value)
        pictures = {"asked": (asked(), take(1, SAMPLES))[1]}
        result = PREPARE[NATIVE]()
        if can_be_native(result):
            pictures[NATIVE] = take(2, SAMPLES)
        record("value", f"{keyword} {end}", ways={way: picture.numbers() for way, picture in pictures.items()})
        for way, picture in pictures.items():
            assert picture.broken == 0, (way, value)
            assert picture.mean <= FIT + ROUNDING + 5.0 * picture.error, (way, value)
