"""Why nothing could be decided of a recording that was not refused: values that the library cannot work with."""

from __future__ import annotations

import traceback
from pathlib import Path

import numpy as np

#: What numerical code raises for such values.
NUMERICAL = (np.linalg.LinAlgError, ArithmeticError, ValueError, LookupError)
#: The library.
_LIBRARY = Path(__file__).resolve().parents[1]


def reason(error: BaseException) -> str:
    """Return in words that a calculation went wrong, and where in the library it did."""
    frames = traceback.extract_tb(error.__traceback__)
    own = [f for f in frames if Path(f.filename).is_relative_to(_LIBRARY)] or frames
    where = f"{Path(own[-1].filename).stem}, line {own[-1].lineno}: " if own else ""
    return (
        "nothing could be decided, a calculation went wrong; please report it with the data "
        f"({where}{type(error).__name__}: {error})"
    )
