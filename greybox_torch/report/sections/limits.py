"""Where nothing was found: how large the error is that remains, what could hide in it, and what would show it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from greybox_torch.diagnose.verdict import Verdict
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.report import text
from greybox_torch.report.sections.headline import held_out, pooled
from greybox_torch.report.sections.spectrum import Spectra, spectra
from greybox_torch.report.sections.traces import validation_traces

MOST_EXPERIMENTS = 4


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
        if verdict.mismatch:
            return None
        return cls((*_sizes(verdict), *map(_band, spectra(verdict))), tuple(_suggestions(verdict)))


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
