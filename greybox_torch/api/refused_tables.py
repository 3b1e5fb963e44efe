"""Tables of a card that a later command would refuse: told before anything is estimated for it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from greybox_torch.data import DataSet
from greybox_torch.data.data_warning import InASentence
from greybox_torch.errors import UserError

if TYPE_CHECKING:
    from greybox_torch.model import GreyBoxModel

_EXPECTED = re.compile(r"[;,] expected ")


@dataclass(frozen=True)
class RefusedTable(InASentence):
    """What `greybox diagnose` or `greybox design` refuses, and what they expect, in a sentence each."""

    found: str
    write: str


def refused_tables(data: DataSet, model: GreyBoxModel) -> Iterator[RefusedTable]:
    """Of [beliefs], [diagnosis] and [limits], where data have all channels of the model."""
    from greybox_torch.diagnosis.beliefs import beliefs_from_mapping  # torch takes seconds
    from greybox_torch.diagnosis.settings import settings_from_mapping
    from greybox_torch.experiment_design.limits import limits_of

    if not {one.name for one in (*model.inputs, *model.outputs)} <= set(data.channels):
        return
    for command, read in (
        ("diagnose", partial(beliefs_from_mapping, data.beliefs, model, data.place("[beliefs]"))),
        ("diagnose", partial(settings_from_mapping, data.diagnosis, data.place("[diagnosis]"))),
        ("design", partial(limits_of, data, model, data.limits, data.place("[limits]"))),
    ):
        try:
            read()
        except UserError as error:
            found, write = found_and_expected(error, data)
            yield RefusedTable(f"{found}, which `greybox {command}` refuses", write)


def found_and_expected(error: UserError, data: DataSet) -> tuple[str, str]:
    """What an error about the card says is there, and what it says is expected."""
    said = str(error).removeprefix(f"{data.path}: ").removeprefix(f"{data.path}, ")
    found, *expected = _EXPECTED.split(said, maxsplit=1)
    return found, expected[0] if expected else "what fits the model"
