"""Thresholds by which effects are chosen from the estimation experiments."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.fields import SIGMA, count, number, ratio, share

NOISE_MULTIPLE = "times the noise (root mean square)"
GAIN = "share of the mean squared error"
LOG_ERROR = "logarithm of the mean squared error"


@dataclass(frozen=True, kw_only=True)
class NoiseSettings:
    """What counts as noise, from the recordings alone."""

    noise_differences: int = count(
        3,
        "How many times outputs are differenced: motion is smooth at the rate it is sampled at, noise is not.",
        unit="differences",
        chosen_by="von Neumann et al. 1941, one order more than there",
    )
    noise_floors_agree: float = ratio(
        1.05,
        "Ratio of the noises that differences of several orders show up to which they agree.",
        unit="ratio of mean squares",
    )
    noise_disproved: float = ratio(
        4.0,
        "Ratio of what the recordings of an output show as noise to what a fit leaves of it, from which it is no noise: an input acts on "
        "the output at once, as a current does on a battery's voltage.",
        unit="ratio of mean squares",
    )
    only_noise: float = number(
        1.0,
        "Error below which nothing is looked for. (Under feedback the floor is a few per cent high.)",
        unit="times the mean square of the noise",
        chosen_by="definition",
    )
    noise_reached: float = ratio(
        1.05, "Error up to which one is noise alone where hypotheses are compared.", unit=NOISE_MULTIPLE
    )
    above_noise: float = ratio(1.3, "Error from which one is more than noise.", unit=NOISE_MULTIPLE)
    far_above_noise: float = ratio(
        3.0, "Error far above the noise: laws that leave so much are not the whole story.", unit=NOISE_MULTIPLE
    )
    far_above_disturbances: float = ratio(
        10.0,
        "Error from which something is missing though no law, curve or response explains it and it is not correlated with past inputs. "
        "What is less may be a disturbance that nobody measured.",
        unit=NOISE_MULTIPLE,
        chosen_by="what was missing and could not be named left 36 times the noise and more; complete machines with disturbances 3 to 8",
    )
    most_error_elsewhere: float = ratio(
        3.0,
        "Error of the other experiments up to which it is the one that a search without result has looked at.",
        unit="times the error of the experiments to choose with",
        chosen_by="convention",
    )
    between_samples: float = share(
        1e-3,
        "Part of the squared error of the model as it stands that may be between samples that a search passes over.",
        unit="share of the squared error",
        chosen_by="far below the share of a mismatch that is a finding",
    )
    negligible_error: float = number(
        1e-5,
        "Error below which nothing matters.",
        unit="share of the outputs' spread",
        chosen_by="rounding and interpolation",
    )


@dataclass(frozen=True, kw_only=True)
class ScreenSettings:
    """What the screen passes on."""

    least_screen_share: float = share(
        0.008,
        "Share of the residual that a candidate has to explain to be refitted.",
        unit="share of the residual's energy",
    )
    chance_from_motion: float = number(
        0.01,
        "Probability up to which some law may seem to be in the measured motion by chance, all looks at it together.",
        unit="probability",
        chosen_by="convention",
        least=1e-12,
        most=0.5,
    )
    least_left_of_motion: float = share(
        0.01,
        "Error of the equations along the measured motion from which laws are looked for in it: below, simulated windows are right.",
        unit="share of the measured rates (root mean square)",
    )
    completing_promise: float = share(
        0.5,
        "Part of what has to go before noise alone is left that a candidate has to promise for its refits, where so little of the mismatch "
        "is left that only what completes the model is taken.",
        unit="share of what has to go",
        chosen_by="48 cases: what completed a model promised all of it, or nearly (0.94)",
    )
    screen_tie: float = share(
        0.97, "Share of the best candidate's from which another ties with it.", unit="share of what the best explains"
    )
    bent_travel: float = ratio(
        3.0,
        "How many times as far as with the card's values the fitted model has to move a signal for its fit to count as distorted: then the "
        "screen looks around the card's values, too.",
        unit="ratio of the largest magnitudes",
        chosen_by="start values of a card are right within tens of per cent",
    )
    bent_parameter: float = ratio(
        30.0,
        "How many times what it began as (or what part of it) a fitted parameter has to be for the fit to count as distorted.",
        unit="ratio to the card's value",
        chosen_by="start values of a card are right within a factor of ten",
    )
    unbent_share: float = share(
        0.9, "Share of a distorted fit's gain from which an undistorted one is preferred.", unit="share of the gain"
    )
    least_periods: float = number(
        5.0, "Periods within the travel from which an effect is seen to repeat.", unit="periods"
    )
    least_ripple_order: float = number(
        1.2,
        "Order below which a force periodic in an angle is gravity's.",
        unit="periods per turn",
        chosen_by="gravity repeats once per turn",
    )
    orders_differ: float = share(0.05, "Relative difference from which two orders are two.", unit="relative difference")


@dataclass(frozen=True, kw_only=True)
class SelectionSettings:
    """What an effect has to bring to be taken."""

    least_gain: float = share(0.01, "Improvement below which nothing is claimed.", unit=GAIN)
    least_gain_far_above_noise: float = share(
        0.05,
        "The same where much more than noise is left, or nobody knows how much is noise: some law always helps a little.",
        unit=GAIN,
    )
    least_of_richer_form: float = share(
        0.67,
        "What a richer form has to remove of the squared error that the plain law leaves to replace it: over windows of all lengths, or "
        "beyond the noise over those where the plain law leaves most.",
        unit="share of the squared error over windows",
    )
    least_significance: float = number(
        3.0, "By how much, over windows, an effect must improve the prediction.", unit=SIGMA, chosen_by="convention"
    )
    least_gain_by_likelihood: float = share(
        0.05,
        "Improvement from which whole records are asked about a law that leaves white noise alone, where windows are too few.",
        unit=GAIN,
        chosen_by="complete models, on which the best of all laws gained up to 0.023",
    )
    least_likelihood_significance: float = number(
        10.0,
        "By how much that likelihood, errors coloured, must then speak for it.",
        unit=SIGMA,
        chosen_by="40 complete models (up to 9.1, of all laws looked at), effects that windows missed (11 to 20)",
    )
    same_share: float = share(
        1e-5,
        "Share of the mismatch by which two laws have to differ for the one with more parameters to be preferred.",
        unit="share of the mismatch",
        chosen_by="a motor's gain told as gravity (an overwhelming effect: their difference is 2e-7 of it)",
    )
    named_share: float = share(
        0.85,
        "Share of a free curve's gain from which named effects stand for it: no friction is exactly the law of a book.",
        unit="share of the curve's gain",
    )
    first_name_share: float = share(
        0.1,
        "Share of a free curve's gain that the best name must bring for others to be looked for beside it: of several laws that one curve "
        "stands for, one alone removes a part that shows.",
        unit="share of the curve's gain",
        chosen_by="a third of the error where a curve leaves a thirtieth",
    )
    most_names_for_curve: int = count(
        2,
        "Named effects that may stand for a free curve: at its port more of them are pieces of it, elsewhere they have to come farther.",
        chosen_by="a slack spring told as gravity, a stop, a bias and a ripple",
    )
    passed_over_share: float = share(
        0.5,
        "Share of the residual over the shortest windows from which what explains it is followed whatever longer ones say.",
        unit="share of the residual's energy",
    )
    passed_over_ratio: float = share(
        0.5,
        "Share of what it explains there that what was taken explains at most.",
        unit="share of what the best explains",
    )
    passed_over_simpler: float = share(
        0.9, "Share from which a law that it contains is followed instead.", unit="share of what the best explains"
    )
    beyond_doubt: float = share(
        0.95, "Probability from which an effect is not chosen once more beside later ones.", unit="probability"
    )
    lost_amplitude: float = share(
        0.1,
        "Share of what it was to which one of an effect's amplitudes has gone beside later effects for it to be chosen once more.",
        unit="share of the amplitude when it was taken",
    )
