"""How Hypothesis looks for counterexamples here: the same ones in every run, and nothing is written into the repository."""

import tempfile
from pathlib import Path

from hypothesis import HealthCheck, configuration, settings, strategies

configuration.set_hypothesis_home_dir(Path(tempfile.gettempdir(), "nested_dielectric_hypothesis"))
settings.register_profile(
    "suite",
    derandomize=True,
    deadline=None,
    database=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
settings.load_profile("suite")

FEW = 20
"""Examples where one takes long."""

FLOATS = strategies.floats()
"""All of them, NaN and the infinite ones too."""

NUMBERS = strategies.one_of(
    FLOATS, strategies.integers(), strategies.sampled_from([10**400, -(10**400), 2**31, -(2**31) - 1, 1e308])
)

VALUES = strategies.one_of(
    NUMBERS,
    strategies.none(),
    strategies.booleans(),
    strategies.text(),
    strategies.binary(),
    strategies.complex_numbers(),
    strategies.lists(NUMBERS, max_size=5),
    strategies.tuples(NUMBERS, NUMBERS, NUMBERS),
    strategies.dictionaries(strategies.text(), NUMBERS, max_size=3),
)
"""What scripts may give for anything."""
