"""The one place where code of a user's model file is called.

Whatever it raises becomes one message with file and line, `sys.exit` included. What it prints goes to standard error, so that a result
on standard output stays readable by machines. Only Ctrl-C passes through.
"""

from __future__ import annotations

import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from pathlib import Path

from greybox_torch.errors import UserError
from greybox_torch.files import absolute
from greybox_torch.keywords import keyword_advice


@contextmanager
def users_code(file: Path, place: str, doing: str) -> Iterator[None]:
    """Runs the block, which calls code of the model file `file`.

    Args:
        place: how a message begins ("model file my_motor.py, class Motor").
        doing: what was done when it failed ("creating it").

    Raises:
        UserError: whatever the code raises, with the line of `file` on the way to it.
    """
    try:
        with redirect_stdout(sys.stderr):
            yield
    except KeyboardInterrupt:
        raise
    except UserError as error:
        line = "" if ", line " in str(error) else line_in(file, error)
        if not line:
            raise
        raise UserError(f"{place}{line}: {error}") from None
    except SystemExit as error:
        raise UserError(
            f"{place}{line_in(file, error)}: {doing} called sys.exit({_said(error)}); expected a class, and nothing that ends the program"
        ) from None
    except BaseException as error:
        said, advice = _said(error), keyword_advice(error)
        if advice:
            said = said.partition(". Did you mean")[0]  # as newer versions of Python go on
        raise UserError(
            f"{place}{line_in(file, error)}: {doing} raised {type(error).__name__}: {said}{advice}"
        ) from None


def line_in(file: Path, error: BaseException) -> str:
    """`, line N` with the last line of `file` on the way to the error; empty where there is none."""
    if isinstance(error, SyntaxError) and error.lineno:
        return f", line {error.lineno}"
    own = absolute(file)
    lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if absolute(Path(f.filename)) == own]
    return f", line {lines[-1]}" if lines else ""


def _said(error: BaseException) -> str:
    """The error's own words; an error whose words raise an error in turn has none."""
    try:
        return str(error)
    except Exception:
        return "(its message cannot be shown)"
