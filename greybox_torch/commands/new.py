"""`greybox new`: a first model file."""

from __future__ import annotations

import shlex

from rich.text import Text

from greybox_torch.api.new import new
from greybox_torch.commands.options import Options


def run(name: str, like: str, options: Options) -> None:
    """Writes the file. Nothing is overwritten."""
    made = new(name, like=like, path=options.out)
    made.save()
    console = options.console()
    made.show(console)
    told = f"Written to {made.path}. Next: change it, then greybox check {shlex.quote(made.reference)}"
    console.print(Text(told), soft_wrap=True)
    options.print_json(made.to_json())
