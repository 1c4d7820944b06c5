"""What Python and the shader both know is written once."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nested_dielectric.model import contract, osl_contract, shader_source
from nested_dielectric.model.parameters import SOCKETS

SHADERS = sorted(path.name for path in shader_source.OSL_FOLDER.glob("*.osl"))
FILES = sorted(path for path in shader_source.OSL_FOLDER.iterdir() if path.suffix in (".h", ".osl"))
CODE = {path.name: shader_source.without_comments(path.read_text(encoding="utf-8")) for path in FILES}
MACROS = {re.sub(r"\(.*", "", name): value for name, value in osl_contract.macros()}
TYPES = {
    "INT": "int",
    "BOOL": "int",
    "MENU": "int",
    "INDEX": "int",
    "FLOAT": "float",
    "COLOR": "color",
    "VECTOR": "vector",
    "SHADER": "closure color",
}


def inputs(name: str) -> list[tuple[str, str, str]]:
    """Return the types, names and defaults of a shader's inputs, in order."""
    signature = re.search(r"^shader \w+\((.*?)\)\s*\{", CODE[name], re.MULTILINE | re.DOTALL)[1]
    found = re.findall(r"(output )?((?:closure )?\w+) (\w+) = ((?:[^,()]|\([^()]*\))+)", signature)
    return [(kind, word, default.strip()) for output, kind, word, default in found if not output]


def test_every_parameter_is_an_input_of_the_shader_with_its_type_and_default():
    found = inputs("nested_dielectric.osl")[: len(SOCKETS)]
    assert [(kind, name) for kind, name, _ in found] == [(TYPES[each.kind], each.osl_name) for each in SOCKETS]
    expected = ["0" if each.kind == "SHADER" else f"{each.keyword.upper()}_DEFAULT" for each in SOCKETS]
    assert [default for *_, default in found] == expected


def test_what_the_contract_defines_is_defined_nowhere_else():
    for name, code in CODE.items():
        assert not MACROS.keys() & set(re.findall(r"^#define (\w+)", code, re.MULTILINE)), name


def test_no_name_that_python_knows_is_typed_in_the_shader():
    known = {value.strip('"') for value in MACROS.values() if value.startswith('"')} | {"Nested Dielectric"}
    for name, code in CODE.items():
        typed = set(re.findall(r'"((?:[^"\\]|\\.)*)"', code))
        assert not {text for text in typed if text in known or "nd_" in text or "object:" in text}, name


@pytest.mark.parametrize("name", CODE)
def test_no_value_of_the_contract_that_could_be_no_other_is_typed_in_the_shader(name):
    """Constants that say what they are by their digits alone; 0, 1, 8 and the like may mean anything."""
    telling = {"656.2725", "587.5618", "486.1327", "380.0", "780.0", "3.4e38", "65536", "2e-5", "0.99"}
    found = set(re.findall(r"(?<![\w.])\d[\w.]*(?:e[-+]?\d+)?", re.sub(r"#define SWEEPS .*", "", CODE[name])))
    assert not found & telling


@pytest.mark.parametrize("shader", SHADERS)
def test_headers_use_what_the_contract_defines(shader):
    """A word in capitals is a macro of the shader's own, of the contract or of OSL."""
    source = shader_source.without_comments(shader_source.inlined_source(shader))
    defined = set(re.findall(r"^#define (\w+)", source, re.MULTILINE)) | {"M_PI", "M_2PI"}
    code = re.sub(r"^#define .*$", "", re.sub(r'"(?:[^"\\]|\\.)*"', "", source), flags=re.MULTILINE)
    words = {word for word in re.findall(r"\b[A-Z][A-Z0-9_]{2,}\b", code) if word not in ("IOR", "BSDF")}
    assert words <= defined


def test_all_of_the_contract_is_read_by_a_shader():
    text = "\n".join(CODE.values())
    parameters = {f"{each.keyword.upper()}_{suffix}" for each in SOCKETS for suffix in ("LIMITS", "DEFAULT")}
    codes = {f"{prefix}_{code.name}" for prefix, codes in osl_contract.CODES.items() for code in codes}
    unread = {name for name in MACROS if not re.search(rf"\b{name}\b", text)}
    assert unread - parameters - codes <= {"SOCKET"}


FACTS = st.builds(
    contract.Facts,
    st.sampled_from(contract.Exterior),
    st.booleans(),
    st.booleans(),
    st.booleans(),
    st.integers(-1, int(contract.HIGHEST_PACKED_PRIORITY)).map(float),
)


@given(FACTS)
def test_packed_facts_come_back(facts):
    assert contract.unpack_facts(contract.pack_facts(facts)) == facts


@given(FACTS)
def test_single_precision_keeps_packed_facts(facts):
    import numpy as np

    packed = contract.pack_facts(facts)
    assert float(np.float32(packed)) == packed


def test_nothing_is_packed_as_nothing():
    assert contract.unpack_facts(0.0) == contract.Facts()
    assert contract.pack_facts(contract.Facts()) == 0.0


def test_a_priority_too_high_to_be_packed_is_left_out():
    high = contract.Facts(sole_priority=contract.HIGHEST_PACKED_PRIORITY * 2.0)
    assert contract.unpack_facts(contract.pack_facts(high)).sole_priority == contract.NO_SOLE_PRIORITY
