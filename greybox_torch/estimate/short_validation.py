"""Whether the validation experiments last long enough to judge a model by, beside those of estimation and the times of the machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from greybox_torch.data import DataSet

SMALL = 0.02
"""Share of the time of the estimation experiments below which validation experiments are told to be short, whatever the machine."""

OF_A_TIME_CONSTANT = 0.5
"""Of a time constant below which an experiment shows hardly more than its beginning."""

OF_A_DELAY = 10.0
"""Times a delay below which much of an experiment is what began before it."""

SHOWN = 4.0
"""Times as long as that has to be what the estimation experiments have: what they do not show either is no fault of validation."""


def short_validation(
    data: DataSet,
    constant: float | None = None,
    delays: Mapping[str, float] | None = None,
    constants: Mapping[str, float] | None = None,
) -> str | None:
    """A sentence without its full stop where the validation experiments are too short to judge by; else None.

    Args:
        constant: the slowest time constant of the model, in s, where it is known.
        delays: dead times of the machine, in s, by what a reader calls them.
        constants: further time constants, of lags and memories, in s, likewise.
    """
    validation, estimation = ([r.seconds for r in own] for own in (data.validation(), data.estimation()))
    if not validation or not estimation or data.held_out_by_default:
        return None
    share = [f"{_shown(sum(estimation))} of estimation"] if sum(validation) < SMALL * sum(estimation) else []
    told = (
        {} if constant is None else {f"a slowest time constant of {_shown(constant)} by the model's values": constant}
    )
    told |= {f"{name} of {_shown(time)}": time for name, time in (constants or {}).items()}
    least = {what: OF_A_TIME_CONSTANT * time for what, time in told.items()}
    least |= {f"{name} of {_shown(time)}": OF_A_DELAY * time for name, time in (delays or {}).items()}
    times = [what for what, time in least.items() if max(validation) < time <= max(estimation) / SHOWN]
    if len(validation) == 1:
        parts = [_short(f"the validation experiment lasts {_shown(validation[0])}", [*share, *times])]
    else:
        parts = [
            _short(f"the validation experiments last {_shown(sum(validation))} together", share),
            _short(f"the longest validation experiment lasts {_shown(max(validation))}", times),
        ]
    sentence = "; ".join(part for part in parts if part)
    return f"{sentence}: hardly more than its beginning is judged" if times else sentence or None


def _short(lasts: str, beside: Sequence[str]) -> str:
    return f"{lasts}, which is short beside {' and '.join(beside)}" if beside else ""


def _shown(time: float) -> str:
    return f"{time:.0f} s" if time >= 1000.0 else f"{time:.3g} s"
