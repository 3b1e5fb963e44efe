"""How refitted hypotheses are compared."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.choosing import LOG_ERROR
from greybox_torch.diagnosis.settings.fields import count, number, share


@dataclass(frozen=True, kw_only=True)
class ComparisonSettings:
    """How refitted hypotheses are compared."""

    fewest_windows: int = count(
        8, "Windows that a standard error needs.", unit="windows", chosen_by="convention", least=2
    )
    least_ratio_spread: float = number(
        0.02, "Scatter of the windows' errors below which differences between windows mean nothing.", unit=LOG_ERROR
    )
    fewest_samples_of_a_law: int = count(
        8,
        "Samples in which a law that acts beyond a value alone has to act.",
        unit="samples",
        chosen_by="a sample or two are an event, and not a law that repeats",
    )
    parameter_price: float = number(
        0.003, "Improvement that a further parameter has to bring where more than noise is left.", unit=LOG_ERROR
    )
    score_tie: float = number(0.03, "Difference up to which named hypotheses tie.", unit=LOG_ERROR)
    polished_elsewhere: float = number(
        0.1,
        "How near a law at the other end of a spring has to come, in its first refit, to be refitted further.",
        unit=LOG_ERROR,
    )
    hardly_better: float = number(
        0.001, "Improvement below which refits of a law that may act at either end of a spring end.", unit=LOG_ERROR
    )
    trial_allowance: float = number(
        0.05, "How much worse than without it a candidate may be after its trial.", unit=LOG_ERROR
    )
    trial_promise: float = share(
        0.1,
        "Share of the residual that the screen has to promise over other windows than those of trials, for a candidate that does not "
        "show there to be tried over them, too.",
        unit="share of the residual's energy",
        chosen_by="a tank that overflows, which shows over long windows alone; less is promised by a law that is not there",
    )
    finalist_share: float = share(
        0.25,
        "Share of the gain of the best trial, less the allowance for one, from which a rival is refitted in full; "
        "the others are only where none of those pays.",
        unit="share of the best gain",
        chosen_by="far below the share from which a rival is polished; development cases",
    )
    polish_share: float = share(
        0.7, "Share of the best gain from which a rival is polished.", unit="share of the best gain"
    )
    shapes_tie: float = share(
        0.9,
        "Share of what the best shape of a law explains from which another shape may be as good.",
        unit="share of what the best explains",
    )
