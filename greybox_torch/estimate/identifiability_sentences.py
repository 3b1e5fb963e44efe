"""What the data do not determine, said so that one knows what to do about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.name_lists import brief, listed

MOST_CHANGES = 4
"""Changes that a sentence spells out, the first ones."""

SUGGESTION = "fix one of them, or measure it by other means"


@dataclass(frozen=True)
class Direction:
    """A change of some unknowns: ``changes``, relative to the value where ``relative``, else in the unknown's unit, the largest being 1.

    ``law`` says how far it holds: "factor", where multiplying them by powers of one factor changes nothing; "shift", where adding multiples
    of ``absolute`` (the changes in the unknowns' units, the largest 1) changes nothing; "local", where only small changes do so.
    """

    names: tuple[str, ...]
    changes: tuple[float, ...]
    relative: tuple[bool, ...]
    law: str = "local"
    absolute: tuple[float, ...] = ()


def sentence(kind: str, step: Direction, *, zeros: Sequence[str] = (), deviation: float = np.nan) -> str:
    """One sentence or two on a finding of this kind, see :class:`greybox_torch.estimate.identifiability.Unidentifiable`.

    Args:
        zeros: the parameters whose being zero takes the others' effect away.
        deviation: standard deviation along the direction of a weak one, relative to the values.
    """
    names = brief(step.names)
    if kind == "unmoved":
        return f"{names}: nothing in these recordings depends on it; fix it, or record an experiment in which it acts"
    if kind == "start":
        return _start(step, zeros)
    if kind == "weak":
        return _weak(step, deviation)
    if step.law == "factor":
        return f"{names}: {_of_factors(step)}; {SUGGESTION}"
    if step.law == "shift" and len(step.names) == 2 and np.allclose(np.abs(step.absolute), 1.0, rtol=1e-3):
        what = "sum" if step.absolute[0] * step.absolute[1] < 0 else "difference"
        other = "lowering" if what == "sum" else "raising"
        first, second = step.names
        return f"{names}: only their {what} is determined (raising {first} and {other} {second} by as much changes nothing); {SUGGESTION}"
    near = "" if step.law == "shift" else " as long as the changes are small"
    return f"{names}: cannot be told apart ({_moved(step, 1.0)} changes nothing{near}); {SUGGESTION}"


def _of_factors(step: Direction) -> str:
    powers = np.array(step.changes)
    up, down = ([n for n, p in zip(step.names, powers, strict=True) if s * p > 0] for s in (1, -1))
    if np.allclose(np.abs(powers), 1.0, rtol=1e-3):
        if not up or not down:
            what = "ratio is" if len(step.names) == 2 else "ratios are"
            both = "both" if len(step.names) == 2 else "all"
            return f"only their {what} determined (raising {both} by the same factor changes nothing)"
        what = "product is" if len(step.names) == 2 else "products and ratios are"
        change = f"raising {listed(up)} and lowering {listed(down)} by the same factor changes nothing"
        return f"only their {what} determined ({change})"
    whole = powers / np.abs(powers).min()
    if np.allclose(whole, np.round(whole), rtol=1e-3):
        terms = [f"{n} by {_power(round(w))}" for n, w in zip(step.names, whole, strict=True)]
        return f"only products of their powers are determined (multiplying {listed(terms)} changes nothing)"
    return f"only products of their powers are determined ({_moved(step, 1.0)} changes nothing)"


def _power(exponent: int) -> str:
    power = "c" if abs(exponent) == 1 else f"c^{abs(exponent)}"
    return power if exponent > 0 else f"1/{power}"


def _moved(step: Direction, percent: float) -> str:
    """'raising a by 1 % and lowering b by 0.5 %'."""
    order = [*[i for i, c in enumerate(step.changes) if c > 0], *[i for i, c in enumerate(step.changes) if c < 0]]
    terms, before = [], 0
    for i in order:
        change, sign = step.changes[i], 1 if step.changes[i] > 0 else -1
        verb = "" if sign == before else ("raising " if sign > 0 else "lowering ")
        size = f"{abs(change) * percent:.3g} %" if step.relative[i] else f"{abs(change) * percent / 100:.3g}"
        terms.append(f"{verb}{step.names[i]} by {size}")
        before = sign
    if len(terms) > MOST_CHANGES:
        return f"{', '.join(terms[:MOST_CHANGES])} and the others to match"
    return listed(terms)


def _start(step: Direction, zeros: Sequence[str]) -> str:
    while_zero = f" while {listed(zeros)} {'is' if len(zeros) == 1 else 'are'} zero" if zeros else ""
    if len(step.names) == 1:
        what = f"{step.names[0]}: has no effect at these values{while_zero}, but it has elsewhere"
    else:
        what = f"{brief(step.names)}: cannot be told apart at these values{while_zero}, but they can elsewhere"
    return f"{what}; an estimate is possible, and other start values may help it"


def _weak(step: Direction, deviation: float) -> str:
    if len(step.names) == 1:
        what = f"weakly determined, its standard deviation is about {deviation:.2g} times its value"
        return f"{step.names[0]}: {what}; fix it, or record an experiment in which it acts more"
    change = _moved(step, 100.0)
    return f"{brief(step.names)}: hardly told apart ({change} shows no more than the errors do); {SUGGESTION}"
