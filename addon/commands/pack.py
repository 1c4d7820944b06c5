"""``pack``: a file for machines that take one .blend and nothing else."""

from __future__ import annotations

import argparse

from ..farm.packing import Packed, pack
from .shared import FOUND, AddParser, add_backend, add_check, add_file, add_json, blend_name, json_report, open_file

PACK_SCHEMA = 1
"""Version of the JSON that ``pack`` writes; it is counted on when a key changes its meaning or goes."""


def add_command(add_parser: AddParser) -> None:
    packing = add_parser("pack", help="make one .blend that needs no other file, for farms without the extension")
    add_file(packing)
    packing.add_argument(
        "-o", "--output", type=blend_name, required=True, metavar="OUT.blend", help="file to write; FILE stays as it is"
    )
    packing.add_argument(
        "--cut",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="let renders show surfaces cut where media cross, that of each scene's frame kept in the file; or not",
    )
    add_backend(packing)
    add_check(packing)
    packing.add_argument(
        "--keep-outside",
        action="store_true",
        help="write the file though it needs others that are missing or cannot be packed; the report lists them",
    )
    add_json(packing)
    packing.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> int:
    """Pack a file and say what was done and what machines must have.

    :returns: 0, or :data:`FOUND` where nothing was written, as the file lacks something or ``--check`` found it wrong.
    """
    with json_report(options, PACK_SCHEMA) as report:
        report |= Packed(None).as_json()
        open_file(options.file)
        packed = pack(options.output, options.cut, options.backend, options.check, options.keep_outside)
        report |= packed.as_json()
        print(packed, flush=True)
    return 0 if packed.saved else FOUND
