"""What was found: one card an effect."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from markupsafe import Markup

from greybox_torch.diagnosis.effect import Effect, Profile, Timeline
from greybox_torch.diagnosis.equation_lines import in_lines
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report import text
from greybox_torch.report.chart.marks import bars
from greybox_torch.report.chart.panel import Chart, Panel, side_by_side
from greybox_torch.report.chart.scale import Scale, linear
from greybox_torch.report.sections.frequency import Responses, responses
from greybox_torch.report.sections.law import law_chart
from greybox_torch.report.sections.memory import memory_chart
from greybox_torch.report.time_axis import time_unit

MOST_EXPERIMENTS = 4
"""Experiments of which is drawn where along them an effect acts; with more, those in which it is strongest."""

OF_A_CURVE = "of what the best free curve in the law's place improves; with nearly 100 % no other form of law does much better there"
"""What the share of a free curve's gain that a law reaches says, in words."""


@dataclass(frozen=True)
class ParameterRow:
    symbol: Markup
    description: str
    value: str
    unit: str


@dataclass(frozen=True)
class Share:
    """A hypothesis and its probability. ``together``: the recordings do not tell it from the chosen one; ``rest`` is left over for all
    hypotheses that are not listed. ``value``: of its law's first parameter, where that is told.
    """

    mechanism: str
    port: str
    probability: float
    chosen: bool = False
    together: bool = False
    rest: bool = False
    value: str = ""


@dataclass(frozen=True)
class Card:
    """An effect as its card shows it; ``statement`` where it stands for several that cannot be told apart, with their ``probability``
    and a sentence (``alike``). ``explained``: the share of the mismatch that free runs of the validation experiments leave no more; empty
    beside further effects and refinements, with which it is shared, and where free runs say nothing of it. ``bounded`` and ``remarks``:
    what is to be known of its parameters, in sentences without the last full stop.
    """

    title: str
    port: str
    statement: str
    alike: str
    probability: float
    explanation: str
    where: str
    signals: tuple[str, ...]
    equation: str
    size: str
    explained: str
    ceiling: str
    parameters: tuple[ParameterRow, ...]
    bounded: str
    remarks: str
    shares: tuple[Share, ...]
    one_effect: str
    experiment: str
    source: str
    unknown: bool
    curves: tuple[Chart, ...]
    responses: Responses | None
    profiles: Chart | None
    timelines: Chart | None
    of_a_curve: ClassVar[str] = OF_A_CURVE

    @property
    def experiment_tells(self) -> str:
        """What the experiment is good for, in words."""
        if not self.shares:
            return "What would show it best"
        return f"What would tell {'the others' if self.one_effect else 'them'} apart"


@dataclass(frozen=True)
class Effects:
    """The cards of all effects."""

    cards: tuple[Card, ...]
    about_sizes: tuple[str, ...] = ()
    template: str = "effects.html.j2"

    @classmethod
    def of(cls, verdict: Verdict) -> Effects | None:
        cards = (_card(e, responses(verdict, e), _explained(verdict)) for e in verdict.shown_effects)
        return cls(tuple(cards), verdict.about_sizes) if verdict.effects else None


def _explained(verdict: Verdict) -> str:
    """What the only effect explains of the mismatch in free runs: the rest of what remains (section "What remains")."""
    left, alone = verdict.left, len(verdict.effects) + len(verdict.refinements) == 1
    if left is None or not alone or not left.share < 1.0 or verdict.of_no_use or verdict.effects[0].made_up_for:
        return ""
    return text.percent(1.0 - left.share)


def _card(effect: Effect, shown: Responses | None, explained: str) -> Card:
    unknown, whole = effect.mechanism == "unknown", effect.one_of
    return Card(
        title=_unknown_title(effect) if unknown else text.first_capital(text.mechanism(effect.mechanism)),
        port=effect.port,
        statement="" if whole is None else text.first_capital(whole.statement),
        alike="" if whole is None else whole.in_brief,
        probability=effect.probability if whole is None else whole.probability,
        explanation=effect.explanation,
        where=effect.where,
        signals=effect.signals,
        equation=in_lines(effect.equation),
        size=text.percent(effect.size) if math.isfinite(effect.size) else "",
        explained=explained,
        ceiling="" if effect.ceiling is None else text.percent(effect.ceiling),
        parameters=_parameters(effect),
        bounded=effect.bounded,
        remarks=_remarks(effect),
        shares=_shares(effect),
        one_effect="" if whole is None or not whole.one_effect else text.first_capital(whole.told_one_effect),
        experiment=effect.separating_experiment if whole is None or whole.separable else "",
        source=effect.source,
        unknown=unknown,
        curves=_own_charts(effect),
        responses=shown,
        profiles=_profiles(effect),
        timelines=_timelines(effect),
    )


