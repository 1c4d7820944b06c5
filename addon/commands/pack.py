"""``pack``: a file for machines that take one .blend and nothing else."""

from __future__ import annotations

import argparse
import json
import sys
from contextlib import nullcontext

from ..farm.packing import pack
from ..model.streams import log_to_stderr
from .shared import FOUND, AddParser, add_backend, add_check, add_file, blend_name, open_file


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
    packing.add_argument("--json", action="store_true", help="write the report as JSON")
    packing.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> int:
    """Pack a file and say what was done and what machines must have.

    :returns: 0, or :data:`FOUND` where nothing was written, as the file lacks something or ``--check`` found it wrong.
    """
    with log_to_stderr() if options.json else nullcontext(sys.stdout) as output:
        open_file(options.file)
        packed = pack(options.output, options.cut, options.backend, options.check, options.keep_outside)
        text = json.dumps(packed.as_json(), indent=2, ensure_ascii=False) if options.json else str(packed)
        print(text, file=output, flush=True)
    return 0 if packed.saved else FOUND
