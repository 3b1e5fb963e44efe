"""How large an error is beside the noise, in words."""

from __future__ import annotations

from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.hypothesis.above_noise import times_noise
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.mismatch import mismatch_share, negligible
from greybox_torch.diagnosis.hypothesis.noise import floor_known
from greybox_torch.diagnosis.study import Study
from greybox_torch.diagnosis.without_effects import NOISE_SHOWN


def beside_noise(study: Study, fitted: Hypothesis) -> str:
    """The error of a hypothesis in units of the noise, and where the noise is not known that what shows is the most that it can be."""
    times = times_noise(study.problem, fitted, study.settings)
    return told_beside_noise(
        times, more=times > study.settings.above_noise, known=floor_known(study.problem, study.settings)
    )


def told_beside_noise(times: float, *, more: bool, known: bool) -> str:
    """An error of so many times the noise in words, where that is ``more`` than noise alone, and where the noise is ``known``."""
    over = (
        f"Over short windows (of the lengths tried, the one with the largest error), the error is {digits(times)} times"
    )
    if not more and not known:
        return (
            f"{over} what the recordings show at their highest frequencies. Part of that is motion: the noise is smaller, and how much "
            "smaller is not known."
        )
    return f"{over} the noise {NOISE_SHOWN}{': more than noise is left' if more else ''}."


def why_negligible(study: Study, plain: Hypothesis) -> list[str]:
    """Why nothing was looked for."""
    if not negligible(study, plain):
        return []
    return [
        f"Beyond the noise it is {digits(100 * mismatch_share(plain, study.settings))} % of the outputs' spread. A shift in time by "
        f"{100 * study.settings.least_shift:.2g} % of a sampling interval, or another simulator of the same model, may do as much: "
        "nothing was looked for."
    ]
