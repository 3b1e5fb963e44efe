"""The screen: which effects would explain what the model does not, by a score test without a single refit.

At the fitted parameters, the output's sensitivity to the amplitude of an effect that is not there is one more tangent of the pass that
computes the sensitivities anyway. Tangents of parameters and window start states are projected out; the share of the residual that
the rest explains ranks the candidate.

Source: C. R. Rao, score test, 1948; N. R. Kristensen, H. Madsen, S. B. Jørgensen, Automatica 40(2), 2004, for the idea of asking the
data which equation is deficient.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.diagnosis.screen.linear_answer import LinearAnswer
from greybox_torch.estimate.carried_starts import carried_starts
from greybox_torch.estimate.problem import Problem, problem_for
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.linear_algebra import cholesky, solve
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Probe, Surroundings
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.packed_normals import PackedNormals
from greybox_torch.simulation.passes import Pass, Probes
from greybox_torch.simulation.simulator import SimulationOptions, Simulator


@dataclass(frozen=True)
class ScreenScore:
    """What one probe of one attachment explains at one window length.

    ``explained`` is the share of the residual's energy after projection, ``size`` the estimated values of the probe's directions.
    """

    attachment: Attachment
    probe: Probe
    length: int
    explained: float
    size: np.ndarray


@dataclass(frozen=True)
class Screen:
    """A compiled screen of some attachments around a model with ``accepted`` effects."""

    base: GreyBoxModel
    accepted: tuple[Attachment, ...]
    probed: tuple[tuple[Attachment, Probe], ...]
    model: AugmentedModel
    simulator: Simulator
    directions: tuple[tuple[str, ...], ...]
    free_names: tuple[str, ...]

    @staticmethod
    def of(
        base: GreyBoxModel,
        accepted: Sequence[Attachment],
        attachments: Sequence[Attachment],
        surroundings: Mapping[str, Surroundings],
        free_names: Sequence[str],
        options: SimulationOptions,
    ) -> Screen:
        """Prepare the screen of ``attachments``."""
        probed, labelled = [], []
        for attachment in attachments:
            for probe in attachment.mechanism.probes(surroundings[attachment.port]):
                probed.append((attachment, probe))
                labelled.append(replace(attachment, label=f"#{len(probed)}"))
        model = AugmentedModel(base, [*accepted, *labelled], surroundings, probed=labelled)
        directions = tuple(
            tuple(f"{a.prefix}.{d}" for d in probe.directions) for a, (_, probe) in zip(labelled, probed, strict=True)
        )
        zero = [name for group in directions for name in group]
        simulator = Simulator.of(model, [*free_names, *zero], options, at_zero=zero)
        return Screen(base, tuple(accepted), tuple(probed), model, simulator, directions, tuple(free_names))

    @property
    def probes(self) -> Probes:
        """Which products of its directions are wanted: those of the same probe."""
        sizes = [len(group) for group in self.directions]
        return Probes(sum(sizes), max(sizes) - 1)

    def values(self, problem: Problem) -> np.ndarray:
        """Parameter vector of the screen's model: the problem's values, the probes' values, zero in the directions."""
        numbers = problem.values_by_name
        for group, (_, probe) in zip(self.directions, self.probed, strict=True):
            prefix = group[0].rpartition(".")[0]
            numbers |= {f"{prefix}.{name}": value for name, value in probe.values.items()}
            numbers |= dict.fromkeys(group, 0.0)
        return np.array([numbers.get(p.name, p.value) for p in self.model.declared_parameters])

    def scores(self, fitted: WindowFit, starts: np.ndarray | None = None) -> list[ScreenScore]:
        """Score every probe on windows whose parameters and start states were fitted.

        Args:
            starts: what :meth:`starts` gave for the same windows, where only the probes' values have changed since.
        """
        answer = LinearAnswer.of(self.projected(fitted, starts).total(), fitted)
        _, before = answer.beside_parameters(np.arange(0))
        results, at = [], len(self.free_names)
        for group, (attachment, probe) in zip(self.directions, self.probed, strict=True):
            size, left = answer.beside_parameters(np.arange(at, at + len(group)))
            at += len(group)
            explained = (before - left) / max(before, 1e-300)
            results.append(ScreenScore(attachment, probe, fitted.windows.steps, explained, size))
        return results

    def with_probes(self, values: Sequence[Mapping[str, float]]) -> Screen:
        """The same compiled screen looking at other shapes: new values for every probe, in order."""
        probed = tuple((a, replace(p, values={**p.values, **v})) for (a, p), v in zip(self.probed, values, strict=True))
        return replace(self, probed=probed)

    def projected(self, fitted: WindowFit, starts: np.ndarray | None = None) -> Projected:
        """Normal matrices of [parameters, probes, residual] with the window start states projected out; ``starts`` as in :meth:`scores`."""
        problem, windows = fitted.problem, fitted.windows
        values = self.values(problem)
        starts = self.starts(fitted) if starts is None else starts
        free = self._places(fitted)[~fitted.problem.carried]
        eye = np.broadcast_to(np.eye(starts.shape[1])[free], (len(windows.start), len(free), starts.shape[1]))
        run = self.simulator.run(
            self.model.settled(self.model.prepared(problem.records, values), values),
            Pass(
                windows,
                values,
                starts,
                tangents=True,
                start_directions=eye,
                weights=problem.weights,
                probes=self.probes,
            ),
        )
        assert run.packed is not None
        return Projected.of(run.packed, len(self.free_names), len(free))

    def starts(self, fitted: WindowFit) -> np.ndarray:
        """Window starts of the screen's model: the fitted ones, memories carried along from window to window."""
        values = self.values(fitted.problem)
        own = self._places(fitted)
        problem = problem_for(
            fitted.problem, self.model, dict(zip((p.name for p in self.model.declared_parameters), values, strict=True))
        )
        experiment = problem.records.experiments(fitted.windows.start)
        starts = problem.initial[experiment]
        starts[:, own] = fitted.starts
        starts = self.model.begun(starts, problem.driving_records, fitted.windows.start, values)
        carried = ~np.isin(np.arange(starts.shape[1]), own)
        return carried_starts(replace(problem, carried=carried), self.simulator, fitted.windows, starts)

    def _places(self, fitted: WindowFit) -> np.ndarray:
        """Where the fitted model's states stand among those of the screen's model, which adds some before memories and some behind."""
        names = [s.name for s in self.model.states]
        return np.array([names.index(s.name) for s in fitted.problem.model.states])


