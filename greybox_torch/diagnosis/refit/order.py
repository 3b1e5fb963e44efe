"""Laws at one actuator stand one behind the other, and their order matters where one of them is not linear.

A limit before a lag is not a limit behind it. The order in which they are found says nothing about that, so a law that comes to others at
its actuator is tried behind all of them and before all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.screen.shortlist import Candidate, identity_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.model.ports import Actuator
from greybox_torch.simulation.simulator import Simulator

Trial = tuple[float, Candidate, Hypothesis, Simulator]
"""How far a candidate's trial comes (less is better), the candidate, the trial, and the simulator that it was made with."""


def in_both_orders(study: Study, effects: Sequence[Attachment], found: Sequence[Candidate]) -> list[Candidate]:
    """``found``, and those once more that may stand before ``effects`` at the same actuator."""
    actuators = {p.name for p in study.problem.model.all_ports if isinstance(p, Actuator)}
    before = (k for k in found if k.attachment.port in actuators and _order_matters(k, effects))
    return [*found, *(replace(k, ahead=True) for k in before)]


def _order_matters(candidate: Candidate, effects: Sequence[Attachment]) -> bool:
    """Not where all are linear or constant, and not for a dead time, which comes first anyway; free curves are left where they are."""
    law = candidate.attachment
    others = [e for e in effects if e.port == law.port and "delayed" not in e.mechanism.needs]
    if candidate.unknown or "delayed" in law.mechanism.needs or not others:
        return False
    return not all(e.mechanism.linear or not e.mechanism.needs for e in (law, *others))


def in_better_order(trials: Sequence[Trial]) -> list[Trial]:
    """The trials, best first; of a law in two orders the better one."""
    best: dict[tuple, Trial] = {}
    for trial in sorted(trials, key=lambda entry: entry[0]):
        best.setdefault(identity_of(trial[1].attachment), trial)
    return list(best.values())


def where_it_stood(
    effects: Sequence[Attachment], effect: Attachment, once: Sequence[Attachment]
) -> tuple[Attachment, ...]:
    """The effects with one that was among ``once``: before those that it stood before."""
    places = {e.prefix: k for k, e in enumerate(once)}
    own = places.get(effect.prefix, len(places))
    behind = {prefix for prefix, k in places.items() if k > own}
    place = next((k for k, e in enumerate(effects) if e.prefix in behind), len(effects))
    return (*effects[:place], effect, *effects[place:])


def joined(effects: Sequence[Attachment], candidate: Candidate) -> tuple[Attachment, ...]:
    """The effects with that of a candidate, behind them or before those at its actuator."""
    law = candidate.attachment
    there = [k for k, e in enumerate(effects) if e.port == law.port]
    place = there[0] if candidate.ahead and there else len(effects)
    return (*effects[:place], law, *effects[place:])
