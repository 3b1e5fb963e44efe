"""A verdict in words and tables."""

from __future__ import annotations

import math
from collections.abc import Iterator

from rich.console import Console
from rich.text import Text

from greybox_torch.api.scores import print_scores
from greybox_torch.data import DataSet
from greybox_torch.diagnosis.begun import begun
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.equation_lines import in_lines
from greybox_torch.diagnosis.one_of import OneOf, spoken_at, with_shares
from greybox_torch.diagnosis.own_parameters import far_refits
from greybox_torch.diagnosis.verdict import STOPPED, Verdict
from greybox_torch.estimate.comparison import Score
from greybox_torch.report.tables import print_table

_COLUMNS = ["port", "mechanism", "probability", "size [%]", "parameter", "value", "std", "unit"]


SIZE = (
    "size: the part of the error of the model without effects, over windows whose start states are estimated, that leaving the effect out "
    "brings back; the parts need not add up"
)


MOVED_BY = 0.1
"""Share of its start value by which a parameter of the model has to move to be listed."""
MOVED = (
    f"The model's own parameters that moved by more than {100 * MOVED_BY:.0f} %, and by more than their standard deviation (refit: "
    "re-estimated without the effects; all of them are in the report):"
)


REFIT = (
    "refit: the model without effects, estimated on whole records with each output weighed by the error that is left of it; `greybox fit` "
    "weighs them by their spread, so that its fits and its parameters may differ."
)


def print_verdict(console: Console, data: DataSet, title: str, verdict: Verdict) -> None:
    """The verdict in one sentence, the effects with their parameters, fit and error before and after."""
    console.print(Text(f"{data.name}: {title}", style="bold"))
    console.print(Text(f"\n{verdict.sentence}", style="bold"), soft_wrap=True)
    if verdict.effects:
        print_table(console, *effect_table(verdict))
    for line in notes(verdict):
        console.print(Text(line if verdict.effects else f"- {line}"), soft_wrap=True)
    columns, rows = moved_table(verdict)
    if rows:
        console.print(Text(f"\n{MOVED}"), soft_wrap=True)
        print_table(console, columns, rows)
    console.print()
    print_scores(console, data, verdict_scores(verdict))
    for line in (*which_refit(verdict), *filter(None, [begun(verdict)])):
        console.print(Text(line), soft_wrap=True)
    console.print(Text(f"{verdict.seconds:.1f} s, seed {verdict.seed}"))


def which_refit(verdict: Verdict) -> list[str]:
    """How the refit of the table of scores differs from that of `greybox fit`, where it does: a sentence, or none."""
    outputs = {score.output for score in verdict.scores["refit"]}
    return [REFIT] if verdict.complete and len(outputs) > 1 else []


def effect_table(verdict: Verdict) -> tuple[list[str], list[list[str | float]]]:
    """Headings and rows of the effects and their parameters."""
    return _COLUMNS, [row for effect in verdict.shown_effects for row in _rows(effect)]


def moved_table(verdict: Verdict) -> tuple[list[str], list[list[str | float]]]:
    """Headings and rows of the model's own parameters that have other values with the effects; no rows where there are none."""
    columns = ["parameter", "start", "refit", "with the\neffects", "std", "unit"]
    rows: list[list[str | float]] = []
    for one in verdict.parameters:
        if one.augmented is None:
            continue
        value, deviation = one.augmented
        moved = abs(value - one.start)
        if moved > max(MOVED_BY * abs(one.start), deviation or 0.0):
            rows.append([one.name, one.start, one.refit[0], value, _deviation(deviation), one.unit])
    return columns, rows


