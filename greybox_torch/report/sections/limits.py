"""Where nothing was found: how large the error is that remains, what could hide in it, and what would show it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.metrics import root_mean_square
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.report import text
from greybox_torch.report.sections.headline import held_out, pooled
from greybox_torch.report.sections.spectrum import Spectra, spectra
from greybox_torch.report.sections.traces import validation_traces

MOST_EXPERIMENTS = 4

LARGE = 0.1
"""Share of the signal's variation from which an error is called large."""

FOREIGN = 3.0
"""Ratio of validation to estimation errors from which the experiments are said to differ in kind."""


@dataclass(frozen=True)
class Suggestion:
    """An experiment that would bring out an effect which these recordings leave open."""

    mechanism: str
    port: str
    experiment: str


@dataclass(frozen=True)
class Limits:
    sentences: tuple[str, ...]
    suggestions: tuple[Suggestion, ...]
    template: str = "limits.html.j2"

    @classmethod
    def of(cls, verdict: Verdict) -> Limits | None:
        if verdict.effects:
            return None
        sentences = (*_cautions(verdict), *_sizes(verdict), *map(_band, spectra(verdict)))
        return cls(sentences, tuple(_suggestions(verdict)))


def _cautions(verdict: Verdict) -> Iterator[str]:
    """An error that is large, or much larger where the model was not tuned, has a reason, if not one that the search can name."""
    for output in dict.fromkeys(t.output for t in verdict.traces):
        sizes = {role: _relative_error(verdict, output, role) for role in ("estimation", "validation")}
        worst = max(sizes.values())
        if worst < LARGE:
            continue
        name, known = text.words(output), min(sizes.values()) > 0
        size = f"up to {text.percent(worst)} of the signal's variation" if np.isfinite(worst) else "beyond all bounds"
        yield (
            f"The error in {name} is large all the same, {size}: something is at work that neither a law of the library nor a curve over "
            "one signal describes in a way that repeats."
        )
        elsewhere = sizes["validation"] / sizes["estimation"] if known else 1.0
        if elsewhere > FOREIGN:
            yield (
                f"It is {text.number(elsewhere, 2)} times larger in the validation experiments than in those the model was tuned on. They "
                "may have been recorded under other conditions (load, temperature, sensors), or excite what the others do not: estimate "
                "from both kinds."
            )


def _relative_error(verdict: Verdict, output: str, role: str) -> float:
    """Root mean square error as a share of the measured signal's variation; 0 where there is no such experiment."""
    traces = [t for t in verdict.traces if t.output == output and t.role == role]
    if not traces:
        return 0.0
    error = np.mean([root_mean_square(t.measured, t.refit) ** 2 for t in traces])
    return float(np.sqrt(error / max(np.mean([np.nanvar(t.measured) for t in traces]), 1e-300)))


def _sizes(verdict: Verdict) -> Iterator[str]:
    traces = validation_traces(verdict)
    for output in dict.fromkeys(t.output for t in traces):
        of = next(t.unit for t in traces if t.output == output)
        error = pooled(held_out(verdict, "refit", output))
        size = float(np.sqrt(np.mean([np.nanvar(t.measured) for t in traces if t.output == output])))
        yield (
            f"The error that remains in {text.words(output)} is {text.with_unit(text.number(error), of)} (root mean square), "
            f"{text.percent(error / size) if size > 0 else '—'} of the measured signal's own variation. An effect that moves the output by "
            "only a small part of that is lost in it."
        )


def _band(found: Spectra) -> str:
    """Up to which frequency the output stands out from what the model leaves unexplained."""
    name = text.words(found.output)
    visible = np.flatnonzero(found.density["output"] > 4.0 * found.density["model"])
    if not visible.size:
        return f"At no frequency does {name} stand out clearly from the error: the machine has to be excited more strongly."
    last = int(visible[-1])
    if last >= len(found.frequency) - 2:
        return f"The recordings of {name} carry more signal than error over the whole band, up to {text.number(found.frequency[-1], 2)} Hz."
    edge = text.number(float(found.frequency[last]), 2)
    return (
        f"Above about {edge} Hz {name} does not stand out from the error: dynamics there need stronger excitation in that band, "
        "or a quieter sensor."
    )


def _suggestions(verdict: Verdict) -> Iterator[Suggestion]:
    """For the hypotheses that came closest: the experiment that would tell."""
    seen: set[str] = set()
    for port, mechanism, _, _ in verdict.ranking:
        known = LIBRARY.get(mechanism)
        if known is None or not known.experiment or known.experiment in seen:
            continue
        seen.add(known.experiment)
        yield Suggestion(text.mechanism(mechanism), port, known.experiment)
        if len(seen) == MOST_EXPERIMENTS:
            return
