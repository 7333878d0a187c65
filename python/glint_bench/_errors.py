"""What goes wrong."""

from __future__ import annotations

import re

_CODES = {
    1: "usage",
    2: "bad_prediction",
    3: "bad_reference",
    4: "check_failed",
    5: "partial",
    6: "environment",
}


class GlintWarning(UserWarning):
    """Something that a score, a scene or a training was done in spite of."""


class GlintError(Exception):
    """What a program of GLINT Bench would have ended with.

    code: str, "usage", "bad_prediction", "bad_reference", "check_failed", "partial" or "environment"
    exit_code: int, 1 to 6, of the programs (docs/reference/verbs.md)
    file: str, what the message is about; None where it names none
    cure: str, what to do; None where the message does not say
    """

    code: str
    exit_code: int
    file: str | None
    cure: str | None

    def __init__(self, message: str, exit_code: int = 6) -> None:
        super().__init__(message)
        self.exit_code = exit_code
        self.code = _CODES.get(exit_code, "environment")
        self.file = _file_of(message)
        self.cure = _cure_of(message)


def _file_of(message: str) -> str | None:
    """Messages open with the file, or the argument, and a colon."""
    opening = re.match(r"([^\n]+?): ", message)
    if opening is None or not re.search(r"[/\\]|\.\w{1,6}$", opening[1]):
        return None
    return opening[1]


def _cure_of(message: str) -> str | None:
    """Messages close with what to do, behind a semicolon."""
    before, semicolon, cure = message.rpartition("; ")
    return cure if semicolon else None
