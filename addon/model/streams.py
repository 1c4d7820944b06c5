"""Keeping what Blender itself prints out of what a program prints."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TextIO


@contextmanager
def log_to_stderr() -> Iterator[TextIO]:
    """Let what Blender itself prints go to the standard error output, and yield the standard output."""
    sys.stdout.flush()
    output = os.dup(1)
    os.dup2(2, 1)
    try:
        with open(output, "w", encoding="utf-8", errors="backslashreplace", closefd=False) as stream:
            yield stream
    finally:
        sys.stdout.flush()
        with suppress(OSError, AttributeError, TypeError):
            ctypes.CDLL(None).fflush(None)  # or what C has kept would follow later
        os.dup2(output, 1)
        os.close(output)
