"""Thresholds by which a search is made once more: with a held-out experiment to choose with, or over longer windows."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.fields import count, number, ratio, share

NOISE_MULTIPLE = "times the noise (root mean square)"


@dataclass(frozen=True, kw_only=True)
class SearchingAgainSettings:
    """What held-out experiments show that those to choose with do not."""

    most_promoted: int = count(
        100,
        "Validation experiments that may be taken to choose with besides those of estimation, at most; 0 keeps all of them for judging.",
        unit="experiments",
        chosen_by="no limit: one is taken only while another is left to judge",
        least=0,
    )
    promote_error: float = ratio(
        1.5, "Error from which a validation experiment shows what nothing was found of.", unit=NOISE_MULTIPLE
    )
    promote_error_beside: float = ratio(
        2.0, "The same where something was found, which may be a little wrong and yet right.", unit=NOISE_MULTIPLE
    )
    promote_share_beside: float = share(
        0.32,
        "Part of the plain model's error that must then be left besides: a tenth of the mean squared error.",
        unit="share of the plain model's error",
        chosen_by="cases simulated elsewhere: from less, searching again never bettered what was found",
    )
    rival_error: float = ratio(
        1.1,
        "Error of what was found from which validation experiments are asked about its rivals.",
        unit=NOISE_MULTIPLE,
        chosen_by="what is right leaves 1.00 to 1.05 there",
    )
    rival_margin: float = share(
        0.1,
        "By how much a rival may have lost for held-out experiments to be asked about it.",
        unit="difference in the logarithm of the mean squared error",
        chosen_by="twins of time in three proofs: right ones lost by up to 0.09 while a stop or a limit beside them was not the machine's",
    )
    telling_divergence: float = number(
        4.6,
        "Log-likelihood ratio by which a validation experiment would tell an undecided rival, from which it is taken to choose with.",
        unit="nats",
        chosen_by="100 to 1, decisive evidence by H. Jeffreys, Theory of Probability, 1961",
    )
    slow_share: float = share(
        0.25,
        "Part of the mismatch of free runs that must be left, where windows show noise alone, for longer ones to be searched; "
        "what those find has to leave less than this part of it.",
        unit="share of the mean squared error of free validation runs beyond the noise",
        chosen_by="most of it: disturbances that add up may take some",
    )
