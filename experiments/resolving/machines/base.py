"""What these machines have beyond those of the workshop: limits, and the input of a recording that somebody asks for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

from experiments.concealed.workshop.plant import Machine

MODELS = Path(__file__).parents[1] / "models"


@dataclass(frozen=True)
class Question:
    """What first recordings leave open: ``plans`` of a machine, of which a case conceals one, and how visible it is (times the noise)."""

    name: str
    machine: str
    plans: tuple[str, ...]
    visibility: tuple[float, float]


class Limited(Machine):
    """A machine of the workshop with ``limits`` by channel, and sensors as good as the visibility asks for."""

    limits: ClassVar[Mapping[str, tuple[float, float]]]
    experiments = 2

    @property
    def model_file(self) -> Path:
        return MODELS / f"{self.name}.py"
