"""The models compared, from the published parameters to the network alone, each measured once per seed where chance plays a part."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

from experiments.ablation.black_box import train_black_box
from experiments.ablation.diagnosis import Diagnosed
from experiments.ablation.measure import Fits, drift, fits_of, timed
from experiments.ablation.networks import NetworkChoice, judged
from experiments.ablation.results import Case, Entry
from experiments.ablation.series import Scaling
from greybox_torch import DataSet, GreyBoxModel, TrainingSettings, fit_physics
from greybox_torch.estimate import Score, fit_percent, make_problem, root_mean_square
from greybox_torch.mechanisms import AugmentedModel
from greybox_torch.training import Physics, Trained

MODELS = {
    "published": "physics with the card's values",
    "physics": "physics re-estimated",
    "named": "physics + named mechanisms",
    "diagnosed": "the diagnosis with its free curve",
    "hybrid": "hybrid: physics + network",
    "hybrid_named": "hybrid + named mechanisms",
    "black_box": "network alone",
}
"""In the order of the table, with what they are."""

RANDOM = ("hybrid", "hybrid_named", "black_box")
"""Those that a seed plays a part in."""


@dataclass
class Ladder:
    """The models of one case; what they share is computed when it is first needed, once.

    ``diagnose`` gives the diagnosis; ``networks`` are the candidates for the hybrid; ``effort`` is a factor on
    the training of the network alone, ``commit`` the code's.
    """

    data: DataSet
    model: GreyBoxModel
    case: Case
    diagnose: Callable[[], Diagnosed]
    networks: list[NetworkChoice]
    settings: TrainingSettings
    effort: float = 1.0
    commit: str = "unknown"
    told: Callable[[str], None] = lambda text: None

    @cached_property
    def _physics(self) -> tuple[Physics, dict[str, Any]]:
        self.told("physics re-estimated")
        return timed(lambda: fit_physics(self.data, self.model, settings=self.settings))

    @cached_property
    def _diagnosed(self) -> Diagnosed:
        self.told("diagnosis")
        found = self.diagnose()
        self.case.notes["diagnosis"] = {"sentence": found.sentence, "laws": found.laws(self.model)}
        return found

    @cached_property
    def _named(self) -> tuple[GreyBoxModel, Physics, dict[str, Any]] | None:
        """The laws that the diagnosis found, re-estimated together with the physics; None where it found none."""
        model = self._diagnosed.model(self.model, named_only=True)
        if model is None:
            return None
        self.told("named mechanisms re-estimated")
        values = self._diagnosed.values(model)
        found, took = timed(partial(fit_physics, self.data, model, values=values, settings=self.settings))
        return model, found, took

    @property
    def network(self) -> NetworkChoice:
        """The candidate that predicts held-out stretches best beside the physics, measured with seed 0."""
        rows = self.case.notes.setdefault("networks", [])
        done = {(r["kind"], r["port"], tuple(r["signals"])) for r in rows}
        for choice in self.networks:
            if (choice.kind, choice.port, choice.signals) not in done:
                self.told(f"which network: {choice}")
                rows.append(judged(choice, self._trained(choice, self.model, self._physics[0], 0)))
        best = min(rows, key=lambda row: row["share"])
        return NetworkChoice(best["kind"], best["port"], tuple(best["signals"]))

    def measure(self, model: str, seed: int | None) -> Entry | None:
        """One entry; None where there is no such model, since the diagnosis found nothing of the kind."""
        entry = getattr(self, f"_{model}_entry")
        return entry() if seed is None else entry(seed)

    def _published_entry(self) -> Entry:
        start = make_problem(self.data, self.model, self.data.recordings)
        values = start.values_by_name
        fits = fits_of(self.data, self.model, self.model, values, self._physics[0].result.substeps)
        return self._entry("published", None, fits, values, {"seconds": 0.0, "processor_seconds": 0.0})

    def _physics_entry(self) -> Entry:
        physics, took = self._physics
        return self._of_problem("physics", None, self.model, physics, took)

    def _named_entry(self) -> Entry | None:
        if self._named is None:
            return None
        model, found, took = self._named
        return self._of_problem("named", None, model, found, took)

    def _diagnosed_entry(self) -> Entry | None:
        found = self._diagnosed
        model = found.model(self.model, named_only=False)
        if model is None or not found.has_curve:
            return None
        fits = fits_of(self.data, self.model, model, found.values(model), self._physics[0].result.substeps)
        took = {"seconds": found.seconds, "processor_seconds": float("nan")}
        return self._entry("diagnosed", None, fits, found.values(model), took)

    def _hybrid_entry(self, seed: int) -> Entry:
        return self._of_trained("hybrid", seed, self.model, self._physics[0])

    def _hybrid_named_entry(self, seed: int) -> Entry | None:
        return None if self._named is None else self._of_trained("hybrid_named", seed, *self._named[:2])

    def _black_box_entry(self, seed: int) -> Entry:
        scaling = Scaling.of(self.data, self.model)
        series = [scaling.series(recording) for recording in self.data.estimation()]
        (network, held_out), took = timed(lambda: train_black_box(series, seed, self.effort))
        scores = []
        for recording in self.data.recordings:
            simulated = scaling.outputs_of(recording, network.simulated(scaling.series(recording)))
            for k, output in enumerate(scaling.outputs):
                pair = recording.signals[output], simulated[:, k]
                figures = fit_percent(*pair), root_mean_square(*pair)
                scores.append(Score(recording.name, recording.role, output, *figures))
        weights = sum(p.numel() for p in network.parameters())
        return self._entry("black_box", seed, Fits.of(tuple(scores)), {}, took, held_out=held_out, weights=weights)

    def _of_problem(
        self, name: str, seed: int | None, model: GreyBoxModel, found: Physics, took: Mapping[str, float]
    ) -> Entry:
        values = found.result.problem.values_by_name
        fits = fits_of(self.data, self.model, model, values, found.result.substeps)
        return self._entry(name, seed, fits, values, took, mse=found.result.mse)

    def _of_trained(self, name: str, seed: int, model: GreyBoxModel, physics: Physics) -> Entry:
        choice = self.network
        found, took = timed(partial(self._trained, choice, model, physics, seed))
        values = found.result.problem.values_by_name
        augmented = found.result.problem.model
        assert isinstance(augmented, AugmentedModel)
        fits = fits_of(self.data, self.model, augmented, values, found.result.substeps)
        own = {"mse": found.result.mse, "penalty": found.polished.chosen.weight, "network": str(choice)}
        held_out = [{"penalty": c.weight, "mse": c.held_out} for c in found.polished.choices]
        return self._entry(name, seed, fits, values, took, held_out=held_out, **own)

    def _trained(self, choice: NetworkChoice, model: GreyBoxModel, physics: Physics, seed: int) -> Trained:
        return choice.trained(self.data, model, physics, replace(self.settings, seed=seed))

    def _entry(
        self,
        name: str,
        seed: int | None,
        fits: Fits,
        values: Mapping[str, float],
        took: Mapping[str, float],
        **detail: Any,
    ) -> Entry:
        moved = drift(self._physics[0].result.problem, values) if values else {}
        own = {"commit": self.commit, "fit": fits.by_experiment(), "parameters": dict(values), **detail}
        return Entry(name, seed, fits.estimation, fits.validation, drift=moved, detail=own, **took)
