"""Thresholds by which held-out experiments take findings back, and by which the rest is claimed."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.fields import SIGMA, count, number, ratio, share

HELD_OUT_SHARE = "share of the held-out squared error"


@dataclass(frozen=True, kw_only=True)
class ConfirmationSettings:
    """What experiments that had no part in choosing make of a finding."""

    least_held_out: float = number(1.0, "By how much an effect must lower the held-out error to be kept.", unit=SIGMA)
    held_out_beyond_chance: float = number(
        3.0,
        "By how much a free curve must beat names there, or a law one that it contains, to be preferred, and any effect must lower the "
        "error to be as likely as its rivals leave it.",
        unit=SIGMA,
        chosen_by="convention",
    )
    least_held_out_alone: float = number(
        3.0,
        "By how much leaving out an effect there, all else as it is, must raise the error.",
        unit=SIGMA,
        chosen_by="convention",
    )
    held_out_in_part: float = share(
        0.9, "Gain below which it is asked whether the effect itself removes the error.", unit=HELD_OUT_SHARE
    )
    unexercised: float = share(
        2e-3,
        "Gain below which, either way, the experiments do not exercise an effect: they cannot take it back.",
        unit=HELD_OUT_SHARE,
    )
    hardly_exercised: float = share(
        0.01,
        "Part of what an effect changes in the errors of the experiments that chose it, below which others do not say how large it is.",
        unit="share of the change of the mean squared error",
    )
    obvious_mismatch: float = share(
        0.05,
        "Error of the plain model, by windows and by free runs, from which something is missing also where the recordings show no more "
        "than an upper bound of the noise, if it is far above that.",
        unit="share of the outputs' spread (root mean square)",
        chosen_by="a simulated curve that lies visibly beside the measured one",
    )
    least_fit_of_free_runs: float = number(
        50.0,
        "Mean fit of the plain model's free runs on the validation experiments below which something is missing, if their error is far "
        "above what disturbances leave and windows show more than noise.",
        unit="%",
        chosen_by="1500 verdicts: complete machines that drift were at 72 and more",
    )
    least_size: float = share(
        0.02,
        "Size from which an effect is a finding: the part of the plain model's held-out mismatch that leaving it out brings back. "
        "What is smaller is a refinement.",
        unit="share of the plain model's held-out mismatch",
        chosen_by="cases simulated elsewhere: what a law lacks to be the machine's stays below 0.005, effects begin at 0.05",
    )
    left_to_doubt_of_several: float = share(
        0.25,
        "Part of the mismatch of free validation runs that several effects must leave for the weakest to be tried without.",
        unit="share of the mean squared error of free validation runs beyond the noise",
    )
    left_to_doubt_a_curve: float = share(
        0.1,
        "The same that a free curve must leave for names that it stood before to be tried in its place.",
        unit="share of the mean squared error of free validation runs beyond the noise",
    )
    left_to_ask_for_a_curve: float = share(
        0.1,
        "The same that names must leave, of which some did not last, for the curve that they stood for to be tried in their place.",
        unit="share of the mean squared error of free validation runs beyond the noise",
        chosen_by="what evaporates from a bath: the constant that lasted leaves 0.12",
    )
    left_if_far_better: float = share(
        0.5,
        "Part of that which must be left at most by either to be told instead.",
        unit="share of what all effects leave",
    )
    curve_far_ahead: float = ratio(
        3.0,
        "How many times what the best name gains a free curve that is no finding must gain for the name to be none either.",
        unit="times the gain",
        chosen_by="a soft stop told of a complete arm at one and a half times its noise: 3.6",
    )
    least_share_kept: float = share(
        0.1,
        "What the fit of whole records has to leave of an effect's amplitudes for windows of held-out experiments to prove it.",
        unit="share of the amplitude over windows",
    )
    least_not_undone: float = share(
        0.003,
        "What has to be left of what a named law does once all other parameters have compensated what they can; else it is removed again.",
        unit="share of its squared output over the shortest windows",
        chosen_by="laws found rightly keep 0.0075 to 1 of it, a sensor's gain that a spring's stiffness undid 0.00004 to 0.0027",
    )
    most_of_the_mismatch: float = share(
        0.5,
        "Size from which a law stands for the mismatch, however much of what it does other parameters undo.",
        unit="share of the mismatch",
    )
    unseen_start: float = share(
        1e-5,
        "Least change of a start state that no sensor shows, by which it is asked whether free runs can follow an experiment.",
        unit="share of the state's travel",
        chosen_by="a hundredth of what sensors of three digits show",
    )
    least_parted: float = share(
        0.1,
        "How far such a change has to part two free runs of a model, of an experiment that free runs cannot follow.",
        unit="share of the free run's error (root mean square)",
        chosen_by="orders of magnitude: beside an error of 1 % of the travel, changes have grown a hundredfold",
    )
    followed: float = share(
        0.9,
        "Fit from which a model's free runs follow an experiment: where those of two models do, it can compare them.",
        unit="mean fit of the outputs",
        chosen_by="convention",
    )
    least_growth: float = ratio(
        100.0,
        "How much larger it has to be over the record than over its first tenth.",
        unit="times, root mean square",
        chosen_by="what drifts steadily grows tenfold",
    )
    least_removed: float = share(
        0.15,
        "Part of the mismatch of free runs that all effects together have to remove, where much more than noise is left.",
        unit="share of the mean squared error of free validation runs beyond the noise",
        chosen_by="recordings of real machines: right findings removed 0.2 and more, a wrong one 0.09",
    )
    least_removed_by_curve: float = share(
        0.5,
        "The same for a free curve or response, which draws a part of anything, where the fit hardly rises with it.",
        unit="share of the mean squared error of free validation runs beyond the noise",
        chosen_by="most of it; three proofs and twelve sets: right ones removed 0.69 and more, a wrong one 0.31",
    )
    least_points_of_curve: float = number(
        2.0,
        "By how much the mean fit of the validation experiments rises where it does not hardly do so.",
        unit="points of the fit in %",
        least=0.0,
        chosen_by="two tanks of which a curve, rightly placed, removed 0.32: 5.6 points; a complete pendulum: half a point",
    )
    no_mismatch: float = share(
        0.01,
        "Squared error beyond the noise up to which windows of one length say nothing of an effect's size.",
        unit="share of the noise's squared error",
        chosen_by="how exactly recordings of some thousand samples tell their noise",
    )
    least_of_little: float = share(
        0.7,
        "Where the model leaves little more than noise: the part of that which one effect has to account for.",
        unit="share of the plain model's held-out mismatch",
        chosen_by="blind sets and proofs: real weak effects account for 0.82 to 1 of it, imperfections for 0.03 to 0.62",
    )
    least_first_of_little: float = share(
        0.35,
        "The same of what was found so far, for more to be looked for: two effects that need one another bring half of it each.",
        unit="share of the plain model's mismatch",
        chosen_by="half of `least_of_little`",
    )
    least_size_at_noise: float = share(
        5e-3,
        "The same where with all effects hardly more than noise is left on held-out experiments: then nothing lacks that it could be.",
        unit="share of the plain model's held-out mismatch",
        chosen_by="second effects of four proofs and of unseen machines: right ones from 0.0075 on, wrong ones below that up to 0.0034",
    )
    nearly_all_of_the_rest: float = share(
        0.9,
        "Part of what the others leave that an effect at a port of its own has to remove for the same: they lack no more than what stays.",
        unit=HELD_OUT_SHARE,
        chosen_by="refinements of six proofs and fourteen sets: two remove that much at a port of their own, and both are the machine's",
    )
    all_of_the_rest: float = share(
        0.99,
        "Part of it that is a finding however small beside the others, where with all of them hardly more than noise is left: without it "
        "ten times the noise is.",
        unit=HELD_OUT_SHARE,
        chosen_by="1451 verdicts: one refinement removes 97 % and more at a port of its own, and it is the machine's",
    )
    least_size_beside_larger: float = share(
        0.1,
        "The same for a law at the port of a larger one, where the two are friction by speed alone or one spring's, or leave more than "
        "noise: it may be what the larger one lacks.",
        unit="share of the plain model's held-out mismatch",
        chosen_by="bristles that also damp and slide by speed: what one law of friction lacks of them is 0.02 to 0.06",
    )

    least_times_what_is_left: float = ratio(
        2.0,
        "How many times what free runs leave, if that is more than noise, an effect that is little beside a larger one accounts for.",
        unit="times the share of the mismatch that is left",
        chosen_by="four blind proofs and twelve sets: right second effects 3.5 and more, what the first one lacks 0.25 to 1.2",
    )
    least_of_error_repeats: float = share(
        0.7,
        "Correlation of an error of some times the noise with one past input from which part of it repeats, and so something is missing.",
        unit="largest correlation",
        chosen_by="half of its variance; complete machines whose laws are all a little richer: 0.2",
    )

    least_parts: int = count(
        3,
        "Effects found from which the search ends where each accounts for less of the mismatch than all of them leave, and the fit hardly "
        "rises.",
        chosen_by="of three effects that a machine has, the largest accounts for a third, and all of them leave nothing",
    )


@dataclass(frozen=True, kw_only=True)
class ResidualSettings:
    """How the errors of free runs are tested for the evidence; nothing is decided by them."""

    excited_share: float = share(
        0.99, "Power of an input up to the end of its excited band.", unit="share of the power", chosen_by="convention"
    )
    chance: float = number(
        0.01,
        "Probability with which the largest correlation exceeds its bound where there is nothing.",
        unit="probability",
        chosen_by="convention",
        least=1e-12,
        most=0.5,
    )
    runaway: float = ratio(
        1e3,
        "Size of a free run from which its errors are only its own.",
        unit="sizes of the measurement",
        chosen_by="orders of magnitude",
    )
