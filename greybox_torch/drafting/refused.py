"""Whether a card that was drafted can be read, and what is in the way: what `check` and `inspect` would say of it."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from pathlib import Path

from greybox_torch.data.card import USUAL, card_of
from greybox_torch.data.load import dataset_of
from greybox_torch.drafting.runs import Run, names_of
from greybox_torch.errors import UserError

_SAME_STEP = 0.01
"""Of a sample time: how far another one may be from it."""


def why_refused(text: str, folder: Path) -> list[str]:
    """What the commands that read a card in ``folder`` would refuse of it; empty where they read it."""
    path = folder / USUAL
    if not folder.is_dir():  # then files beside it cannot be found from there yet
        return []
    try:
        dataset_of(card_of(tomllib.loads(text), path), path)
    except UserError as error:
        return [f"the card is refused as it is: {str(error).removeprefix(f'{path}, ').removeprefix(f'{path}: ')}"]
    return []


def of_other_steps(runs: Sequence[Run]) -> list[str]:
    """Runs whose sample time the one of the card is not, where the card has one for all; a line each, to begin with the experiment."""
    first = runs[0].clock
    if first.column is not None or first.sample_time is None:
        return []
    told = []
    for name, run in list(zip(names_of(runs), runs, strict=True))[1:]:
        step = run.step
        if step is not None and abs(step / first.sample_time - 1.0) > _SAME_STEP:
            told.append(
                f'[[experiment]] "{name}": {run.clock.remark}, and sample_time = {first.sample_time:.6g} s goes for all experiments of a '
                "card; expected a card for each, or time stamps in every file"
            )
    return told
