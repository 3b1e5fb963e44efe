"""Whether the fitted parameters of an effect say anything about the machine."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.noise import floor_known
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.window_information import window_information
from greybox_torch.linear_algebra import solve
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.sign_change import WIDTH


def degenerate(
    effect: Attachment,
    surroundings: Mapping[str, Surroundings],
    values: Mapping[str, float],
    deviations: Mapping[str, float] | None = None,
) -> str | None:
    """A clause that says why a law with these parameters is none of the machine's; None where there is nothing to object to.

    Args:
        values: parameters by their full names.
        deviations: their standard deviations, where those are known.
    """
    # What is not determined by itself (a phase beside a start angle) may be so together with others.
    finite = {n: d for n, d in (deviations or {}).items() if np.isfinite(d)}
    return effect.mechanism.degenerate(surroundings[effect.port], effect.own(values), effect.own(finite))


def grows_with_speed(
    fitted: Hypothesis, effect: Attachment, surroundings: Mapping[str, Surroundings], settings: DiagnosisSettings
) -> bool:
    """Whether dry friction, as it is fitted over windows, surely changes its sign over so many speeds that it is none.

    A width that the recordings hardly determine, as they pass through rest within a sample or two, says nothing; nor does one with which
    noise alone is left. Seen: three eddy-current brakes, whose force rises up to a speed and falls beyond it, told as Coulomb friction.
    """
    name, values = f"{effect.prefix}.{WIDTH}", fitted.values()
    free = fitted.problem.free_names
    if not effect.mechanism.rubs or name not in free:
        return False
    wide = settings.widest_dry_friction * surroundings[effect.port].ranges["speed"].reach
    if values[name] < wide or _noise_alone(fitted, settings):
        return False
    longest, at = fitted.fits[-1], free.index(name)
    known = window_information(longest, fitted.simulator)
    if known is None:
        return False
    own = np.eye(len(free))[at]
    variance = longest.mean_square * float(own @ solve(known, own))
    return bool(values[name] - settings.surely_wide * np.sqrt(max(variance, 0.0)) >= wide)


def _noise_alone(fitted: Hypothesis, settings: DiagnosisSettings) -> bool:
    """Whether hardly more than noise is left, where the recordings tell how much of it there is and not only how much at most."""
    problem = fitted.problem
    return floor_known(problem, settings) and times_noise(problem, fitted, settings) < settings.above_noise
