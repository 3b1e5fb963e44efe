"""What a diagnosis comes to."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from rich.console import Console

from greybox_torch import __version__
from greybox_torch.api.free_runs import plot_simulated
from greybox_torch.api.hypotheses import hypothesis_files, kept_hypotheses
from greybox_torch.api.result import Result
from greybox_torch.api.scores import score_rows, score_table
from greybox_torch.api.verdict_summary import MOVED, effect_table, moved_table, notes, print_verdict, verdict_scores
from greybox_torch.by_name import ByName
from greybox_torch.checkpoint import Checkpoint, checkpoint_files
from greybox_torch.data import DataSet
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.pipeline import Diagnosis
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.problem import with_card
from greybox_torch.files import json_text
from greybox_torch.mechanisms.stored import in_layers, stored_effects
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.copies import copy_holding
from greybox_torch.model.own_weights import digest
from greybox_torch.report import notebook
from greybox_torch.report.about import About
from greybox_torch.result_names import MODEL, PRINTED, REPORT, VERDICT
from greybox_torch.systems import model_reference

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class FoundParameter:
    """A parameter of the model that a diagnosis recommends, in ``unit``. ``std`` is None where the search did not compute it, as of what
    is fixed and where it was stopped before whole records were fitted; infinite where the recordings do not determine the parameter.
    """

    value: float
    std: float | None
    unit: str
    fixed: bool


@dataclass(frozen=True, eq=False, repr=False)
class DiagnosisResult(Result):
    """What is missing from a model, and the model with it. ``found`` is the verdict with its attachments as the search gave them."""

    stage: ClassVar[str] = "augmented"
    """What scores call the model."""

    data: DataSet
    given: GreyBoxModel
    found: Diagnosis
    device: str = "cpu"

    @property
    def verdict(self) -> Verdict:
        """All that was found: effects, scores, evidence, traces."""
        return self.found.verdict

    @property
    def sentence(self) -> str:
        """The verdict in one sentence."""
        return self.verdict.sentence

    @property
    def mismatch(self) -> bool:
        """Whether something is missing."""
        return self.verdict.mismatch

    @property
    def effects(self) -> tuple[Effect, ...]:
        """What is missing, each with its port, mechanism, probability and parameters; empty where nothing was found."""
        return self.verdict.effects

    @cached_property
    def model(self) -> GreyBoxModel:
        """The model with the effects attached, holding the values that were found; the re-estimated one where nothing is missing."""
        made = self.found.model
        return copy_holding(made, self.found.values, declared=with_card(self.data, made.plain), starts_free=True)

    @cached_property
    def parameters(self) -> dict[str, FoundParameter]:
        """Of the model with its effects, by name: value, standard deviation, unit, and whether it was fixed."""
        deviations: dict[str, Any] = {
            one.name: (one.refit if one.augmented is None else one.augmented)[1] for one in self.verdict.parameters
        }
        for effect in self.effects:
            prefix = f"{effect.prefix}."
            deviations |= {f"{prefix}{name}": entry.get("std") for name, entry in effect.parameters.items()}
        return ByName(
            (p.name, FoundParameter(self.found.values[p.name], deviations.get(p.name), p.unit, p.fixed))
            for p in self.model.declared_parameters
        )

    @property
    def initial(self) -> Mapping[str, Mapping[str, float]]:
        """Start states by experiment and state, of the experiments that were chosen with."""
        return self.found.initial

    @property
    def scores(self) -> list[dict[str, Any]]:
        """A row for every output of every experiment, for the models "start", "refit" and, where effects were found, "augmented"."""
        return score_rows(self.data, verdict_scores(self.verdict))

    @property
    def own_starts(self) -> str:
        """The model in ``scores`` that estimation experiments are simulated by with the start states of the estimate; "" for none."""
        return list(verdict_scores(self.verdict))[-1] if self.verdict.complete else ""

    @property
    def effect_rows(self) -> list[dict[str, Any]]:
        """A row for every parameter of every effect."""
        return [
            {"port": e.port, "mechanism": e.mechanism, "probability": e.probability, "parameter": name, **entry}
            for e in self.effects
            for name, entry in e.parameters.items()
        ]

    def __repr__(self) -> str:
        return f"<diagnosis of {self.data.name}: {self.sentence}>"

    def content(self, folder: Path) -> dict[str, Any]:
        return {**self.verdict.as_json(), "held_out_by_default": self.data.held_out_by_default}

    def show(self, console: Console) -> None:
        print_verdict(console, self.data, self.given.title, self.verdict)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        """The report, the verdict, the model with its effects as a checkpoint, and its rivals."""
        from greybox_torch.report.page import render_page

        own = self._checkpoint()
        return {
            folder / REPORT: render_page(self.verdict, self._about(folder)),
            folder / VERDICT: json_text(self.content(folder)),
            **checkpoint_files(folder / MODEL, own),
            **hypothesis_files(folder, self, own),
        }

    def save(self, folder: str | PathLike[str], *, pdf: bool = False) -> tuple[Path, ...]:
        """Write what the command of the same name writes: all of its files or none. Returns their paths.

        What an earlier diagnosis left there and this one does not have is removed: its hypotheses, and its report for print.

        Args:
            pdf: also write the report for print, report.pdf.

        Raises:
            UserError: the folder or a file cannot be written.

        Example:
            ``diagnose(Motor(), data).save("results", pdf=True)``
        """
        where = Path(folder)
        contents = self.files(where)
        if pdf:
            from greybox_torch.report.pdf.document import render_pdf

            contents[where / PRINTED] = render_pdf(self.verdict, self._about(where))
        return self._written(where, contents)

    def earlier(self, folder: Path) -> Iterable[Path]:
        """The report for print, and hypotheses of an earlier diagnosis."""
        return [folder / PRINTED, *kept_hypotheses(folder)]

    def plot(self, experiment: str | None = None) -> Figure:
        """Simulated by each model against measured, of all experiments or of one."""
        scores, names = verdict_scores(self.verdict), [recording.name for recording in self.data.recordings]
        traces = {name: [t for t in self.verdict.traces if t.experiment == name] for name in names}
        simulated = {
            model: {name: np.column_stack([getattr(t, model) for t in traces[name]]) for name in names}
            for model in scores
        }
        return plot_simulated(self.data, simulated, scores, experiment)

    def _repr_html_(self) -> str:
        effects = [notebook.table(*effect_table(self.verdict))] if self.effects else []
        columns, rows = moved_table(self.verdict)
        moved = [notebook.sentence(MOVED), notebook.table(columns, rows)] if rows else []
        return notebook.page(
            f"{self.data.name}: {self.given.title}",
            notebook.sentence(self.sentence, "found"),
            *effects,
            *(notebook.sentence(line) for line in notes(self.verdict)),
            *moved,
            notebook.table(*score_table(self.data, verdict_scores(self.verdict))),
            notebook.picture(self.plot(), "outputs over time, measured and simulated by each model"),
        )

    @property
    def _units(self) -> dict[str, str]:
        return {p.name: p.unit for p in self.found.model.declared_parameters}

    def _checkpoint(self) -> Checkpoint:
        return Checkpoint(
            model=model_reference(self.given),
            title=self.given.title,
            values=self.found.values,
            units=self._units,
            effects=in_layers(stored_effects(self.given), self.found.attachments),
            free_starts=True,
            own_weights=digest(self.given),
            dataset=self.data.sha256,
            figures=self.content(Path())["fit"],
            own_starts=self.own_starts,
        )

    def _about(self, folder: Path) -> About:
        model = ["--model", model_reference(self.given)] if self.data.model is None else []
        command = ["greybox", "compare", str(self.data.path), str(folder / MODEL), *model]
        return About(
            version=__version__,
            created=datetime.now().astimezone(),
            device=self.device,
            held_out_by_default=self.data.held_out_by_default,
            values=self.found.values,
            units=self._units,
            command="" if self.data.path is None else shlex.join(command),
        )
