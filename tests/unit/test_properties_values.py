"""What parameters make of any value at all."""

import math

import property_tests as any_
from hypothesis import given
from hypothesis import strategies as st

from nested_dielectric.model.parameter import ParameterError
from nested_dielectric.model.parameters import BY_KEYWORD, PARAMETERS, check_keywords

parameters = st.sampled_from(PARAMETERS)
limited = st.sampled_from([each for each in PARAMETERS if each.limits is not None])


def components(value) -> tuple:
    return value if isinstance(value, tuple) else (value,)


@given(parameters, any_.VALUES)
def test_a_parameter_takes_a_value_within_its_limits_or_names_what_is_wrong(parameter, value):
    try:
        taken = parameter.check(value)
    except ParameterError as error:
        assert parameter.keyword in str(error)
        return
    if parameter.minimum is not None:
        assert all(parameter.minimum <= each <= parameter.maximum for each in components(taken))
    if parameter.choices:
        assert taken in parameter.choices


@given(st.dictionaries(st.one_of(st.sampled_from(sorted(BY_KEYWORD)), st.text()), any_.VALUES, max_size=3))
def test_keywords_are_taken_all_or_one_is_named(keywords):
    try:
        assert [each.keyword for each in check_keywords(keywords)] == list(keywords)
    except ParameterError as error:
        assert any(keyword in str(error) or repr(keyword) in str(error) for keyword in keywords)


@given(limited, any_.NUMBERS, st.tuples(any_.FLOATS, any_.FLOATS, any_.FLOATS, any_.FLOATS))
def test_whatever_a_socket_holds_counts_as_something_within_the_limits(parameter, number, four):
    low, high, _ = parameter.limits
    counted = parameter.bounded(four if parameter.kind in ("COLOR", "VECTOR") else number)
    for each in components(counted)[:3]:
        assert low <= each <= high and math.isfinite(each)
    again = parameter.bounded(counted)
    assert components(again)[:3] == components(counted)[:3]


@given(limited, st.tuples(any_.FLOATS, any_.FLOATS, any_.FLOATS))
def test_a_value_that_is_taken_counts_as_it_is(parameter, value):
    if parameter.kind == "INDEX":
        return
    value = value if parameter.kind in ("COLOR", "VECTOR") else value[0]
    try:
        taken = parameter.check(value)
    except ParameterError:
        return
    assert parameter.bounded(taken) == taken
