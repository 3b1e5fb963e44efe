"""What an estimation comes to."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from rich.console import Console
from rich.text import Text

from greybox_torch.api.estimated import EstimatedParameter, EstimatedStart, estimated_parameters, estimated_starts
from greybox_torch.api.estimated_model import EstimatedModel
from greybox_torch.api.far_parameters import far_parameters
from greybox_torch.api.fit_advice import begun_with, fit_advice, lost_in_one, lost_outputs
from greybox_torch.api.fit_json import estimation_json, identifiability_json, profile_json, status
from greybox_torch.api.fit_summary import beginnings, parameter_table, print_estimate, warnings
from greybox_torch.api.free_runs import plot_simulated
from greybox_torch.api.held_starts import held_json, told_held
from greybox_torch.api.ran_away import ran_away
from greybox_torch.api.scores import print_scores, score_table, scores_side_by_side
from greybox_torch.checkpoint import Checkpoint, checkpoint_files
from greybox_torch.data import DataSet
from greybox_torch.estimate.comparison import Comparison, held_out_scores, mean_fit, of_moving_outputs
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.held_starts import HeldStarts
from greybox_torch.estimate.identifiability import Unidentifiable
from greybox_torch.estimate.problem import with_card
from greybox_torch.estimate.profile import Profile
from greybox_torch.files import json_text
from greybox_torch.mechanisms.stored import stored_effects
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.copies import copy_holding
from greybox_torch.model.own_weights import digest
from greybox_torch.report import notebook
from greybox_torch.result_names import FIT, MODEL
from greybox_torch.systems import model_reference

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class FitResult(EstimatedModel):
    """An estimate of the free parameters and start states of a model.

    ``estimation`` says how it was obtained; ``comparisons`` are the free runs on all experiments with the values
    before ("start") and after ("refit"); ``profiles`` the profile likelihoods that were asked for, ``undetermined``
    what the data leave open as far as the start values told; ``seconds`` how long it took; ``question`` asks whether channels are
    exchanged or of the other sign, where the fit is poor and would be far better with that; ``held`` the start states that the model file
    holds, where the fit would be far better with them estimated.
    """

    stage: ClassVar[str] = "refit"
    """What scores call the model."""

    data: DataSet
    estimation: Estimation
    comparisons: Mapping[str, Comparison]
    profiles: Mapping[str, Profile]
    undetermined: tuple[Unidentifiable, ...]
    precision: str
    seconds: float
    question: str | None = None
    held: HeldStarts | None = None

    @cached_property
    def model(self) -> GreyBoxModel:
        """A copy of the model that holds the estimates, within the bounds that they were looked for in."""
        values = {name: entry.value for name, entry in self.parameters.items()}
        given = self.estimation.problem.model
        return copy_holding(given, values, declared=with_card(self.data, given))

    @cached_property
    def parameters(self) -> dict[str, EstimatedParameter]:
        """By name: ``value``, ``unit``, bounds ``lower`` and ``upper``, whether it was ``fixed``, and two standard deviations: ``std``,
        right where residuals are white, and ``std_sandwich``, right where they are correlated in time too ("std (coloured)" on the
        console), as they are while the model lacks something.
        """
        return estimated_parameters(self.estimation)

    @cached_property
    def initial(self) -> dict[str, dict[str, EstimatedStart]]:
        """Start states by experiment and state, of the experiments that were estimated on."""
        names = self.estimation.problem.records.names
        return {name: estimated_starts(self.estimation, e) for e, name in enumerate(names)}

    @property
    def own_starts(self) -> str:
        """The model in ``scores`` that estimation experiments are simulated by with the start states of the estimate."""
        return self.stage

    @property
    def status(self) -> str:
        """One word on how it ended: "converged", or what kept it from that."""
        return status(self.estimation.termination)

    def __repr__(self) -> str:
        return f"<fit of {self._title}: {self.status}>"

    def content(self, folder: Path) -> dict[str, Any]:
        return estimation_json(self.estimation, self._scores, self.seconds, self._given) | {
            "identifiability": identifiability_json(self.undetermined, self.estimation.identifiability),
            "profiles": {name: profile_json(one) for name, one in self.profiles.items()},
            "precision": self.precision,
            **({"ran_away": self._away} if self._away is not None else {}),
            **({"far_parameters": self._far} if self._far is not None else {}),
            **({"question": self.question} if self.question is not None else {}),
            **({"held_starts": held_json(self.held)} if self.held is not None else {}),
            "dataset": self.data.name,
            "model": model_reference(self.estimation.problem.model),
            "held_out_by_default": self.data.held_out_by_default,
            "checkpoint": str(folder / MODEL),
        }

    def show(self, console: Console) -> None:
        console.print(Text(f"{self.data.name}: {self.estimation.problem.model.title}", style="bold"))
        for line in self._asked:
            console.print(Text(line, style="yellow"), soft_wrap=True)
        print_estimate(console, self.estimation, self.profiles, self._given)
        console.print()
        print_scores(console, self.data, self._scores)
        for line in beginnings(self.estimation):
            console.print(Text(line), soft_wrap=True)
        for line in self._advice:
            console.print(Text(line, style="yellow"), soft_wrap=True)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        """The result as JSON, the model as a checkpoint, and a figure of every profile."""
        return {
            folder / FIT: json_text(self.content(folder)),
            **checkpoint_files(folder / MODEL, self._checkpoint()),
            **{folder / f"profile_{name}.png": self._profile_picture(name) for name in self.profiles},
        }

    def earlier(self, folder: Path) -> Iterable[Path]:
        """Figures of other parameters' profiles."""
        return [folder / f"profile_{name}.png" for name in self.parameters]

    def plot(self, experiment: str | None = None) -> Figure:
        """Simulated before and after against measured, of all experiments or of one."""
        simulated = {name: own.by_experiment for name, own in self.comparisons.items()}
        return plot_simulated(self.data, simulated, self._scores, experiment)

    def _repr_html_(self) -> str:
        return notebook.page(
            self._title,
            *(notebook.sentence(line) for line in self._asked),
            notebook.sentence(f"{self.estimation.termination.value}; mean squared error {self.estimation.mse:.5g}"),
            *(notebook.sentence(line) for line in warnings(self.estimation, self._given)),
            notebook.table(*parameter_table(self.estimation)),
            notebook.table(*score_table(self.data, self._scores)),
            *(notebook.sentence(line) for line in (*beginnings(self.estimation), *self._advice)),
            notebook.picture(self.plot(), "outputs over time, measured, and simulated before and after"),
        )

    @property
    def _asked(self) -> list[str]:
        """The question as a sentence, first of all: where it is answered with yes, all else follows from that."""
        return [] if self.question is None else [f"{self.question}."]

    @property
    def _advice(self) -> list[str]:
        """What the free runs, and parameters that ran away or ended far off, say about model and card: up to five sentences."""
        problem = self.estimation.problem
        away = self._away
        said = fit_advice(self._scores, begun_with(problem, self.data))
        lost = lost_outputs(self._scores)
        alone = None if said or lost else lost_in_one(self._scores)
        held = None if self.held is None else told_held(self.held, self.estimation.problem)
        lines = (None if away is None else f"{away}.", self._far, held, said, lost, alone)
        return [line for line in lines if line is not None]

    @cached_property
    def _away(self) -> str | None:
        """That parameters or start states ran away, without a full stop."""
        return ran_away(self.estimation, self.data, self._fit)

    @cached_property
    def _far(self) -> str | None:
        """That parameters ended far from where they began, as a sentence."""
        return far_parameters(self.estimation, self.data, self._fit)

    @property
    def _fit(self) -> float:
        """Mean fit in % of the outputs that move, on the validation experiments if there are any."""
        return mean_fit(of_moving_outputs(held_out_scores(self._scores["refit"])))

    @property
    def _given(self) -> list[str]:
        """States that the card gives a start value."""
        return [name for name, entry in self.data.initial.items() if entry.value is not None]

    @property
    def _title(self) -> str:
        return f"{self.data.name}: {self.estimation.problem.model.title}"

    def _checkpoint(self) -> Checkpoint:
        given = self.estimation.problem.model
        return Checkpoint(
            model=model_reference(given),
            title=given.title,
            values={name: entry.value for name, entry in self.parameters.items()},
            units={p.name: p.unit for p in given.declared_parameters},
            effects=stored_effects(given),
            free_starts=given.starts_free,
            own_weights=digest(given),
            dataset=self.data.sha256,
            figures=scores_side_by_side(self._scores),
            own_starts=self.own_starts,
        )

    def _profile_picture(self, name: str) -> bytes:
        from greybox_torch.report.profile import plot_profile  # matplotlib takes half a second

        return notebook.png(plot_profile(self.profiles[name], f"{self.data.name}: profile of {name}"))
