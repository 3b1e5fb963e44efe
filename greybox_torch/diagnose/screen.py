"""The screen: which effects would explain what the model does not, by a score test without a single refit.

At the fitted parameters, the output's sensitivity to the amplitude of an effect that is not there is one more tangent of the pass that
computes the sensitivities anyway. Tangents of parameters and window start states are projected out; the share of the residual that
the rest explains, on stretches that took no part in choosing its size, ranks the candidate.

Source: C. R. Rao, score test, 1948; N. R. Kristensen, H. Madsen, S. B. Jørgensen, Automatica 40(2), 2004, for the idea of asking the
data which equation is deficient.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.estimate.problem import Problem, problem_for
from greybox_torch.estimate.window_fit import WindowFit, carried_starts
from greybox_torch.mechanisms.attachment import Attachment, AugmentedModel
from greybox_torch.mechanisms.mechanism import Probe, Surroundings
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulate.stepper import Stepper, make_stepper

FOLDS = 6


@dataclass(frozen=True)
class Look:
    """What one probe of one attachment explains at one window length.

    ``explained`` is the share of the residual's energy after projection, ``predicted`` that on stretches left out, ``size`` the
    estimated values of the probe's directions.
    """

    attachment: Attachment
    probe: Probe
    length: int
    explained: float
    predicted: float
    size: np.ndarray


@dataclass(frozen=True)
class Screen:
    """A compiled screen of some attachments around a model with ``accepted`` effects."""

    base: GreyBoxModel
    accepted: tuple[Attachment, ...]
    looks: tuple[tuple[Attachment, Probe], ...]
    model: AugmentedModel
    stepper: Stepper
    directions: tuple[tuple[str, ...], ...]
    free_names: tuple[str, ...]

    @staticmethod
    def of(
        base: GreyBoxModel,
        accepted: Sequence[Attachment],
        attachments: Sequence[Attachment],
        surroundings: Mapping[str, Surroundings],
        free_names: Sequence[str],
        *,
        device: str = "cpu",
    ) -> Screen:
        """Prepare the screen of ``attachments``."""
        looks, labelled = [], []
        for attachment in attachments:
            for probe in attachment.mechanism.probes(surroundings[attachment.port]):
                looks.append((attachment, probe))
                labelled.append(replace(attachment, label=f"#{len(looks)}"))
        model = AugmentedModel(base, [*accepted, *labelled], surroundings, probed=labelled)
        directions = tuple(
            tuple(f"{a.prefix}.{d}" for d in probe.directions) for a, (_, probe) in zip(labelled, looks, strict=True)
        )
        zero = [name for group in directions for name in group]
        stepper = make_stepper(model, [*free_names, *zero], at_zero=zero, device=device)
        return Screen(base, tuple(accepted), tuple(looks), model, stepper, directions, tuple(free_names))

    def values(self, problem: Problem) -> np.ndarray:
        """Parameter vector of the screen's model: the problem's values, the probes' values, zero in the directions."""
        numbers = dict(zip(problem.names, problem.values, strict=True))
        for group, (_, probe) in zip(self.directions, self.looks, strict=True):
            prefix = group[0].rpartition(".")[0]
            numbers |= {f"{prefix}.{name}": value for name, value in probe.values.items()}
            numbers |= dict.fromkeys(group, 0.0)
        return np.array([numbers.get(p.name, p.value) for p in self.model.declared_parameters])

    def look(self, fitted: WindowFit, substeps: int) -> list[Look]:
        """Score every probe on windows whose parameters and start states were fitted."""
        normal = self.matrices(fitted, substeps)
        n_p = len(self.free_names)
        hold = _hold(fitted, n_p)
        total = normal.sum(axis=0)
        parts = [normal[f].sum(axis=0) for f in np.array_split(np.arange(len(normal)), min(FOLDS, len(normal)))]
        results, at = [], n_p
        for group, (attachment, probe) in zip(self.directions, self.looks, strict=True):
            columns = np.arange(at, at + len(group))
            at += len(group)
            explained, size = _explained(total, n_p, columns, hold)
            predicted = _predicted(total, parts, n_p, columns, hold)
            results.append(Look(attachment, probe, fitted.windows.steps, explained, predicted, size))
        return results

    def with_probes(self, values: Sequence[Mapping[str, float]]) -> Screen:
        """The same compiled screen looking at other shapes: new values for every probe, in order."""
        looks = tuple((a, replace(p, values={**p.values, **v})) for (a, p), v in zip(self.looks, values, strict=True))
        return replace(self, looks=looks)

    def matrices(self, fitted: WindowFit, substeps: int) -> np.ndarray:
        """Per window the normal matrix (W, d, d) of [parameters, probes, residual], window start states projected out."""
        problem, windows = fitted.problem, fitted.windows
        values = self.values(problem)
        tape = self.model.prepared(problem.tape, values)
        starts = self._starts(fitted, values, substeps)
        count, n_base = len(windows.start), fitted.starts.shape[1]
        eye = np.zeros((count, n_base, starts.shape[1]))
        eye[:, np.arange(n_base), np.arange(n_base)] = 1.0
        run = self.stepper.run(
            tape,
            windows,
            values,
            starts,
            tangents=True,
            start_directions=eye,
            substeps=substeps,
            weights=problem.weights,
        )
        assert run.normal is not None
        d = run.normal.shape[1] - 1 - n_base
        full = _sound(run.normal, np.r_[: len(self.free_names), d : d + n_base + 1])
        keep = np.append(np.arange(d), d + n_base)
        own, cross = full[:, d : d + n_base, d : d + n_base], full[:, keep, d : d + n_base]
        diagonal = np.einsum("wii->wi", own)
        least = 1e-12 * diagonal.max() + 1e-300  # windows that failed are all zero
        own = own + np.eye(n_base) * (1e-9 * diagonal + least)[:, :, None]
        return full[:, keep[:, None], keep] - cross @ np.linalg.solve(own, np.swapaxes(cross, 1, 2))

    def _starts(self, fitted: WindowFit, values: np.ndarray, substeps: int) -> np.ndarray:
        """Window starts of the screen's model: the fitted ones, memories carried along from window to window."""
        n_base = fitted.starts.shape[1]
        problem = problem_for(
            fitted.problem, self.model, dict(zip((p.name for p in self.model.declared_parameters), values, strict=True))
        )
        experiment = np.searchsorted(problem.tape.first, fitted.windows.start, side="right") - 1
        starts = problem.initial[experiment]
        starts[:, :n_base] = fitted.starts
        starts = self.model.begun(starts, problem.driving_tape, fitted.windows.start, values)
        carried = np.arange(starts.shape[1]) >= n_base
        return carried_starts(replace(problem, carried=carried), self.stepper, fitted.windows, starts, substeps)


