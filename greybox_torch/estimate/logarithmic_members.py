"""A population that descends on the scale of logarithms, see :mod:`greybox_torch.estimate.logarithmic`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.logarithmic import SMALLEST, Scale
from greybox_torch.estimate.population import Members, Population


@dataclass(frozen=True)
class LogarithmicMembers(Members):
    """As :class:`Members`, with those unknowns seen as logarithms that are positive where each member begins and cannot be negative."""

    scale: Scale

    @staticmethod
    def of(members: Members, begun: Population) -> LogarithmicMembers:
        """For a population that begins as ``begun``."""
        scale = Scale.of(members.unknowns(begun), members.bounds[0])
        return LogarithmicMembers(members.problem, members.records, members.simulator, scale)

    @property
    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lower and upper bounds (M, d), as every member sees them."""
        low, high = super().bounds
        logarithmic = self.scale.logarithmic
        least = self.scale.seen(np.where(logarithmic, np.maximum(low, SMALLEST), low))
        return least, self.scale.seen(np.broadcast_to(high, logarithmic.shape))

    def unknowns(self, population: Population) -> np.ndarray:
        """The unknowns (M, d) of a population as they are seen."""
        return self.scale.seen(super().unknowns(population))

    def at(self, population: Population, z: np.ndarray) -> Population:
        """The population with its unknowns set to what is seen as ``z`` (M, d); costs are not known yet."""
        return super().at(population, self.scale.meant(z))

    def normals(self, population: Population) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """As :meth:`Members.normals`, by what is seen of the unknowns."""
        cost, gradient, hessian = super().normals(population)
        slopes = self.scale.slopes(super().unknowns(population))
        with np.errstate(all="ignore"):  # of members that are lost
            return cost, gradient * slopes, hessian * slopes[:, :, None] * slopes[:, None, :]
