"""How the command line ends: errors become one message and an exit code."""

from __future__ import annotations

from contextlib import nullcontext
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
            with json_alone() if "--json" in given else nullcontext():
                return super().invoke(ctx)
        except ArgumentError as error:
            raise _stop(f"error: {error.for_option()}", 2) from None
        except UserError as error:
            raise _stop(f"error: {error}", 2) from None
        except NumericalError as error:
            raise _stop(f"the numbers failed: {error}", 3) from None
        except KeyboardInterrupt:
            raise _stop("interrupted", 130) from None


def _stop(message: str, code: int) -> typer.Exit:
    typer.echo(message, err=True)
    return typer.Exit(code)
