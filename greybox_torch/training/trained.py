"""What a training tells on its way, and what it ends in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import torch

from greybox_torch.estimate.fit import Estimation
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.training.curriculum import Curriculum
from greybox_torch.training.hybrid import Hybrid, port_named
from greybox_torch.training.physics import Physics
from greybox_torch.training.polish import Polished
from greybox_torch.training.settings import TrainingSettings
from greybox_torch.training.signal_names import local_names
from greybox_torch.training.state import Epoch


@dataclass(frozen=True)
class Report:
    """What a training is at: in words, the share of the epochs done, and the last epoch where there is one."""

    stage: str
    share: float = 0.0
    last: Epoch | None = None

    @property
    def line(self) -> str:
        """The figures of the last epoch in words, empty where there is none."""
        last = self.last
        if last is None:
            return ""
        return f"epoch {last.epoch}  loss {last.loss:.4f}  held out {last.held_out:.4f} ({last.fit:.2f} %)"


@dataclass(frozen=True)
class Trained:
    """A trained hybrid.

    ``physics`` and ``result`` are the estimates of the plain model and of the hybrid; ``hybrid`` says what is attached;
    ``polished`` which penalty the held-out stretches chose; ``history`` has the epochs; ``course`` what it was trained by.
    """

    physics: Estimation
    result: Estimation
    hybrid: Hybrid
    polished: Polished
    history: tuple[Epoch, ...]
    settings: TrainingSettings
    seconds: float
    course: Curriculum

    @property
    def physics_chosen(self) -> bool:
        """Whether the network was left at zero, since physics alone predicts the held-out stretches better."""
        return self.polished.chosen.weight is None

    @property
    def shared_physics(self) -> Physics:
        """The physics alone as other trainings can begin with it."""
        begun = self.course.unknowns.hybrid.problem.values[: len(self.physics.problem.values)]
        return Physics(self.physics, begun)

    def force(self, **signals: np.ndarray) -> np.ndarray:
        """The network's own force at given local signals (arrays of one shape, in their units), in the unit of the port's force."""
        problem, network = self.result.problem, self.hybrid.network
        assert isinstance(problem.model, AugmentedModel)
        names = local_names(problem.model.base, port_named(problem.model.base, network.port), signals)
        local = {
            name: torch.as_tensor(np.asarray(v, dtype=float)) for name, v in zip(names, signals.values(), strict=True)
        }
        return problem.model.curve(network, local, problem.parameter_tensors).detach().numpy()
