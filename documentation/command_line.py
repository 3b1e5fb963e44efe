"""The page on the command line: every command, with its arguments and options, as `greybox COMMAND --help` says them."""

from __future__ import annotations

import re
from typing import Any

import typer

from documentation.tables import table
from greybox_torch.cli import app


def commands() -> dict[str, Any]:
    """Every command of `greybox`, by name, in the order of its help."""
    group: Any = typer.main.get_command(app)
    return dict(group.commands)


def page() -> str:
    """The page in Markdown."""
    lines = [
        "# Command line",
        "",
        "Written from the program. With `--json` the result goes to standard output, and everything else to standard error.",
        "",
        *table(
            ("exit code", "means"),
            [
                ("0", "a result, whatever it says"),
                (
                    "2",
                    "the input is at fault: one message names file, line or field, what was found and what is expected",
                ),
                ("3", "the numbers failed: what, where, and what to try"),
                ("4", "there is nothing to do: what was asked for is decided already (`design`)"),
                ("130", "interrupted with Ctrl-C; what is written is whole"),
            ],
        ),
    ]
    for name, command in commands().items():
        lines += ["", f"## greybox {name}", "", str(command.help), "", *_parameters(name, command)]
    return "\n".join(lines) + "\n"


def _parameters(name: str, command: Any) -> list[str]:
    context = command.context_class(command, info_name=f"greybox {name}")
    records = [parameter.get_help_record(context) for parameter in command.params]
    rows = [(f"`{_plain(written)}`", meaning) for written, meaning in filter(None, records)]
    usage = " ".join(["greybox", name, *map(_plain, command.collect_usage_pieces(context))])
    return ["```text", usage, "```", "", *table(("argument or option", "meaning"), rows)]


def _plain(written: str) -> str:
    """Without the type behind an argument's name, nor braces around it."""
    return re.sub(r" <.*>|[{}]", "", written).replace("......", "...")
