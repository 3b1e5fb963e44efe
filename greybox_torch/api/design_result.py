"""A designed recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.console import Console
from rich.text import Text

from greybox_torch.api.design_files import CARD, FIGURE, INPUT, card_text, columns_of, csv_text, units_of
from greybox_torch.api.design_groups import hypothesis_table, told_of_groups
from greybox_torch.api.design_notes import design_notes, recorded_as_limits
from greybox_torch.api.expected import WANTED, Expected
from greybox_torch.api.result import Result
from greybox_torch.data import DataSet
from greybox_torch.diagnosis.digits import digits
from greybox_torch.experiment_design.excitation import Excitation
from greybox_torch.experiment_design.limits import Limits
from greybox_torch.in_unit import in_unit
from greybox_torch.model import GreyBoxModel
from greybox_torch.report import notebook
from greybox_torch.report.tables import print_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCHEMA = "greybox-design/1"
SPOKEN = {"reversals": "a triangle wave"}
"""Kinds of signals whose name says more than is so of every one: around a large value it turns back, and never changes its sign."""

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

    Where a controller drives inputs, ``follows`` names the output that each of them follows, ``set_points`` (N,) by output are what is
    designed, and ``driven`` (N,) by input what that makes of them under each hypothesis; ``inputs`` are then those under the first one.
    ``on_one_input`` (N, n_y) is what each hypothesis predicts on these.
    ``left_out`` says which rivals are not among the hypotheses. ``moving``: the
    speeds that it begins with, where it does not begin at rest; ``resting``: those that are next to nothing.
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
    follows: Mapping[str, str] = field(default_factory=dict)
    set_points: Mapping[str, np.ndarray] = field(default_factory=dict)
    driven: tuple[Mapping[str, np.ndarray], ...] = ()
    on_one_input: tuple[np.ndarray, ...] = ()
    left_out: tuple[str, ...] = ()
    moving: tuple[str, ...] = ()
    resting: tuple[str, ...] = ()

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
        kinds = (" and ".join(dict.fromkeys(self._kinds.values())) or "constant inputs") + self.as_set_points
        if self.parameter is not None:
            change = in_unit(f"from {self.before:.2g} to {self.after:.2g}", self.unit)
            return f"{digits(self.seconds, 4)} s of {kinds} are expected to bring the standard deviation of {self.parameter} {change}."
        if not self.expected.decides:
            return (
                f"No {self.what} within the limits was found that tells these hypotheses apart, whichever is right: "
                f"{', '.join(self.names[k] for k in self.expected.in_question)}."
            )
        if self.expected.by_groups:
            return told_of_groups(self.names, self.expected, f"{digits(self.seconds, 4)} s of {kinds}", self.what)
        told = (
            f"{digits(self.seconds, 4)} s of {kinds} are expected to bring the right one of {len(self.names)} hypotheses to a "
            f"probability of {self.expected.after:.2f}"
        )
        likely = self.names[int(np.argmax(self.expected.before))]
        if not self.expected.gains:
            return f"{told}, which is no more than {likely} has today ({self.expected.today:.2f})."
        if max(self.expected.before) >= WANTED:
            return (
                f"These recordings tell the hypotheses apart already: {likely} has a probability of {max(self.expected.before):.2f}. To "
                f"confirm it, {told[0].lower()}{told[1:]}."
            )
        if self.needed < HARDLY_ANY * self.seconds:
            return f"{told}; for {WANTED:.2f} a small part of it would do."
        return f"{told}; for {WANTED:.2f} it takes {digits(self.needed)} s." if np.isfinite(self.needed) else f"{told}."

    def __repr__(self) -> str:
        return f"<design for {self.data.name}: {self.sentence}>"

    def content(self, folder: Path) -> dict[str, Any]:
        excitations = {
            name: vars(e) if name in self._kinds else self._not_designed(name)
            for name, e in zip(self.inputs, self.excitations, strict=True)
        }
        result: dict[str, Any] = {
            "schema": SCHEMA,
            "dataset": self.data.name,
            "sentence": self.sentence,
            "seconds": self.seconds,
            "seed": self.seed,
            "start": dict(self.start),
            "inputs": {name: e for name, e in excitations.items() if name not in self.follows},
            "files": {"input": str(folder / INPUT), "figure": str(folder / FIGURE), "card": str(folder / CARD)},
        }
        if self.follows:
            result["set_points"] = {o: {"drives": name} | excitations[name] for name, o in self.follows.items()}
        if self.parameter is not None:
            deviation = {"before": self.before, "after": self.after, "unit": self.unit}
            return result | {"parameter": self.parameter, "deviation": deviation}
        return result | {
            "hypotheses": [
                {"name": n, "probability": p} for n, p in zip(self.names, self.expected.before, strict=True)
            ],
            "probability_today": self.expected.today,
            "expected_probability": self.expected.after,
            "expected_probability_random": self.expected.random,
            "evidence_nats": self.expected.nats.tolist(),
            "seconds_for_0.95": self.needed,
            "worth_recording": self.expected.worth_recording,
            "cannot_be_told_apart": [list(pair) for pair in self.alike],
            "groups": [[self.names[k] for k in group] for group in self.expected.groups],
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
        return design_notes(self)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        """The input as CSV, a figure, and a card for the new recording."""
        return {
            folder / INPUT: csv_text(
                self.time, columns_of(self.inputs, self.set_points, self.follows), units_of(self.data, self.follows)
            ),
            folder / FIGURE: notebook.png(self.plot()),
            folder / CARD: card_text(self.data, self.time, self.reference, folder, recorded_as_limits(self)),
        }

    def plot(self) -> Figure:
        """The input, what each hypothesis predicts, and their differences."""
        from greybox_torch.report.design import Feedback, plot_design  # matplotlib takes half a second

        model_outputs = [n for n in self.data.channels if n not in self.inputs]
        names = list(self.limits.outputs)
        assert set(names) <= set(model_outputs)
        outputs = {
            name: {label: y[:, k] for label, y in zip(self.names, self.outputs, strict=True)}
            for k, name in enumerate(names)
        }
        units = {name: channel.unit for name, channel in self.data.channels.items()}
        level = {name: float(self.level[k]) for k, name in enumerate(names)}
        set_ones = {name: u for name, u in self.inputs.items() if name not in self.follows}
        title = f"{self.data.name}: the next recording"
        if not self.follows:
            return plot_design(title, self.time, set_ones, outputs, units, level)
        driven = {name: {n: u[name] for n, u in zip(self.names, self.driven, strict=True)} for name in self.follows}
        on_one = {name: [y[:, k] for y in self.on_one_input] for k, name in enumerate(names)}
        feedback = Feedback(self.set_points, driven, on_one)
        return plot_design(title, self.time, set_ones, outputs, units, level, feedback)

    @property
    def what(self) -> str:
        """What is designed, in a word or two."""
        return "set point" if self.follows else "input"

    @property
    def _kinds(self) -> dict[str, str]:
        """The kind of signal by input, of those that move."""
        kinds = {name: e.kind for name, e in zip(self.inputs, self.excitations, strict=True)}
        return {name: SPOKEN.get(kinds[name], kinds[name]) for name in self.limits.designed}

    def _not_designed(self, name: str) -> dict[str, Any]:
        """What an input is that is not designed."""
        if name in self.limits.kept:
            return {"kind": "as recorded", "recording": self.begins_like}
        return {"kind": "constant", "value": self.limits.commanded[name].lower}

    @property
    def as_set_points(self) -> str:
        """What is designed, where that is not the inputs; "" elsewhere."""
        return f" as the set point of {' and '.join(self.set_points)}" if self.follows else ""

    def _repr_html_(self) -> str:
        table = [] if self.parameter is not None else [notebook.table(*self._table())]
        shown = notebook.picture(self.plot(), "the input over time, and the outputs that each hypothesis predicts")
        notes = (notebook.sentence(line) for line in self.notes)
        return notebook.page(
            f"{self.data.name}: the next recording", notebook.sentence(self.sentence, "found"), *table, *notes, shown
        )

    def _table(self) -> tuple[list[str], list[list[str | float]]]:
        """A row for each hypothesis: its probability now, and the evidence for it against the nearest rival, if it is right."""
        return hypothesis_table(self.names, self.expected)
