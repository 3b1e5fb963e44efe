"""Where the validation experiments take a network: out of the range that it was learned over, it only extrapolates."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.digits import digits
from greybox_torch.estimate.comparison import Comparison
from greybox_torch.estimate.problem import all_starts_free, make_problem, problem_for
from greybox_torch.in_unit import in_unit
from greybox_torch.mechanisms.network import spoken
from greybox_torch.model import GreyBoxModel
from greybox_torch.training import Trained
from greybox_torch.training.learned_force import visited_signals

MARGIN = 0.01
"""Share of the range that was learned over by which a signal may leave it."""

LEAST = 0.01
"""Share of the validation samples outside from which that is told."""


@dataclass(frozen=True)
class Beyond:
    """A signal of the network, in ``unit``, that leaves the range ``learned`` in a ``share`` of the validation samples, in which it moves
    over ``visited``. Both along free runs of the hybrid.
    """

    signal: str
    unit: str
    learned: tuple[float, float]
    visited: tuple[float, float]
    share: float

    @property
    def sentence(self) -> str:
        """For a reader."""
        (low, high), (least, most) = self.learned, self.visited
        learned = f"{low:.3g} to {in_unit(f'{high:.3g}', self.unit)}"
        visited = f"{least:.3g} to {in_unit(f'{most:.3g}', self.unit)}"
        return (
            f"In {digits(100 * self.share)} % of the validation samples the network's {spoken(self.signal)} is outside the range over "
            f"which it learned ({learned}; in validation {visited}): what the network says there is extrapolated."
        )

    def as_json(self) -> dict[str, Any]:
        """An entry of `validation`."""
        return asdict(self)


def beyond_learned(data: DataSet, model: GreyBoxModel, found: Trained, run: Comparison) -> tuple[Beyond, ...]:
    """The signals of the network that the validation experiments take out of the range that it was learned over.

    Args:
        run: the hybrid's free runs of all experiments.
    """
    recordings = data.validation()
    if found.physics_chosen or not recordings:
        return ()
    plain = make_problem(data, model, recordings)
    hybrid = all_starts_free(data, problem_for(plain, found.result.problem.model, {})).with_values(
        found.result.problem.values
    )
    places = [run.experiments.index(recording.name) for recording in recordings]
    hybrid = replace(hybrid, initial=np.stack([run.initial[e] for e in places]))
    learned, visited = visited_signals(found), visited_signals(found, hybrid)
    units = found.hybrid.surroundings[found.hybrid.network.port].units
    told = [_beyond(name, units.get(name, ""), learned[name], visited[name]) for name in learned]
    return tuple(one for one in told if one is not None)


def _beyond(name: str, unit: str, learned: np.ndarray, visited: np.ndarray) -> Beyond | None:
    """None where the signal keeps to the range, or where nothing finite is known of it."""
    learned, visited = learned[np.isfinite(learned)], visited[np.isfinite(visited)]
    if not len(learned) or not len(visited):
        return None
    low, high = float(learned.min()), float(learned.max())
    margin = MARGIN * (high - low)
    share = float(np.mean((visited < low - margin) | (visited > high + margin)))
    if share < LEAST:
        return None
    return Beyond(name, unit, (low, high), (float(visited.min()), float(visited.max())), share)
