"""What a fit and a training have in common: estimated parameters, and free runs of every model on all experiments."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from greybox_torch.api.estimated import EstimatedParameter
from greybox_torch.api.result import Result
from greybox_torch.api.scores import score_rows
from greybox_torch.data import DataSet
from greybox_torch.estimate.comparison import Comparison, Score


class EstimatedModel(Result):
    """A result with parameters, and with ``comparisons`` of models by name on the experiments of ``data``."""

    data: DataSet
    comparisons: Mapping[str, Comparison]

    @property
    @abstractmethod
    def parameters(self) -> Mapping[str, EstimatedParameter]:
        """By name: value, standard deviation, unit, bounds, and whether it was fixed."""

    @property
    def parameter_rows(self) -> list[dict[str, Any]]:
        """A row for every parameter, with its name."""
        return [{"name": name, **asdict(entry)} for name, entry in self.parameters.items()]

    @property
    def scores(self) -> list[dict[str, Any]]:
        """A row for every output of every experiment by each model: fit in %, root mean square error in the output's unit."""
        return score_rows(self.data, self._scores)

    @property
    def _scores(self) -> dict[str, tuple[Score, ...]]:
        return {name: own.scores for name, own in self.comparisons.items()}
