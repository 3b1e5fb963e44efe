"""A designed recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.text import Text

from greybox_torch.api.expected import Expected
from greybox_torch.api.result import Result
from greybox_torch.data import DataSet
from greybox_torch.experiment_design.excitation import Excitation
from greybox_torch.experiment_design.limits import Limits
from greybox_torch.files import toml_key, toml_text
from greybox_torch.model import GreyBoxModel
from greybox_torch.report import notebook
from greybox_torch.report.tables import print_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "greybox-design/1"
INPUT, FIGURE, CARD, RECORDED = "design.csv", "design.png", "next.toml", "recorded.csv"
WANTED = 0.95
HARDLY_ANY = 0.01
"""Part of a recording below which its length is not told: evidence grows with time on the whole, not period by period."""


@dataclass(frozen=True, eq=False, repr=False)
class DesignResult(Result):
    """The input of a next recording, and what it is expected to tell.

    ``time`` (N,) s and ``inputs`` (N,) by name, in the model's units. ``names`` of the ``hypotheses`` and the ``outputs`` (N, n_y) each
    predicts; ``level`` (n_y,) root mean square errors so far, correlated for
    ``memory`` samples. ``start``: the states that it begins with, those of the recording
    ``begins_like``. Where a ``parameter`` is to be sharpened, ``before`` and ``after`` are its
    standard deviations in ``unit``.
    """

    data: DataSet
    reference: str
    limits: Limits
    time: np.ndarray
    inputs: Mapping[str, np.ndarray]
    excitations: tuple[Excitation, ...]
    names: tuple[str, ...]
    hypotheses: tuple[GreyBoxModel, ...]
    outputs: tuple[np.ndarray, ...]
    level: np.ndarray
    memory: float
    expected: Expected
    begins_like: str
    start: Mapping[str, float]
    parameter: str | None
    unit: str
    before: float | None
    after: float | None
    seed: int

    @property
    def seconds(self) -> float:
        """How long the recording takes."""
        return float(len(self.time) * (self.time[1] - self.time[0]))

    @property
    def needed(self) -> float:
        """Seconds of such a recording after which the right hypothesis is expected at a probability of 0.95."""
        return self.expected.seconds_for(WANTED, self.seconds)

    @property
    def alike(self) -> list[tuple[str, str]]:
        """Pairs of hypotheses that this recording would not tell apart."""
        alike, count = self.expected.alike, len(self.names)
        pairs = [(a, b) for a in range(count) for b in range(a + 1, count)]
        return [(self.names[a], self.names[b]) for a, b in pairs if alike[a, b]]

    @property
    def sentence(self) -> str:
        """What the recording is expected to do, in a sentence."""
        kinds = " and ".join(dict.fromkeys(e.kind for e in self.excitations))
        if self.parameter is not None:
            return (
                f"{self.seconds:.3g} s of {kinds} are expected to bring the standard deviation of {self.parameter} "
                f"from {self.before:.2g} to {self.after:.2g} {self.unit}".rstrip()
                + "."
            )
        if not self.expected.decides:
            return f"No input within the limits was found that tells these hypotheses apart: {', '.join(self.names)}."
        told = (
            f"{self.seconds:.3g} s of {kinds} are expected to bring the right one of {len(self.names)} hypotheses to a probability of "
            f"{self.expected.after:.2f}"
        )
        if self.needed < HARDLY_ANY * self.seconds:
            return f"{told}; for {WANTED:.2f} a small part of it would do."
        return f"{told}; for {WANTED:.2f} it takes {self.needed:.2g} s." if np.isfinite(self.needed) else f"{told}."

    def __repr__(self) -> str:
        return f"<design for {self.data.name}: {self.sentence}>"

    def content(self, folder: Path) -> dict[str, Any]:
        result: dict[str, Any] = {
            "schema": SCHEMA,
            "dataset": self.data.name,
            "sentence": self.sentence,
            "seconds": self.seconds,
            "seed": self.seed,
            "start": dict(self.start),
            "inputs": {name: vars(e) for name, e in zip(self.inputs, self.excitations, strict=True)},
            "files": {"input": str(folder / INPUT), "figure": str(folder / FIGURE), "card": str(folder / CARD)},
        }
        if self.parameter is not None:
            deviation = {"before": self.before, "after": self.after, "unit": self.unit}
            return result | {"parameter": self.parameter, "deviation": deviation}
        return result | {
            "hypotheses": [
                {"name": n, "probability": p} for n, p in zip(self.names, self.expected.before, strict=True)
            ],
            "expected_probability": self.expected.after,
            "expected_probability_random": self.expected.random,
            "evidence_nats": self.expected.nats.tolist(),
            "seconds_for_0.95": self.needed,
            "cannot_be_told_apart": [list(pair) for pair in self.alike],
        }

    def show(self, console: Console) -> None:
        console.print(Text(f"{self.data.name}: the next recording", style="bold"))
        console.print(Text(f"\n{self.sentence}", style="bold"), soft_wrap=True)
        if self.parameter is None:
            print_table(console, *self._table())
        for line in self.notes:
            console.print(Text(line), soft_wrap=True)

    @property
    def notes(self) -> list[str]:
        """What else a reader has to know."""
        lines = [
            f"No input within the limits was found that tells {a} from {b} in {self.seconds:.3g} s."
            for a, b in self.alike
        ]
        if self.alike and self.parameter is None and self.expected.decides:
            lines.append("Those count as one in the probability that is expected.")
        if self.expected.random is not None and self.parameter is None:
            lines.append(f"A random multisine of the same power: {self.expected.random:.2f}.")
        if self.limits.seconds > 1.001 * self.seconds:
            lines.append(
                f"Designed for the first {self.seconds:.3g} of {self.limits.seconds:.3g} s; "
                "repeated, it says more in proportion to the time."
            )
        began = ", ".join(f"{name} = {value:.3g}" for name, value in self.start.items())
        lines.append(f"Begin as {self.begins_like} began: {began}.")
        lines.append(
            f"Record it, save it as {RECORDED} beside {CARD}, and diagnose the old recordings together with it."
        )
        return lines

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        """The input as CSV, a figure, and a card for the new recording."""
        return {
            folder / INPUT: self._csv(),
            folder / FIGURE: notebook.png(self.plot()),
            folder / CARD: self._card(),
        }

    def plot(self) -> Figure:
        """The input, what each hypothesis predicts, and their differences."""
        from greybox_torch.report.design import plot_design  # matplotlib takes half a second

        model_outputs = [n for n in self.data.channels if n not in self.inputs]
        names = list(self.limits.outputs)
        assert set(names) <= set(model_outputs)
        outputs = {
            name: {label: y[:, k] for label, y in zip(self.names, self.outputs, strict=True)}
            for k, name in enumerate(names)
        }
        units = {name: channel.unit for name, channel in self.data.channels.items()}
        level = {name: float(self.level[k]) for k, name in enumerate(names)}
        return plot_design(f"{self.data.name}: the next recording", self.time, self.inputs, outputs, units, level)

    def _repr_html_(self) -> str:
        table = [] if self.parameter is not None else [notebook.table(*self._table())]
        shown = notebook.picture(self.plot(), "the input over time, and the outputs that each hypothesis predicts")
        notes = (notebook.sentence(line) for line in self.notes)
        return notebook.page(
            f"{self.data.name}: the next recording", notebook.sentence(self.sentence, "found"), *table, *notes, shown
        )

    def _table(self) -> tuple[list[str], list[list[str | float]]]:
        """A row for each hypothesis: its probability now, and the evidence for it against the nearest rival, if it is right."""
        nats = self.expected.nats + np.diag(np.full(len(self.names), np.inf))
        rows: list[list[str | float]] = [
            [name, p, float(nats[k].min())]
            for k, (name, p) in enumerate(zip(self.names, self.expected.before, strict=True))
        ]
        return ["hypothesis", "probability\nnow", "expected evidence\nif right [nats]"], rows

    def _csv(self) -> str:
        lines = [",".join(["time", *self.inputs])]
        for k, t in enumerate(self.time):
            lines.append(",".join(f"{v:.9g}" for v in (t, *(u[k] for u in self.inputs.values()))))
        return "\n".join(lines) + "\n"

    def _card(self) -> str:
        channels = "\n".join(
            f"{toml_key(name)} = {{ column = {toml_text(name)}, unit = {toml_text(channel.unit)} }}"
            for name, channel in self.data.channels.items()
        )
        return (
            f"# A card for the recording that {INPUT} asks for. Save what you record as {RECORDED}, with these columns.\n"
            f"# To diagnose old and new recordings together, copy the [[experiment]] below to the card of the old ones.\n"
            f"name = {toml_text(f'{self.data.name}: designed recording')}\n"
            f"sample_time = {float(self.time[1] - self.time[0])!r}\n"
            f'hold = "{self.data.hold}"\n\n[channels]\n{channels}\n\n'
            f'[[experiment]]\nname = "Designed"\nfile = "{RECORDED}"\nrole = "estimation"\n\n'
            f"[model]\nname = {toml_text(self.reference)}\n"
        )
