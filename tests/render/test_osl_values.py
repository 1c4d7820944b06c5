"""What the shader's functions return, in single precision, is what physics says in double, all over their inputs.

``benchmarks/osl_errors.py`` publishes the errors.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from osl_functions import FUNCTIONS, measured_names, pure_functions
from osl_measure import Draw, measured
from osl_values import NO_NUMBER, evaluate
from shading import evaluate as evaluate_places

SIGNIFICANCE = 1e-4
"""Chance that one of these tests fails without a fault; its inputs are the same in every run."""


def test_numbers_go_into_a_shader_and_come_back_to_the_last_bit():
    """Of either sign, from the smallest that single precision has; what is not finite comes back as a mark of its own."""
    d = Draw("identity")
    x = d.signed(1e-44, 1e38).astype(np.float32)
    w = np.stack([d.signed(1e-44, 1e38), d.linear(-1.0, 1.0), np.zeros(d.count)], axis=1).astype(np.float32)
    four = np.stack([x, -x, x, d.linear(-9.0, 9.0)], axis=1).astype(np.float32)
    odd = d.choice(math.nan, math.inf, -math.inf, 1.0)
    shown = evaluate(
        [],
        "r[0] = x; r[1] = w[0]; r[2] = w[1]; r[3] = w[2]; r[4] = I[0]; r[5] = N[1]; r[6] = P[2]; r[7] = odd;"
        'float q[4] = {0.0, 0.0, 0.0, 0.0}; getattribute("four", q); r[8] = q[0]; r[9] = q[3]; r[10] = isnan(odd);',
        {"x": x, "w": w, "I": w, "N": w, "P": np.roll(w, 1, axis=1), "four": four, "odd": odd},
        11,
    )
    for column, values in enumerate((x, w[:, 0], w[:, 1], w[:, 2], w[:, 0], w[:, 1], w[:, 1])):
        assert np.array_equal(shown[:, column], values.astype(np.float64))
    assert np.array_equal(shown[:, 7], np.where(np.isfinite(odd), odd, np.float32(NO_NUMBER)))
    assert np.array_equal(shown[:, 8:10], four[:, [0, 3]]) and np.array_equal(shown[:, 10] > 0.0, np.isnan(odd))


def test_every_function_that_hangs_on_its_inputs_alone_is_measured():
    """A new one needs its row in ``tests/helpers/osl_*.py``."""
    pure = pure_functions()
    assert not set(pure) - measured_names()
    assert {f"{function.header}" for function in FUNCTIONS} >= set(pure.values())


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda function: f"{function.name} {function.domain}".strip())
def test_a_function_returns_what_physics_says(function):
    errors = measured(function)
    assert errors.roundings <= function.bound, errors


@pytest.mark.parametrize("name", ["fresnel_dielectric", "light_sample", "bsdf_eval", "ior_at"])
def test_an_error_of_a_thousandth_would_show(name):
    """The power of the test above."""
    function = next(function for function in FUNCTIONS if function.name == name)
    wrong = replace(function, statements=function.statements + "r[0] = r[0] * 1.001;")
    assert measured(wrong).roundings > 2.0 * function.bound


def chance_of_bins(numbers: np.ndarray, bins: int = 64) -> float:
    """Chance of counts at least as uneven (Pearson 1900; Wilson and Hilferty 1931)."""
    counts, _ = np.histogram(numbers, bins=bins, range=(0.0, 1.0))
    expected = len(numbers) / bins
    statistic, freedom = ((counts - expected) ** 2 / expected).sum(), bins - 1
    scale = 2.0 / (9.0 * freedom)
    return 0.5 * math.erfc(((statistic / freedom) ** (1.0 / 3.0) - 1.0 + scale) / math.sqrt(2.0 * scale))


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_random_numbers_are_even_and_unrelated_in_scenes_of_any_size(size):
    """Of points at random, and of neighbours that differ in their last digits alone."""
    d = Draw(f"random {size}")
    near = size * np.array([0.5, -0.7, 0.9], dtype=np.float32)
    apart = d.vector(*[d.linear(-size, size) for _ in range(3)])
    steps = np.stack([np.arange(d.count) % 16, np.arange(d.count) // 16 % 16, np.arange(d.count) // 256], axis=1)
    beside = near + steps * np.spacing(np.abs(near))
    for points in (apart, beside):
        drawn = evaluate(
            ["random.h"],
            "for (int i = 0; i < 6; i++) r[i] = random(i + 1); r[6] = random_gaussian(2);",
            {"P": points},
            7,
        )
        uniform, normal = drawn[:, :6], 0.5 + 0.5 * np.vectorize(math.erf)(drawn[:, 6] / math.sqrt(2.0))
        assert uniform.min() >= 0.0 and uniform.max() < 1.0
        chances = [chance_of_bins(numbers) for numbers in (*uniform.T, normal)]
        assert min(chances) > SIGNIFICANCE / len(chances), chances
        related = np.corrcoef(uniform.T) - np.eye(6)
        assert np.abs(related).max() * math.sqrt(d.count) < 5.2  # 15 pairs, Gaussian


def test_one_surface_in_512_is_asked_all_the_same():
    """A picture of one face, of which a share of so many points is; within 4 standard errors."""
    side, share = 256, 1.0 / 512.0
    text = '#include "exterior.h"\nshader test(output color Result = color(0.0)) { Result = color(spot_check()); }'
    asked = evaluate_places(text, side, side)[..., 0]
    assert set(np.unique(asked)) == {0.0, 1.0}
    assert abs(asked.mean() - share) < 4.0 * math.sqrt(share / side**2)
