"""What a training comes to."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from rich.console import Console

from greybox_torch.api.estimated import EstimatedParameter, estimated_parameters
from greybox_torch.api.estimated_model import EstimatedModel
from greybox_torch.api.free_runs import plot_simulated
from greybox_torch.api.scores import score_table, scores_side_by_side
from greybox_torch.api.train_advice import explained_sentence, train_advice
from greybox_torch.api.train_held_out import mostly_lost
from greybox_torch.api.train_json import training_json
from greybox_torch.api.train_range import Beyond
from greybox_torch.api.train_scores import START
from greybox_torch.api.train_summary import parameter_table, print_training, training_sentence
from greybox_torch.checkpoint import Checkpoint, checkpoint_files
from greybox_torch.data import DataSet
from greybox_torch.estimate.comparison import Comparison
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.problem import with_card
from greybox_torch.files import json_text
from greybox_torch.mechanisms.stored import stored_effects
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.copies import copy_holding
from greybox_torch.model.own_weights import digest
from greybox_torch.report import notebook
from greybox_torch.result_names import MODEL, TRAINED
from greybox_torch.systems import model_reference
from greybox_torch.training import Explanation, Trained

if TYPE_CHECKING:
    from matplotlib.figure import Figure

NAMED_MODEL, FIGURE = "named", "learned.png"
"""The hybrid, the model with a law in the network's place, and the picture of what the network has learned."""


@dataclass(frozen=True, eq=False, repr=False)
class TrainingResult(EstimatedModel):
    """A model with a trained network at one of its ports.

    ``trained`` says how it was obtained, ``explanation`` what the network stands for (None where that was not asked
    for). ``comparisons`` are the free runs on all experiments: with the values before ("start"), of the physics alone
    ("refit"), of the hybrid ("augmented"), and of the model with a law in the network's place ("named"), where one
    does as well. ``beyond``: signals of the network that the validation experiments take out of the range that it was
    learned over.
    """

    stage: ClassVar[str] = "augmented"
    """What scores call the model."""

    data: DataSet
    given: GreyBoxModel
    trained: Trained
    explanation: Explanation | None
    comparisons: Mapping[str, Comparison]
    beyond: tuple[Beyond, ...] = ()

    @cached_property
    def model(self) -> GreyBoxModel:
        """The model with the trained network, holding the values that were estimated."""
        return self._copy(self.trained.result)

    @cached_property
    def named(self) -> GreyBoxModel | None:
        """The model with a law of the library in the network's place; None where no law does as well."""
        explained = self.explanation
        return None if explained is None or explained.result is None else self._copy(explained.result)

    @cached_property
    def parameters(self) -> dict[str, EstimatedParameter]:
        """By name, the network's weights among them: value, standard deviation, unit, bounds, and whether it was fixed."""
        return estimated_parameters(self.trained.result)

    @property
    def sentence(self) -> str:
        """What the network adds, in one sentence."""
        return training_sentence(self.trained)

    @property
    def seconds(self) -> float:
        """How long the training took."""
        return self.trained.seconds

    def force(self, **signals: np.ndarray) -> np.ndarray:
        """The network's own force at local signals (arrays of one shape, in their units), in the unit of the port's force."""
        return self.trained.force(**signals)

    @property
    def advice(self) -> list[str]:
        """What the validation experiments say of the network: that it makes the model worse, where it only extrapolates, or nothing."""
        return [*train_advice(self._scores), *(one.sentence for one in self.beyond)]

    def __repr__(self) -> str:
        return f"<training on {self.data.name}: {self.sentence}>"

    def content(self, folder: Path) -> dict[str, Any]:
        return training_json(self.data, self.given, self.trained, self._scores, self.explanation) | {
            "validation": {"beyond_learned": [one.as_json() for one in self.beyond], "sentences": self.advice},
            "checkpoint": str(folder / MODEL),
        }

    def show(self, console: Console) -> None:
        print_training(console, self.data, self.given, self.trained, self._scores, self.explanation, self.advice)

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        """The result as JSON, the hybrid as a checkpoint, what was learned as a figure, the model with the law as a checkpoint."""
        learned, explained = self.plot_learned(), self.explanation
        contents: dict[Path, str | bytes] = {
            folder / TRAINED: json_text(self.content(folder)),
            **checkpoint_files(folder / MODEL, self._checkpoint(self.trained.result)),
        }
        if learned is not None:
            contents[folder / FIGURE] = notebook.png(learned)
        if explained is not None and explained.result is not None:
            contents |= checkpoint_files(folder / NAMED_MODEL, self._checkpoint(explained.result))
        return contents

    def earlier(self, folder: Path) -> Iterable[Path]:
        """The picture, and the model with a law in the network's place."""
        return [folder / name for name in (FIGURE, f"{NAMED_MODEL}.json", f"{NAMED_MODEL}.safetensors")]

    def plot(self, experiment: str | None = None) -> Figure:
        """Simulated by physics, hybrid and named law against measured, of all experiments or of one."""
        shown = {name: own for name, own in self.comparisons.items() if name != START}
        simulated = {name: own.by_experiment for name, own in shown.items()}
        return plot_simulated(self.data, simulated, {name: own.scores for name, own in shown.items()}, experiment)

    def plot_learned(self) -> Figure | None:
        """The network's force over each of its signals, with a band and the nearest laws; None where nothing was learned or explained."""
        if self.explanation is None or not self.explanation.curves:
            return None
        from greybox_torch.report.learned import plot_learned  # matplotlib takes half a second

        network = self.trained.hybrid.network
        title = f"What {network.mechanism.name} at {network.port} has learned"
        return plot_learned(self.trained, self.explanation, title)

    def _repr_html_(self) -> str:
        learned = self.plot_learned()
        said = [] if self.explanation is None else [notebook.sentence(self._explained(self.explanation), "found")]
        return notebook.page(
            f"{self.data.name}: {self.given.title}",
            notebook.sentence(self.sentence, "found"),
            *said,
            notebook.table(*parameter_table(self.trained)),
            *([] if learned is None else [notebook.picture(learned, "force of the network over what it reads")]),
            notebook.table(*score_table(self.data, self._scores)),
            *(notebook.sentence(line) for line in self.advice),
            notebook.picture(self.plot(), "outputs over time, measured, and simulated by each model"),
        )

    def _explained(self, explanation: Explanation) -> str:
        return explained_sentence(explanation, self._scores, judged=not mostly_lost(self.trained))

    def _copy(self, found: Estimation) -> GreyBoxModel:
        problem = found.problem
        values = problem.values_by_name
        return copy_holding(problem.model, values, declared=with_card(self.data, problem.model.plain), starts_free=True)

    def _checkpoint(self, found: Estimation) -> Checkpoint:
        problem = found.problem
        return Checkpoint(
            model=model_reference(self.given),
            title=self.given.title,
            values=problem.values_by_name,
            units={p.name: p.unit for p in problem.model.declared_parameters},
            effects=stored_effects(problem.model),
            free_starts=True,
            own_weights=digest(self.given),
            dataset=self.data.sha256,
            figures=scores_side_by_side(self._scores),
        )
