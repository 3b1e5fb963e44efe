"""How the command line ends: errors become one message and an exit code."""

from __future__ import annotations

import logging
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

import typer
from typer.core import TyperGroup

from greybox_torch.commands.options import json_alone
from greybox_torch.errors import ArgumentError, NumericalError, UserError


class Commands(TyperGroup):
    """Exit codes, in one place: 2 the user's input is at fault, 3 the numbers failed, 130 interrupted."""

    def invoke(self, ctx: Any) -> Any:
        given = [*ctx._protected_args, *ctx.args]
        try:
            with _libraries_silent(), json_alone() if "--json" in given else nullcontext():
                return super().invoke(ctx)
        except ArgumentError as error:
            raise _stop(f"error: {error.for_option()}", 2) from None
        except UserError as error:
            raise _stop(f"error: {error}", 2) from None
        except NumericalError as error:
            raise _stop(f"the numbers failed: {error}", 3) from None
        except KeyboardInterrupt:
            raise _stop("interrupted", 130) from None


@contextmanager
def _libraries_silent() -> Iterator[None]:
    """What libraries warn of is for developers, who ask for it (`python -W default`); messages for users are our own."""
    nowhere = logging.NullHandler()
    logging.getLogger().addHandler(nowhere)  # without any, records go to standard error
    try:
        with warnings.catch_warnings():
            if not sys.warnoptions:
                warnings.simplefilter("ignore")
            yield
    finally:
        logging.getLogger().removeHandler(nowhere)


def _stop(message: str, code: int) -> typer.Exit:
    typer.echo(message, err=True)
    return typer.Exit(code)
