"""The model's own parameters, before and after: how far they were biased in a model that lacks something."""

from __future__ import annotations

from dataclasses import dataclass

from markupsafe import Markup

from greybox_torch.diagnosis.own_parameters import Estimate, far_refits
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report import text


@dataclass(frozen=True)
class Row:
    """A parameter and its values, with their standard deviations where they were estimated."""

    symbol: Markup
    unit: str
    values: tuple[str, ...]


@dataclass(frozen=True)
class Parameters:
    """``columns`` are the models: their names, and a few words on each; ``undetermined``: a standard deviation exceeds its value;
    ``bounded``: sentences on those at a bound, those determined together alone, and those re-estimated far off; "" for none.
    """

    columns: tuple[tuple[str, str], ...]
    rows: tuple[Row, ...]
    undetermined: bool = False
    bounded: str = ""
    template: str = "parameters.html.j2"

    @classmethod
    def of(cls, verdict: Verdict) -> Parameters | None:
        if not verdict.parameters:
            return None
        columns = (("Start", "the card's values"), ("Refit", "re-estimated as it is"))
        if verdict.effects:
            columns = (*columns, ("Augmented", "with the effects"))
        rows, undetermined = tuple(map(_row, verdict.parameters)), any(map(_undetermined, verdict.parameters))
        return cls(
            columns,
            rows,
            undetermined,
            " ".join((*verdict.at_bounds, *verdict.together, *far_refits(verdict.parameters))),
        )


def _undetermined(found: Estimate) -> bool:
    estimates = (found.refit, found.augmented) if found.augmented is not None else (found.refit,)
    return any(deviation is not None and deviation > abs(value) > 0.0 for value, deviation in estimates)


def _row(found: Estimate) -> Row:
    estimates = (found.refit, found.augmented) if found.augmented is not None else (found.refit,)
    values = (text.number(found.start, 4), *(text.measured(*one) for one in estimates))
    return Row(text.symbol(found.name), text.unit(found.unit), values)