def _sound(normal: np.ndarray, base: np.ndarray) -> np.ndarray:
    """Normal matrices (W, d, d) with zeros where something is not finite.

    A window in which the model itself fails (the rows ``base``) is passed over; a probe that fails in some window, everywhere.
    """
    finite = np.isfinite(np.einsum("wii->wi", normal))
    if finite.all():
        return normal
    lost = ~finite[:, base].all(axis=1)
    bad = ~finite[~lost].all(axis=0)
    return np.where(lost[:, None, None] | (bad[:, None] | bad[None, :])[None], 0.0, normal)


def _hold(fitted: WindowFit, n_p: int) -> np.ndarray:
    """Curvature (n_p,) that keeps the linear answer near the parameters it is valid for: steps beyond their own size cost."""
    values = fitted.problem.values[fitted.problem.free]
    scale = np.where(values != 0.0, values, np.inf)
    return 10.0 * fitted.mean_square / scale[:n_p] ** 2


def _solve(matrix: np.ndarray, unknown: np.ndarray, hold: np.ndarray) -> np.ndarray:
    """Least-squares values of ``unknown`` columns (the first of which are held) for the residual in the last column."""
    inner = matrix[np.ix_(unknown, unknown)].copy()
    inner[np.arange(len(hold)), np.arange(len(hold))] += hold
    diagonal = np.diag(inner)
    scale = np.where(diagonal > 0, 1.0 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0)), 0.0)
    scaled = inner * scale[:, None] * scale[None, :] + 1e-9 * np.eye(len(scale))
    return scale * np.linalg.solve(scaled, matrix[unknown, -1] * scale)


def _energy(matrix: np.ndarray, unknown: np.ndarray, size: np.ndarray) -> float:
    """Residual energy left when ``unknown`` columns take the values ``size``."""
    inner = matrix[np.ix_(unknown, unknown)]
    return float(matrix[-1, -1] - 2 * size @ matrix[unknown, -1] + size @ inner @ size)


def _explained(total: np.ndarray, n_p: int, columns: np.ndarray, hold: np.ndarray) -> tuple[float, np.ndarray]:
    base, both = np.arange(n_p), np.concatenate([np.arange(n_p), columns])
    before = _energy(total, base, _solve(total, base, hold))
    size = _solve(total, both, hold)
    return (before - _energy(total, both, size)) / max(before, 1e-300), size[n_p:]


def _predicted(
    total: np.ndarray, parts: Sequence[np.ndarray], n_p: int, columns: np.ndarray, hold: np.ndarray
) -> float:
    base, both = np.arange(n_p), np.concatenate([np.arange(n_p), columns])
    before = after = 0.0
    for part in parts:
        rest = total - part
        before += _energy(part, base, _solve(rest, base, hold))
        after += _energy(part, both, _solve(rest, both, hold))
    return (before - after) / max(before, 1e-300)
