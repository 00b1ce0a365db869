"""What all commands share: where they print, and how they fail."""

import sys
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import typer
from rich.console import Console

console = Console(highlight=False, markup=False)


@contextmanager
def one_line_errors() -> Iterator[None]:
    """Bad input, a full disk or Ctrl-C in one line; exit status 2, or 130 for a stop."""
    try:
        yield
    except (ValueError, OSError, ImportError, OverflowError, MemoryError, RecursionError) as error:
        said = " ".join(str(error).split()) or f"{type(error).__name__}: a value is too large"
        print(f"twinecho: {said}", file=sys.stderr)
        raise typer.Exit(2) from None
    except KeyboardInterrupt:
        print("twinecho: stopped; what is finished of a run is stored, and the same command goes on", file=sys.stderr)
        raise typer.Exit(130) from None


def toml_value(text: str) -> Any:
    """A value as TOML reads it, or text where it does not."""
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text
