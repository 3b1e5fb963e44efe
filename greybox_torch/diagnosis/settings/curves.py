"""Thresholds of free curves: when they are looked for, how fine they are, and when they stand before a name."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.choosing import GAIN, LOG_ERROR
from greybox_torch.diagnosis.settings.fields import SIGMA, number, ratio, share


@dataclass(frozen=True, kw_only=True)
class CurveSettings:
    """When a free curve is asked for, and what it has to be worth."""

    screen_complete: float = share(
        0.9,
        "Share that the best of a screen explains from which no curve of many knots is looked for along the way.",
        unit="share of the residual's energy",
    )
    left_by_narrow: float = share(
        0.5,
        "Part of what a curve of few knots leaves in the screen that one of many may leave to go in its place.",
        unit="share of the residual's energy",
    )
    least_screen_share_of_fine_curve: float = share(
        0.3,
        "Share of the residual that a fine curve has to explain in the screen beside named effects: forty knots always take up something.",
        unit="share of the residual's energy",
    )
    least_screen_share_beside_curve: float = share(
        0.1, "The same for an effect beside a free curve, where refits are slow.", unit="share of the residual's energy"
    )
    curve_promise: float = share(
        0.5,
        "Part of what a free curve has to remove that it must promise in the screen to be refitted.",
        unit="share of least_curve_share",
    )
    least_curve_share: float = share(
        0.02, "Part of the plain model's error that a free curve has to remove at some window length.", unit=GAIN
    )
    least_share_near_noise: float = share(
        0.5,
        "The same where the model as it stands leaves hardly more than noise (less than `far_above_noise`): of what is left then, a curve "
        "draws some part whatever it is.",
        unit=GAIN,
        chosen_by="proofs and unseen cases: curves that were right removed 0.64 and more, those told of complete machines 0.13 to 0.25",
    )
    least_law_share_near_noise: float = share(
        0.2,
        "The same for a law, where the recordings do not tell how much of what is left is noise.",
        unit=GAIN,
        chosen_by="a screw drive whose Stribeck friction removes 0.26; of complete machines laws removed up to 0.1",
    )
    least_share_beside_curve: float = share(
        0.67,
        "Part of what a free curve leaves beyond noise that an effect beside it has to remove, unless it leaves hardly more than noise: a "
        "curve is never exactly the machine's, and some law compensates for what it lacks.",
        unit="share of the mismatch that the curve leaves",
        chosen_by="as `least_of_richer_form`",
    )
    least_curve_share_beside_names: float = share(
        0.05,
        "The same beside named effects, whose laws are never exactly the machine's.",
        unit=GAIN,
        chosen_by="cases simulated elsewhere: effects begin at 0.05",
    )
    curve_margin: float = number(
        0.1, "How much better a free curve must be than every name to be preferred.", unit=LOG_ERROR
    )
    curve_gain_ratio: float = ratio(
        1.5, "How many times the gain of the best name a free curve must gain to be preferred.", unit="times the gain"
    )
    beyond_its_range: float = share(
        0.2,
        "How far a curve's signal has to move, with what was found, beyond where the model as it stands moved it for a search over the "
        "wider range.",
        unit="share of the range that the curve is drawn over",
        chosen_by="a curve has a bump beyond either end: what is nearer it follows",
    )
    widest_dry_friction: float = share(
        0.07,
        "Width of the change of sign from which friction grows with speed, and is not dry: a curve says what it is.",
        unit="share of the fastest speed",
        chosen_by="254 laws of dry friction in six proofs and on unseen machines: none was surely wider but two, of eddy-current brakes",
    )
    surely_wide: float = number(
        2.0,
        "Standard deviations by which a width has to be larger than that.",
        unit=SIGMA,
        least=0.0,
        chosen_by="two-sided chance of 5 %",
    )
