"""Thresholds by which the card's parameter values speak for an effect that the recordings cannot show, or against the model."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.fields import number, share


@dataclass(frozen=True, kw_only=True)
class CardSettings:
    """What moves of re-estimated parameters from the card's values say."""

    implausible_decade: float = number(
        0.05,
        "By how much the model as it stands is worse for each parameter, per squared decade, beyond the first, from the card's value; "
        "of what vanishes two decades count.",
        unit="logarithm of the mean squared error",
        chosen_by="guesses are right within a factor of ten; an arm whose stiffness vanished took up friction to a tenth of the error",
        least=0.0,
    )
    most_scatter_of_card: float = share(
        0.1,
        "How far the parameters may lie from the card's values, a gain error allowed for, where these are to speak for it; parameters "
        "with larger deviations say nothing.",
        unit="logarithm of the ratio, root mean square",
        chosen_by="data sheets and weighed parts are right within some per cent",
    )
    least_gain_error: float = share(
        0.05, "Gain error from which parameters are said to make up for one.", unit="relative error of the gain"
    )
    least_parameters_moved: float = number(
        2.5,
        "How many parameters, counted by their part, a gain has to move: two may move alike by chance.",
        unit="parameters",
        chosen_by="definition",
    )
    chance_of_common_gain: float = number(
        1e-3,
        "Probability up to which the moves may fall in line by chance, all gains that are looked at together.",
        unit="probability",
        chosen_by="one complete model in a thousand",
        least=1e-12,
        most=0.5,
    )