def notes(verdict: Verdict) -> list[str]:
    """Whether channels are exchanged, whether the model is of no use, which experiments judge it no longer, where each effect acts, what
    else it could be, and what remains; where there is none, the evidence for that. Both with what was not tried, where the search was
    stopped.
    """
    if not verdict.effects:
        return [
            *verdict.asked,
            *verdict.of_no_use,
            *verdict.short_validation,
            *verdict.evidence,
            *verdict.at_bounds,
            *verdict.together,
            *verdict.not_tried.sentences(),
        ]
    stopped = [] if verdict.complete else [STOPPED, *verdict.not_tried.sentences()]
    left = [] if verdict.left is None else [verdict.left.sentence]
    small = [f"Refinement: {r.sentence}.{f' {r.bounded}.' if r.bounded else ''}" for r in verdict.refinements]
    by_effect = (line for effect in verdict.shown_effects for line in _notes(effect))
    of_validation = (*verdict.no_longer_validation, *verdict.short_validation)
    return [
        *verdict.asked,
        *verdict.of_no_use,
        *of_validation,
        SIZE,
        *verdict.about_sizes,
        *by_effect,
        *left,
        *verdict.worse_outputs,
        *small,
        *verdict.at_bounds,
        *verdict.together,
        *far_refits(verdict.parameters),
        *stopped,
    ]


def verdict_scores(verdict: Verdict) -> dict[str, tuple[Score, ...]]:
    """Of the models that differ: without effects there is no augmented one."""
    models = ("start", "refit", "augmented") if verdict.effects else ("start", "refit")
    return {name: verdict.scores[name] for name in models}


def _rows(effect: Effect) -> Iterator[list[str | float]]:
    """A line for every parameter of a law or a response; one for a curve, whose heights mean little one by one."""
    size = float(f"{100.0 * effect.size:.3g}") if math.isfinite(effect.size) else ""
    first: list[str | float] = [effect.port, effect.mechanism, round(effect.probability, 2), size]
    if not effect.shown_parameters:
        yield [*first, f"curve over {', times '.join(effect.signals)}", "", "", ""]
        return
    for name, entry in effect.shown_parameters.items():
        yield [*first, name, float(entry["value"]), _deviation(entry.get("std")), entry.get("unit", "")]
        first = [""] * len(first)
        if size := effect.amplitudes.get(name):
            yield [*first, "(amplitude)", size[0], _deviation(size[1]), entry.get("unit", "")]
        if pitch := effect.pitch(name):
            yield [*first, "(pitch)", pitch[0], _deviation(pitch[1]), pitch[2]]


def _deviation(value: float | None) -> str | float:
    if value is None:
        return ""
    return value if math.isfinite(value) else "undetermined"


def _notes(effect: Effect) -> list[str]:
    head = spoken_at(effect.mechanism, effect.port)
    lines = [f"{head}: {in_lines(effect.equation)}"] if effect.equation else []
    lines += [f"{head}: {effect.where}"] if effect.where else []
    clauses = (effect.of_line, effect.shared, effect.of_units, effect.like, effect.of_sign)
    lines += [f"{head}: {told}" for told in clauses if told]
    lines += [f"{head}: {effect.bounded}"] if effect.bounded else []
    lines += [f"{head}: {effect.undetermined}"] if effect.undetermined else []
    together = () if effect.one_of is None else effect.one_of.members
    advice = f"; to tell them apart: {effect.separating_experiment}" if effect.separating_experiment else ""
    if effect.one_of is not None:
        lines.append(f"{effect.one_of.told}{_told_apart(effect.one_of, advice)}")
    others = [a for a in effect.alternatives if (a.port, a.mechanism) not in {(m.port, m.mechanism) for m in together}]
    if others:
        lines.append(f"{head}: it could also be {with_shares(others)}{'' if together else advice}")
    return lines


def _told_apart(whole: OneOf, advice: str) -> str:
    """What tells the members apart: a recording, or none where they are one effect in the model."""
    same = f"; {whole.told_one_effect}" if whole.one_effect else ""
    if not whole.separable:
        return same
    return f"{same}{advice.replace('them', 'the others', 1)}" if same else advice
