"""Problems of a scene as all checks state them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """What is wrong with one object, material or view layer, and the remedy.

    :param name: its name.
    :param text: the rest of a sentence that begins with the name.
    :param remedy: what to do about it, as a request.
    """

    name: str
    text: str
    remedy: str

    def __str__(self) -> str:
        return f"{self.name!r} {self.text}: {self.remedy}"
