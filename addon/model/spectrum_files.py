"""CSV files of power over wavelength."""

from __future__ import annotations

from itertools import pairwise
from math import isfinite
from pathlib import Path

from .colour_science import SpectrumError
from .spectra import WAVELENGTHS, Spectrum, cells

MAX_CSV = 10_000_000
"""Most characters of a file of power, of which a spectrum has some thousand lines: a device has no end."""


def read_spectrum(path: Path, remedy: str) -> Spectrum:
    """Read the spectrum in a CSV file of two columns, wavelength (nm) and power per nm.

    :param remedy: what users may give instead, for the text of errors.
    :raises SpectrumError: for a file that cannot be read as such, or has no power over visible light.
    """
    rows = sorted(_rows(path, _text(path, remedy)))
    if len(rows) < 2:
        raise SpectrumError(f"{path}: at least two rows of wavelength (nm) and power are needed")
    for (before, _, _), (wavelength, _, number) in pairwise(rows):
        if wavelength == before:
            raise SpectrumError(
                f"{path}, line {number}: wavelength {wavelength:g} nm stands there twice; keep one of the rows"
            )
    light = Spectrum(path.name, tuple(row[0] for row in rows), tuple(row[1] for row in rows))
    if not cells(light)[2].any():
        raise SpectrumError(
            f"{path}: no power between {WAVELENGTHS[0]:g} and {WAVELENGTHS[1]:g} nm; the first column is the "
            "wavelength in nm"
        )
    return light


def _text(path: Path, remedy: str) -> str:
    try:
        with path.open(encoding="utf-8-sig") as file:
            text = file.read(MAX_CSV + 1)
    except FileNotFoundError:
        raise SpectrumError(f"distribution {str(path)!r}: no such word, CIE illuminant or file; {remedy}") from None
    except (OSError, ValueError) as error:
        raise SpectrumError(f"{path}: cannot be read as a CSV file ({error}); {remedy}") from None
    if len(text) > MAX_CSV:
        raise SpectrumError(f"{path}: is longer than {MAX_CSV:,} characters; {remedy}")
    return text


def _rows(path: Path, text: str) -> list[tuple[float, float, int]]:
    """Return wavelength, power and line number of each row; one heading, empty lines and comments are left out."""
    rows: list[tuple[float, float, int]] = []
    header_allowed = True
    for number, line in enumerate(text.splitlines(), 1):
        columns = [column.strip() for column in line.partition("#")[0].split(",")]
        if columns == [""]:
            continue
        try:
            row = [float(column) for column in columns]
        except ValueError:
            row = None
        if row is None and header_allowed and not _is_number(columns[0]):
            header_allowed = False
            continue
        header_allowed = False
        if row is None or len(row) != 2 or not all(map(isfinite, row)):
            raise SpectrumError(
                f"{path}, line {number}: {line.strip()!r}: two finite numbers are needed, wavelength (nm) and power, "
                "separated by a comma"
            )
        if row[1] < 0.0:
            raise SpectrumError(f"{path}, line {number}: power {row[1]:g} is negative; zero is the least")
        rows.append((*row, number))
    return rows


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
