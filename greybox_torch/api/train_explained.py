"""What a trained network stands for: as JSON and on the console."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.text import Text

from greybox_torch.api.fit_json import parameters_json
from greybox_torch.api.scores import Scores
from greybox_torch.api.train_advice import explained_sentence
from greybox_torch.api.train_held_out import mostly_lost
from greybox_torch.mechanisms.matching import LEAST_MATCH, Match
from greybox_torch.name_lists import listed
from greybox_torch.report.tables import print_table
from greybox_torch.training import Explanation, Trained
from greybox_torch.training.learned_force import SignalCurve
from greybox_torch.training.named_term import NamedTerm

MOST_OF_IT = 0.5
"""Share of what was visited over which the band contains zero from which that is told."""


def explanation_json(found: Trained, explained: Explanation, scores: Scores) -> dict[str, Any]:
    """Curves with their band, shares per signal, every law compared, the laws put in the network's place, and the recommendation."""
    force_unit = found.hybrid.surroundings[found.hybrid.network.port].force_unit
    result: dict[str, Any] = {
        "sentence": explained_sentence(explained, scores, judged=not mostly_lost(found)),
        "drop_network": explained.term is not None,
        "band": band(explained),
        "members": explained.members,
        "curves": [_curve_json(curve, force_unit) for curve in explained.curves],
        "beside": list(explained.own),
        "matches": [{"mechanism": m.law.name, "share": m.share, "parameters": m.values} for m in explained.matches],
        "terms": [_term_json(term) for term in explained.terms],
        **({"failed": list(explained.failed)} if explained.failed else {}),
    }
    if explained.term is not None and explained.result is not None:
        start = f"{explained.term.attachment.prefix}."
        own = {n: entry for n, entry in parameters_json(explained.result).items() if n.startswith(start)}
        result["term"] = {**_term_json(explained.term), "parameters": own, "mse": explained.result.mse}
    return result


def band(explained: Explanation) -> str:
    """What the band is from, in words."""
    own = "covariance of the parameters, the larger of the plain and the sandwich one, the penalty counted as knowledge"
    return own if explained.members < 2 else f"{own}; and the differences of {explained.members} seeds"


def print_explanation(
    console: Console, explained: Explanation, scores: Scores, *, adds: str = "force", judged: bool = True
) -> None:
    """The recommendation, which signals count, and the laws compared; ``adds`` is what the network does, in words."""
    console.print(Text(f"\n{explained_sentence(explained, scores, judged=judged)}", style="bold"), soft_wrap=True)
    if not explained.curves:
        return
    shares = ", ".join(f"{curve.told} {100 * curve.share:.0f} %" for curve in explained.curves)
    console.print(Text(f"Share of the learned {adds} that each signal alone explains: {shares}"), soft_wrap=True)
    if told := open_sign(explained.curves):
        console.print(Text(told), soft_wrap=True)
    rows = [_row(term) for term in explained.terms]
    refitted = {term.attachment.mechanism.name for term in explained.terms}
    others = [m for m in explained.matches if m.law.name not in refitted][:3]
    rows += [
        [
            m.law.name,
            f"{100 * max(m.share, 0.0):.0f} %",
            "",
            _not_refitted(m, explained),
        ]
        for m in others
    ]
    if rows:
        print_table(
            console,
            ["law in the\nnetwork's place", "of the curve\nmatched", "held-out error beside\nthe network's", ""],
            rows,
        )
        if explained.own:
            console.print(Text(matched_beside(explained.own, adds)), soft_wrap=True)


def matched_beside(own: Sequence[str], adds: str) -> str:
    """What laws are matched with, where parameters of the model act where the network does."""
    one = len(own) == 1
    return (
        f"The match is with the part of the curve that no other value of {listed(own)} can explain: "
        f"{'it acts' if one else 'they act'} as a {adds} there as well. "
        f"With a law in the network's place {'it is' if one else 'they are'} estimated anew."
    )


def _not_refitted(match: Match, explained: Explanation) -> str:
    """Why a law has no held-out error."""
    if not explained.refitted:
        return ""
    if match.law.name in explained.failed:
        return "tried in its place: the simulation overflows"
    why = f"it matches less than {100 * LEAST_MATCH:.0f} %" if match.share <= LEAST_MATCH else "others match more"
    return f"not tried in its place: {why}"


def open_sign(curves: Sequence[SignalCurve]) -> str:
    """A sentence where the band contains zero over most of what was visited; "" where none does."""
    wide = [f"{curve.told} {100 * curve.zero_within:.0f} %" for curve in curves if curve.zero_within > MOST_OF_IT]
    if not wide:
        return ""
    return (
        f"The curve's band of two deviations contains zero over most of what was visited ({', '.join(wide)}): not even its sign is known "
        "there, however much better the network predicts."
    )


def _row(term: NamedTerm) -> list[str]:
    matched = "" if term.match is None else f"{100 * term.match:.0f} %"
    units = term.attachment.own({p.name: p.unit for p in term.problem.model.declared_parameters})
    values = ", ".join(_value(name, value, units[name], term.bounds_reached) for name, value in term.parameters.items())
    told = f"no longer this law, as it was estimated with {term.absent}: {values}" if term.absent else values
    return [term.attachment.mechanism.name, matched, _beside(term.lost), told]


def _value(name: str, value: float, unit: str, bounds: Mapping[str, float]) -> str:
    """A parameter as a table tells it, and whether it is at a bound, which 4e-13 means where it is zero."""
    told = f"{name} {bounds.get(name, value):.4g} {unit}".rstrip()
    return f"{told} (at its bound)" if name in bounds else told


def _beside(lost: float) -> str:
    """A mean squared error that is a share ``lost`` more than the network's: in percent up to twice as much, beyond that as a multiple."""
    if not math.isfinite(lost):
        return "diverges"
    return f"{1.0 + lost:.3g} times" if lost >= 1.0 else f"{100 * lost:+.1f} %"


def _curve_json(curve: SignalCurve, force_unit: str) -> dict[str, Any]:
    return {
        "signal": curve.signal,
        "unit": curve.unit,
        "share": curve.share,
        "zero_within": curve.zero_within,
        "values": curve.values.tolist(),
        "force": curve.force.tolist(),
        "std": curve.deviation.tolist(),
        "force_unit": force_unit,
    }


def _term_json(term: NamedTerm) -> dict[str, Any]:
    return {
        "port": term.attachment.port,
        "mechanism": term.attachment.mechanism.name,
        "match": term.match,
        "held_out": term.held_out,
        "lost": term.lost,
        "parameters": term.parameters,
        **({"absent": term.absent} if term.absent else {}),
    }