def _remarks(effect: Effect) -> str:
    """What is to be known of its parameters and its equation; a list of parameters keeps their names as they are."""
    own = effect.undetermined
    of_names = own.partition(":")[0].partition(",")[0] in effect.parameters
    others = map(text.first_capital, (effect.of_line, effect.shared, effect.like))
    return ". ".join(filter(None, (own if of_names else text.first_capital(own), *others)))


def _unknown_title(effect: Effect) -> str:
    return "An unknown effect" if effect.memory is None else "An unknown effect with memory"


def _own_charts(effect: Effect) -> tuple[Chart, ...]:
    """The effect's curve (of a linear response it is a straight line, and left out), and its response where it remembers."""
    memory = effect.memory
    curve = () if effect.curve is None or (memory and not memory.curved) else (law_chart(effect, effect.curve),)
    return curve if memory is None else (*curve, memory_chart(effect, memory))


def _parameters(effect: Effect) -> tuple[ParameterRow, ...]:
    rows = []
    for name, entry in effect.shown_parameters.items():
        value, deviation = entry.get("value"), entry.get("std")
        shown = text.measured(
            math.nan if value is None else float(value), None if deviation is None else float(deviation)
        )
        meaning, unit = entry.get("description", ""), text.unit(entry.get("unit", ""))
        rows.append(ParameterRow(text.symbol(name), meaning, shown, unit))
        if size := effect.amplitudes.get(name):
            rows.append(ParameterRow(text.symbol("amplitude"), "of both together", text.measured(*size), unit))
        if pitch := effect.pitch(name):
            told = "travel in which it repeats, 2 pi over the order"
            rows.append(ParameterRow(text.symbol("pitch"), told, text.measured(*pitch[:2]), text.unit(pitch[2])))
    return tuple(rows)


def _shares(effect: Effect) -> tuple[Share, ...]:
    """The chosen hypothesis, its rivals, and what probability is left for all others."""
    members = () if effect.one_of is None else effect.one_of.members
    inside = {(m.port, m.mechanism) for m in members}
    rivals = {(a.port, a.mechanism): a for a in (*members, *effect.alternatives)}
    own = rivals.pop((effect.port, effect.mechanism), None)
    if not rivals:
        return ()
    value = "" if own is None else own.told_value
    listed = [Share(text.mechanism(effect.mechanism), effect.port, effect.probability, chosen=True, value=value)]
    listed += [
        Share(text.mechanism(a.mechanism), a.port, a.probability, together=place in inside, value=a.told_value)
        for place, a in sorted(rivals.items(), key=lambda item: -item[1].probability)
    ]
    left = 1.0 - sum(share.probability for share in listed)
    return (*listed, Share("anything else", "", left, rest=True)) if left > 0.005 else tuple(listed)


def _profiles(effect: Effect) -> Chart | None:
    if not effect.profiles:
        return None
    caption = "Where the gain lies: how the error energy that the effect explains spreads over each signal's range."
    return side_by_side([_profile(p) for p in effect.profiles], caption)


def _profile(profile: Profile) -> Panel:
    hundred = 100.0 * np.asarray(profile.share, dtype=float)
    x, y = linear(profile.edges, room=0.0), linear(hundred, zero=not (hundred < 0).any())
    peak = int(np.argmax(hundred))
    begin, end = profile.edges[peak], profile.edges[peak + 1]
    alt = (
        f"Share of the explained error energy over {text.words(profile.signal)}: most of it, {hundred[peak]:.0f} %, between "
        f"{text.number(float(begin))} and {text.with_unit(text.number(float(end)), profile.unit)}."
    )
    marks = (bars(x, y, np.asarray(profile.edges), hundred, "effect"),)
    return Panel(
        x, y, text.axis(profile.signal, profile.unit), "share of explained error [%]", marks, alt, "low", zero=True
    )


def _timelines(effect: Effect) -> Chart | None:
    strongest = sorted(effect.timelines, key=lambda t: -t.intensity)[:MOST_EXPERIMENTS]
    if not strongest:
        return None
    caption = "When: how the error energy that the effect explains spreads over the experiments that had no part in choosing it"
    some = len(effect.timelines) - len(strongest)
    y = linear(*(100.0 * t.share for t in strongest), zero=True)
    shown = [_timeline(t, y) for t in effect.timelines if any(t is s for s in strongest)]
    return side_by_side(shown, caption + (f" (it is weaker in {some} more)." if some else "."))


def _timeline(along: Timeline, y: Scale) -> Panel:
    unit, peak = time_unit(float(np.ptp(along.edges))), int(np.argmax(along.share))
    edges = along.edges / unit.seconds
    x = linear(edges, room=0.0)
    alt = (
        f"Share of the explained error energy along {along.experiment}: {100 * along.share.sum():.0f} % in all, most of it between "
        f"{text.number(float(edges[peak]))} and {text.number(float(edges[peak + 1]))} {unit.symbol}."
    )
    marks = (bars(x, y, edges, 100.0 * along.share, "effect"),)
    return Panel(
        x, y, unit.label, "share of explained error [%]", marks, alt, "low", f"experiment {along.experiment}", zero=True
    )
