"""`greybox card`: a first data card from recordings."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from rich.text import Text

from greybox_torch.api.card import card
from greybox_torch.commands.options import Options


def run(files: Sequence[Path], sample_time: float | None, options: Options) -> None:
    """Writes the card, and says what is left to fill in. Nothing is overwritten."""
    drafted = card(files, options.model, path=options.out, sample_time=sample_time)
    (written,) = drafted.save()
    console = options.console()
    drafted.show(console)
    inspect = f"greybox inspect {shlex.quote(str(written))}"
    then = f"Fill in what is said above; then {inspect}" if drafted.open else f"Next: {inspect}"
    console.print(Text(f"Written to {written}. {then}"), soft_wrap=True)
    options.print_json(drafted.to_json())
