"""Text of anyone's, made fit to stand in a page."""

import html
import re
from typing import Any

ILLEGIBLE = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML, and so a page that is XML, may not hold."""


def legible(said: str) -> str:
    """The text, with a mark for every character that a page must not hold."""
    return ILLEGIBLE.sub("\ufffd", said)


def text(value: Any) -> str:
    """What a value says, such that no character of it is markup."""
    return html.escape(legible(str(value)))