@dataclass(frozen=True)
class Projected:
    """Normal matrices of [parameters, probes, residual] without what the window start states explain.

    ``packed``, with the start states before the residual; ``explained`` (W, n_x, d), the whitened share of them in every column, of
    which the matrices are to lose the products; ``keep`` (d,) the columns that are left.
    """

    packed: PackedNormals
    explained: np.ndarray
    keep: np.ndarray

    @staticmethod
    def of(packed: PackedNormals, n_p: int, n_base: int) -> Projected:
        """Project ``n_base`` start states, the last columns but one, out of ``packed``; the first ``n_p`` columns are the model's own."""
        d = packed.size - 1 - n_base
        packed = _sound(packed, np.r_[:n_p, d : packed.size])
        rows = packed.rows(np.arange(d, d + n_base))
        own = rows[:, :, d : d + n_base]
        diagonal = np.einsum("wii->wi", own)
        least = 1e-12 * diagonal.max(axis=0, initial=0.0) + 1e-300  # of each state; windows that failed are all zero
        lower = cholesky(own + np.eye(n_base) * (1e-9 * diagonal + least)[:, :, None])
        keep = np.append(np.arange(d), d + n_base)
        return Projected(packed, solve(lower, rows[:, :, keep]), keep)

    def total(self) -> np.ndarray:
        """The sum (d, d) over all windows."""
        stacked = self.explained.reshape(-1, len(self.keep))
        return self.packed.total()[np.ix_(self.keep, self.keep)] - stacked.T @ stacked

    def energy(self) -> float:
        """The residual's energy."""
        return float(self.packed.diagonal()[:, -1].sum() - (self.explained[:, :, -1] ** 2).sum())

    def blocks(self, columns: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """By window, the blocks (W, K, k, k) of groups of ``columns`` (K, k) and their products with the residual (W, K, k)."""
        part, last = self.explained[:, :, columns], self.explained[:, :, -1]
        residual = self.packed.rows(np.array([self.packed.size - 1]))[:, 0, columns]
        inner = self.packed.blocks(columns) - np.einsum("wska,wskb->wkab", part, part, optimize=True)
        return inner, residual - np.einsum("wska,ws->wka", part, last, optimize=True)


def _sound(packed: PackedNormals, base: np.ndarray) -> PackedNormals:
    """Zeros where something is not finite.

    A window in which the model itself fails (the columns ``base``) is passed over; a probe that fails in some window, everywhere.
    """
    finite = np.isfinite(packed.diagonal())
    if finite.all():
        return packed
    lost = np.logical_not(finite[:, base].all(axis=1))
    return packed.without(lost, np.logical_not(finite[~lost].all(axis=0)))
