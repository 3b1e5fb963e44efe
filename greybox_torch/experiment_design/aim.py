"""What is wanted of a recording, and how good an input is for it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from greybox_torch.experiment_design.contender import Contender, Prediction
from greybox_torch.experiment_design.excitation import Excitation
from greybox_torch.experiment_design.separation import deviation, evidence
from greybox_torch.experiment_design.trusted import trusted

DECIDED = 20.0
"""Nats of which a pair of hypotheses counts as half decided: what is far beyond says little more."""

Candidate = tuple[Excitation, ...]
"""An excitation for every input, or for the set point of the loop that drives it."""


@dataclass(frozen=True)
class Aim:
    """What is wanted of a recording, of several hypotheses: evidence between them, or of the first one the deviation of a free parameter.

    ``parameter``: its index among the free ones, None for evidence.
    """

    contenders: tuple[Contender, ...]
    parameter: int | None = None

    @property
    def level(self) -> np.ndarray:
        """Errors (n_y,) in units of which outputs differ, correlated ones counted once: those of the likeliest hypothesis."""
        first = self.contenders[0]
        return first.level * np.sqrt(first.memory)

    def nats(self, along: Sequence[Sequence[Prediction]], record: int) -> np.ndarray:
        """The evidence (n, n) of one record for each hypothesis (row) against each other one (column), rivals being linear.

        Args:
            along: for each hypothesis, what all of them predict on the input that reaches the machine if it is right.
        """
        count = len(along)
        found = np.zeros((count, count))
        for b in range(count):
            rival = along[b][b]
            told = self._of_rival(b, rival, record)
            for a in range(count):
                if a == b:
                    continue
                if along[a][b] is not rival:
                    rival = along[a][b]
                    told = self._of_rival(b, rival, record)
                difference = ((along[a][a].y[record] - rival.y[record]) / self.level).ravel()
                found[a, b] = evidence(difference, *told)
        return found

    def score(self, along: Sequence[Sequence[Prediction]], record: int) -> float:
        """Larger is better: less deviation, or how far the pairs of hypotheses are decided; see :meth:`nats`."""
        if self.parameter is not None:
            slopes, known = self._of_rival(0, along[0][0], record)
            return -float(np.log(deviation(slopes, known, self.parameter)))
        return self.decided(self.nats(along, record))

    def decided(self, nats: np.ndarray) -> float:
        """From 0 to 1: how far pairs are decided, each by the probability that it is about. What no input decides blurs nothing else."""
        shares = np.array([c.probability for c in self.contenders])
        weight = np.outer(shares, shares) * (1.0 - np.eye(len(shares)))
        return float((weight * nats / (nats + DECIDED)).sum() / weight.sum())

    def deviation_after(self, prediction: Prediction, record: int) -> float:
        """The standard deviation of the parameter, in its unit."""
        assert self.parameter is not None
        slopes, known = self._of_rival(0, prediction, record)
        return deviation(slopes, known, self.parameter)

    def _of_rival(self, index: int, prediction: Prediction, record: int) -> tuple[np.ndarray, np.ndarray]:
        """Its slopes (N, n_d) in units of the errors, and what is known of its unknowns: nothing of start states."""
        assert prediction.slopes is not None
        slopes = prediction.slopes[record]
        if self.parameter is not None:
            one = self.contenders[index]
            sizes = np.maximum(np.abs(prediction.y[record]).max(axis=0), self.level)
            slopes = trusted(slopes, one.problem.values[one.free], sizes)
        slopes = slopes / self.level[:, None]
        slopes = slopes.reshape(-1, slopes.shape[-1])
        known = np.zeros((slopes.shape[1],) * 2)
        own = self.contenders[index].information
        known[: len(own), : len(own)] = own
        return slopes, known


@dataclass(frozen=True)
class Trial:
    """A candidate within the limits, what is commanded with it (inputs, and set points of those that a loop drives: (n_u, N)), and how
    good it is.

    ``nats`` (n, n): the evidence for each hypothesis against each other one, once that has been judged with rivals estimated anew.
    """

    candidate: Candidate
    commands: np.ndarray
    score: float
    nats: np.ndarray | None = None
