"""Laws at one actuator stand one behind the other, and their order matters where one of them is not linear.

A limit before a lag is not a limit behind it. The order in which they are found says nothing about that, so a law that comes to others at
its actuator is tried behind them and before them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from greybox_torch.diagnosis.screen.shortlist import Candidate
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.model.ports import Actuator


def in_both_orders(study: Study, effects: Sequence[Attachment], found: Sequence[Candidate]) -> list[Candidate]:
    """``found``, and those once more that may stand before ``effects`` at the same actuator."""
    actuators = {p.name for p in study.problem.model.all_ports if isinstance(p, Actuator)}
    before = (k for k in found if k.attachment.port in actuators and _order_matters(k, effects))
    return [*found, *(replace(k, ahead=True) for k in before)]


def _order_matters(candidate: Candidate, effects: Sequence[Attachment]) -> bool:
    """Not where all are linear, and not for a dead time, which comes first anyway; free curves are left where they are."""
    law = candidate.attachment
    others = [e for e in effects if e.port == law.port and "delayed" not in e.mechanism.needs]
    if candidate.unknown or "delayed" in law.mechanism.needs or not others:
        return False
    return not all(e.mechanism.linear for e in (law, *others))


def joined(effects: Sequence[Attachment], candidate: Candidate) -> tuple[Attachment, ...]:
    """The effects with that of a candidate, behind them or before those at its actuator."""
    law = candidate.attachment
    there = [k for k, e in enumerate(effects) if e.port == law.port]
    place = there[0] if candidate.ahead and there else len(effects)
    return (*effects[:place], law, *effects[place:])
