"""Nodes of JF's shader as scene files write them."""

from nested_dielectric.importers import jf_translation


def notes(translation: jf_translation.Translation, parameter: str) -> str:
    return "; ".join(text for name, text in translation.notes if name == parameter)
