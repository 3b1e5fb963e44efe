"""What a training is told."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

from greybox_torch.errors import UserError
from greybox_torch.keywords import fields_checked
from greybox_torch.training.gradients import check_gradient


@fields_checked
@dataclass(frozen=True)
class TrainingSettings:
    """Choices of a training; the defaults train the hybrid of the robot arm in well under a minute on two cores.

    Args:
        epochs: most passes over the windows of each length.
        batch: windows in a mini-batch.
        gradient: ``tangents``, ``recomputation`` or ``odeint_adjoint``, see :data:`greybox_torch.training.gradients.GRADIENTS`.
        freeze_physics: the physical parameters stay as the physics alone was estimated.
        factors: the curriculum: window lengths as multiples of a 64th of the longest record, in rising order.
        warm_up: share of each window, at its beginning, that carries no weight.
        held_out: share of the estimation experiments, in stretches of the longest windows, that no step is taken on.
        learning_rate: of Adam at the beginning of each window length, in units of each unknown's size; it falls along a half cosine.
        clip: largest norm of a step's gradient.
        patience: epochs without a better held-out loss after which a window length is done.
        refresh: epochs after which the start states of the windows are fitted anew.
        penalty: how many samples' worth of error a weight of the output costs when it is as large as the error of the physics.
        seed: of the order of the windows and of which are held out.
    """

    epochs: int = 120
    batch: int = 16
    gradient: str = "tangents"
    freeze_physics: bool = False
    factors: tuple[int, ...] = (1, 2, 4)
    warm_up: float = 0.15
    held_out: float = 0.2
    learning_rate: float = 0.01
    clip: float = 1.0
    patience: int = 40
    refresh: int = 20
    penalty: float = 10.0
    seed: int = 0

    def __post_init__(self) -> None:
        check_gradient(self.gradient)
        for name in ("epochs", "batch", "patience", "refresh"):
            value = getattr(self, name)
            if not isinstance(value, int) or value < 1:
                raise UserError(f"training: {name} is {value!r}; expected a whole number of at least 1")
        for name in ("learning_rate", "clip"):
            if not 0.0 < getattr(self, name) < float("inf"):
                raise UserError(f"training: {name} is {getattr(self, name)!r}; expected a positive number")
        if not 0.0 <= self.penalty < float("inf"):
            raise UserError(f"training: penalty is {self.penalty!r}; expected a number that is not negative")
        if not 0.0 <= self.warm_up < 0.9:
            raise UserError(f"training: warm_up is {self.warm_up!r}; expected a share from 0 to below 0.9")
        if not 0.0 < self.held_out <= 0.5:
            raise UserError(f"training: held_out is {self.held_out!r}; expected a share above 0 and of at most 0.5")
        rising = all(a < b for a, b in pairwise(self.factors))
        if not self.factors or self.factors[0] < 1 or not rising or any(b % a for a, b in pairwise(self.factors)):
            raise UserError(
                f"training: factors are {list(self.factors)}; expected rising whole numbers, each a multiple of the one before"
            )

    def as_json(self) -> dict[str, Any]:
        """The choices by name, as JSON has them."""
        return {**asdict(self), "factors": list(self.factors)}
