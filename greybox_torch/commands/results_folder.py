"""Whether results can be written, asked before anything is computed."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from rich.console import Console
from rich.text import Text

from greybox_torch.errors import UserError
from greybox_torch.result_names import FIT, MODEL, TRAINED, VERDICT

COMMANDS = {"diagnose": VERDICT, "fit": FIT, "train": TRAINED}
"""The commands that write a model, model.safetensors and model.json, by what they write beside it."""


def others_model(folder: Path, command: str) -> str:
    """What to warn of where ``folder`` holds the model of another command, whose results would lie beside one that is not theirs."""
    there = [name for name, file in COMMANDS.items() if name != command and (folder / file).is_file()]
    if not there or not (folder / f"{MODEL}.json").is_file():
        return ""
    named = " and ".join(f"greybox {name} ({COMMANDS[name]})" for name in there)
    return (
        f"{folder}: holds results of {named}, whose model (model.json, model.safetensors) this command replaces; expected another folder, "
        "--out DIR"
    )


NOTHING_WRITTEN = "nothing is written"
"""What Ctrl-C says of a command that leaves nothing behind."""


class Replacing:
    """Warns once that another command's model is going to be replaced: when the work begins, as arguments that are refused replace nothing,
    or else before results are written, as another process may have written its own meanwhile.

    Args:
        look: gives the warning as things are, "" for none.
    """

    def __init__(self, look: Callable[[], str] = lambda: "") -> None:
        self._look = look
        self._left, self._begun = [True], False  # several threads may tell of progress, and one takes what is left

    def warn(self) -> None:
        """Say it where there is something to be said, unless it is said."""
        told = self._look()
        with suppress(IndexError):
            if told and self._left.pop():
                Console(stderr=True, highlight=False).print(Text(f"warning: {told}", style="yellow"), soft_wrap=True)

    def before(self, hear: Callable[..., None]) -> Callable[..., None]:
        """``hear``, which is told of progress, with the warning before the first of it."""

        def heard(*now: object) -> None:
            if not self._begun:
                self._begun = True
                self.warn()
            hear(*now)

        return heard


def check_folder(folder: Path) -> None:
    """Raises UserError where results could not be written to ``folder``: a file is in the way, or nothing can be written there.

    What is tried is gone again; ``folder`` is not made.
    """
    try:
        nearest = next(path for path in (folder, *folder.absolute().parents) if path.exists())
    except OSError as error:
        raise UserError(f"--out {folder}: cannot be written: {error.strerror}; expected a folder for results") from None
    if not nearest.is_dir():
        raise UserError(f"--out {folder}: {nearest} is a file; expected a folder for results")
    try:  # rights alone do not say it: not of the administrator, nor where a disk is read-only or holds no files
        if nearest == folder:
            with tempfile.TemporaryFile(dir=nearest):
                pass
        else:
            with tempfile.TemporaryDirectory(dir=nearest, prefix=".greybox"):
                pass
    except OSError as error:
        raise UserError(
            f"--out {folder}: nothing can be written in {nearest} ({error.strerror or error}); expected a folder for results"
        ) from None


@contextmanager
def nothing_written() -> Iterator[None]:
    """What Ctrl-C says in the block: that there are no results. For a command that writes all that it finds at the end."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(NOTHING_WRITTEN) from None
