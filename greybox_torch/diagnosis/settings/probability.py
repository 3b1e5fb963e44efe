"""How sure the verdict is, by what it found."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.fields import SIGMA, number, share


@dataclass(frozen=True, kw_only=True)
class ProbabilitySettings:
    """How sure the verdict is, by what it found."""

    windows_temperature: float = number(
        2.0,
        "Standard errors that count as one: windows are not independent, and no law is exactly the machine's.",
        unit=SIGMA,
        least=1e-3,
    )
    share_exponent: float = number(
        2.0,
        "Power of the weights by which a finding and its rivals share a probability: what leads is right more often than they say.",
        unit="",
        least=1.0,
        chosen_by="two blind proofs, tested on a third: the smallest squared error of the names' probabilities",
    )
    highest_probability: float = share(
        0.97, "The most that is ever claimed.", unit="probability", chosen_by="the proof's calibration"
    )
    highest_probability_far_above_noise: float = share(
        0.85,
        "The most that is claimed for a name where the laws together leave much more than noise.",
        unit="probability",
    )
    highest_probability_where_most_is_left: float = share(
        0.5, "The same where that is also most of the mismatch.", unit="probability", chosen_by="even odds"
    )
    most_of_mismatch: float = share(
        0.67,
        "Share of the plain model's mismatch from which most of it is left, at the window length where it is largest, or in free "
        "runs of the validation experiments.",
        unit="share of the plain model's mismatch",
        chosen_by="two thirds: what is named is then the smaller part",
    )
    little_in_free_runs: float = share(
        0.33,
        "Share of it left in free runs of the validation experiments up to which windows alone do not say that most is left.",
        unit="share of the plain model's mismatch",
        chosen_by="a third; of seven names so far below it whose windows left two thirds, seven were right",
    )
    most_of_measured: float = share(
        0.16,
        "Mean squared error of free validation runs from which they follow too little of what was measured for a sure finding.",
        unit="variances of what was measured",
        chosen_by="a fit of 60 %: of 1060 names that were right as often as claimed, 1059 stood at fits of 70 % and more",
    )
    most_left_by_a_sure_name: float = share(
        0.2,
        "Share of the mismatch that free validation runs may leave with a sure name where they follow less than that of what was measured "
        "on the average of the experiments.",
        unit="share of the plain model's mismatch",
        chosen_by="of 1960 verdicts two names that were sure left more at such fits, both wrong; one that left 8 % was right",
    )
    highest_probability_by_free_runs: float = share(
        0.5,
        "The most that is claimed for laws that free runs of the validation experiments chose in the place of what windows preferred: no "
        "recording is left that had no part in it.",
        unit="probability",
        chosen_by="even odds; of three such names two were a part of the right one, and one was wrong",
    )
    highest_probability_beside_a_curve: float = share(
        0.5,
        "The most that is claimed for a name where a free curve in its place goes clearly farther and free runs leave much.",
        unit="probability",
    )
    as_far_as_a_curve: float = share(
        0.9,
        "Share of the gain of the best free curve in its place that a name has to reach not to count as clearly behind it.",
        unit="share of the gain, in logarithms of the error",
        chosen_by="a brake's drag told as an asymmetry: 0.85; right names that free runs bear out to a hundredth: 0.64 to 1",
    )
    left_beside_a_curve: float = share(
        0.05,
        "Share of the mismatch that free runs of the validation experiments have to leave beside that.",
        unit="share of the squared error of the model as it stands",
        chosen_by="the same brake: 0.065; right names behind a curve: 0.003 at most",
    )
    highest_probability_of_stopped_curve: float = share(
        0.5,
        "The most that is claimed for a free curve where the search was stopped before names were tried.",
        unit="probability",
    )
    highest_probability_of_stopped_name: float = share(
        0.85,
        "The most that is claimed for a law where the search was stopped.",
        unit="probability",
        chosen_by="six proofs and unseen machines: of 18 names that stopped searches were surer of, 15 were right",
    )
    highest_probability_beside_a_question: float = share(
        0.5,
        "The most that is claimed for what was found where a slip on the card, which the result asks about, explains far more.",
        unit="probability",
        chosen_by="even odds",
    )
    far_more_by_a_question: float = share(
        0.5,
        "A slip on the card leads the verdict where it leaves less to a validation fit of 100 % than this part of what findings leave.",
        unit="share of what is left to a fit of 100 %",
        chosen_by="as a slip has to be beside the model as it stands to be asked about",
    )
    left_by_a_slip: float = share(
        0.1,
        "A slip on the card leads the verdict, where an effect at its channel is told, if it alone leaves less to a validation fit of "
        "100 % than this part of what the model as it stands leaves.",
        unit="share of what is left to a fit of 100 %",
        chosen_by="nine tenths, as a name has to go as far as a curve",
    )
    least_alternative: float = share(
        0.005, "Probability from which a rival is listed.", unit="probability", chosen_by="legibility"
    )
    least_class_share: float = share(
        0.05,
        "Probability from which a rival is told together with the finding, as one statement, wherever its fitted outputs lie.",
        unit="probability",
        chosen_by="19 to 1 counts as decided",
    )
    visible_divergence: float = number(
        3.0,
        "Log-likelihood ratio below which the difference of two hypotheses' fitted outputs cannot be seen.",
        unit="nats",
        chosen_by="20 to 1, strong evidence by H. Jeffreys, Theory of Probability, 1961",
    )
    confidence_missing_unnamed: float = share(
        0.8, 'Confidence in "something is missing" where the size of the error alone says so.', unit="probability"
    )
    confidence_nothing: float = share(
        0.95, 'Confidence in "nothing is missing" where no candidate gained anything.', unit="probability"
    )
    confidence_nothing_with_rivals: float = share(
        0.8, "The same where some candidate gained least_gain or more and yet was not taken.", unit="probability"
    )
    confidence_nothing_above_noise: float = share(
        0.6, "The same where the error is more than noise.", unit="probability"
    )
    free_runs_to_doubt_nothing: float = number(
        7.0,
        "Times the noise that free runs leave from which that confidence holds, though windows leave noise alone.",
        unit="times the noise",
        chosen_by="two blind proofs: of 100 complete machines one leaves more, of eight others told as complete three",
    )
    confidence_stopped: float = share(
        0.5,
        "The same where the search was stopped before it found anything.",
        unit="probability",
        chosen_by="no answer",
    )
