"""Validation experiments that are too short to judge a model by."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from greybox_torch.data import DataSet
from greybox_torch.data.data_warning import InASentence
from greybox_torch.errors import UserError

if TYPE_CHECKING:
    from greybox_torch.model import GreyBoxModel


@dataclass(frozen=True)
class ShortRecords(InASentence):
    """What is short, in a sentence."""

    found: str
    write: str = (
        "validation experiments over several time constants and delays of the machine, or those of estimation divided"
    )


def short_records(data: DataSet, model: GreyBoxModel) -> Iterator[ShortRecords]:
    """Whether the validation experiments are short beside those of estimation, or beside the model's time constants there."""
    from greybox_torch.estimate.problem import make_problem  # these load torch
    from greybox_torch.estimate.short_validation import short_validation
    from greybox_torch.estimate.slowest_time_constant import slowest_time_constant

    try:
        problem = make_problem(data, model, data.estimation() or data.recordings)
    except UserError:
        return  # told elsewhere
    told = short_validation(data, slowest_time_constant(model.plain, problem))
    if told is not None:
        yield ShortRecords(f"[[experiment]] role: {told}")
