"""Experiments that are too short: to estimate a model from, or to judge it by."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from greybox_torch.checking.scale_of_time import ScaleOfTime, coarse, in_larger_units
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


def short_records(data: DataSet, model: GreyBoxModel) -> Iterator[ShortRecords | ScaleOfTime]:
    """Whether the sample time is long beside the model's time constants, the estimation experiments are short beside them, or have few
    samples for what is unknown, and the validation experiments are short beside either.
    """
    from greybox_torch.estimate.problem import make_problem  # these load torch
    from greybox_torch.estimate.short_estimation import few_samples, short_estimation
    from greybox_torch.estimate.short_validation import short_validation
    from greybox_torch.estimate.slowest_time_constant import slowest_time_constant

    try:
        problem = make_problem(data, model, data.estimation() or data.recordings)
    except UserError:
        return  # told elsewhere
    constant = slowest_time_constant(model.plain, problem)
    if few := few_samples(problem):
        yield ShortRecords(f"[[experiment]]: {few}", "longer experiments, or values that are known, with fixed = true")
    yield from coarse(data, constant)
    if constant is not None and (short := short_estimation(data, constant)):
        unit = in_larger_units(data, constant)
        longer = "experiments over that time constant and more; or its parameters fixed"
        yield ShortRecords(f"[[experiment]]: {short}", f"{longer}; or {unit}" if unit else longer)
    told = short_validation(data, constant)
    if told is not None:
        yield ShortRecords(f"[[experiment]] role: {told}")
