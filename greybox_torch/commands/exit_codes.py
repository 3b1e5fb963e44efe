"""How the command line ends: errors become one message and an exit code."""

from __future__ import annotations

import errno
import logging
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from typing import Any

import typer
from typer.core import TyperGroup

from greybox_torch.commands.options import json_alone
from greybox_torch.errors import ArgumentError, NothingToDo, NumericalError, UserError
from greybox_torch.files import json_text


class Commands(TyperGroup):
    """Exit codes, in one place: 2 the user's input is at fault, 3 the numbers failed, 4 there is nothing to do, 130 interrupted.

    With --json, standard output is empty after an error: there is no result. That there is nothing to do is one.

    Files are written by `greybox_torch.files`, with messages of its own, so an error of the system here is one of standard output.
    """

    def invoke(self, ctx: Any) -> Any:
        given = [*ctx._protected_args, *ctx.args]
        try:
            with _libraries_silent(), json_alone() if "--json" in given else nullcontext():
                done = super().invoke(ctx)
            sys.stdout.flush()
            return done
        except ArgumentError as error:
            command = self.get_command(ctx, ctx.invoked_subcommand or "")
            positions = [] if command is None else [p.name for p in command.params if p.param_type_name == "argument"]
            told = error.for_position() if error.argument in positions else error.for_option()
            raise _stop(f"error: {told}", 2) from None
        except NothingToDo as told:
            if "--json" in given:
                typer.echo(
                    json_text({"schema": f"greybox-{ctx.invoked_subcommand}/1", "nothing_to_do": str(told)}), nl=False
                )
            raise _stop(str(told), 4) from None
        except UserError as error:
            raise _stop(f"error: {error}", 2) from None
        except NumericalError as error:
            raise _stop(f"the numbers failed: {error}", 3) from None
        except BrokenPipeError:  # `| head` has seen enough; results are in their files by then
            _no_more_output()
            raise typer.Exit(0) from None
        except OSError as error:
            if error.errno not in (errno.ENOSPC, errno.EIO, errno.EDQUOT):
                raise
            _no_more_output()
            raise _stop(f"error: standard output: cannot be written: {error.strerror}", 2) from None
        except KeyboardInterrupt as stop:
            raise _stop("; ".join(["interrupted", *map(str, stop.args)]), 130) from None


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


def _no_more_output() -> None:
    """What is still to be written to standard output, when Python ends at the latest, goes nowhere."""
    with suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _stop(message: str, code: int) -> typer.Exit:
    typer.echo(message, err=True)
    return typer.Exit(code)
