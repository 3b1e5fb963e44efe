"""A hypothesis that a new recording is to decide about: what it predicts, and how far its parameters are known."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.errors import NumericalError
from greybox_torch.estimate.correlation_length import correlation_length
from greybox_torch.estimate.problem import Problem, make_problem
from greybox_torch.estimate.simulators import simulator_for
from greybox_torch.experiment_design.closed_loop import under_feedback
from greybox_torch.experiment_design.controller import Loop
from greybox_torch.experiment_design.draws import drawn_with
from greybox_torch.experiment_design.separation import deviation, scaled_inverse
from greybox_torch.experiment_design.side_by_side import begun_each, prepared_each
from greybox_torch.experiment_design.trusted import trusted
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.passes import Pass, Run
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import whole_records


@dataclass(frozen=True)
class Contender:
    """A model with its values and the ``probability`` of being right, on the recordings that it was estimated from.

    ``information`` (n_p, n_p) is what they say of the free parameters: [J]ᵀ[J] of the outputs in units of the errors, over the number of
    samples that errors are correlated for; J as far as it is :func:`trusted`, whatever is designed. ``level`` (n_y,) are the root mean
    square errors, ``memory`` is that number. ``loops``: the controller that a new recording runs under. ``reach`` (n_x,): the largest size
    of each state along the recordings. ``begins``: which of these a next recording begins as, but for the states ``begun_with``.
    """

    name: str
    probability: float
    problem: Problem
    simulator: Simulator
    information: np.ndarray
    level: np.ndarray
    memory: float
    loops: tuple[Loop, ...] = ()
    reach: np.ndarray = field(default_factory=lambda: np.zeros(0))
    begins: int = 0
    begun_with: Mapping[str, float] = field(default_factory=dict)

    @property
    def free(self) -> np.ndarray:
        """Indices of the free parameters."""
        return np.flatnonzero(self.problem.free)

    @property
    def start(self) -> dict[str, float]:
        """The states of the machine itself, without the memory of effects, that a next recording begins with."""
        names = [s.name for s in self.problem.model.plain.states]
        return {name: float(value) for name, value in zip(names, self.first, strict=False)}

    @property
    def first(self) -> np.ndarray:
        """All states (n_x,) that a next recording begins with, before effects' memory has begun as its input says."""
        names, first = [s.name for s in self.problem.model.states], self.problem.initial[self.begins].copy()
        for name, value in self.begun_with.items():
            first[names.index(name)] = value
        return first

    @property
    def begun(self) -> Problem:
        """Its problem with what a next recording begins with in the place of the first start states."""
        return replace(self.problem, initial=np.concatenate([self.first[None], self.problem.initial[1:]]))

    def beginning(self, like: str, given: Mapping[str, float]) -> Contender:
        """The same where a next recording begins as the recording ``like``, if it was estimated from that, but for states ``given``."""
        names = self.problem.records.names
        return replace(self, begins=names.index(like) if like in names else 0, begun_with=given)

    def predicted(
        self,
        records: Records,
        *,
        tangents: bool = True,
        start: np.ndarray | None = None,
        values: np.ndarray | None = None,
    ) -> Prediction:
        """Its free runs of C records with as many samples each, begun as a next recording is to begin.

        Args:
            start: other states (n_x,) or (C, n_x) to begin with, those of the effects' memory among them; by default these begin as the
                input says.
            values: other parameters for each record, (C, n_p).
        """
        steps = int(records.lengths[0])
        driven, problem, first = self._begun(records, start, values)
        run = self.simulator.run(driven, _pass(problem, records, first, tangents))
        assert run.states is not None
        slopes = None if run.dy is None else run.dy[:, :steps]
        return Prediction(run.y[:, :steps], run.states[:, :steps], slopes, first)

    def normals(
        self, records: Records, level: np.ndarray, *, start: np.ndarray | None = None, values: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Of each of C records the matrix [J e]ᵀ[J e], (C, n_d + 1, n_d + 1), and the states (C, n_x) that its run begins with.

        J are the slopes of the outputs, e the recorded outputs less those of the run, both in units of ``level`` (n_y,); the rest is as for
        :meth:`predicted`.
        """
        driven, problem, first = self._begun(records, start, values)
        asked = replace(_pass(problem, records, first, True), keep_states=False, weights=1.0 / level)
        run = self.simulator.run(replace(driven, y=records.y), asked)  # a delay hides no outputs here
        assert run.normal is not None
        return run.normal, first

    def _begun(
        self, records: Records, start: np.ndarray | None, values: np.ndarray | None
    ) -> tuple[Records, Problem, np.ndarray]:
        """The records that drive the model, the problem with the parameters of each, and the states (C, n_x) that they begin with."""
        count, model = len(records.first), self.problem.model
        rows = np.atleast_2d(self.problem.values if values is None else values)
        rows = np.broadcast_to(rows, (count, rows.shape[1]))
        driven = prepared_each(model, records, rows)
        first = np.broadcast_to(self.first if start is None else start, (count, len(model.states)))
        if start is None:
            first = begun_each(model, first, driven, records.first, rows)
        problem = self.problem if values is None else replace(self.problem, values=rows)
        return driven, problem, np.array(first)

    def driven(self, commands: Sequence[np.ndarray], step: float) -> list[np.ndarray]:
        """The inputs (n_u, N) that reach the machine on what is commanded (n_u, N): inputs, and set points of those that a loop drives.

        Args:
            step: the sample time, s.
        """
        return driven_under([self] * len(commands), commands, step)

    def deviation(self, index: int) -> float:
        """The standard deviation of a free parameter after the recordings so far."""
        return deviation(np.zeros((0, len(self.free))), self.information, index)

    def at(self, values: np.ndarray) -> Contender:
        """The same with other parameter values (n_p,)."""
        return replace(self, problem=self.problem.with_values(values))

    def drawn(self, rng: np.random.Generator) -> Contender:
        """The same with parameters drawn from what is known of them (normally distributed, within their bounds)."""
        values = self.problem.values.copy()
        values[self.free] += drawn_with(scaled_inverse(self.information), rng)
        values = np.clip(values, self.problem.lower, self.problem.upper)
        return self.at(values) if self.problem.admissible(values) else self


def driven_under(machines: Sequence[Contender], commands: Sequence[np.ndarray], step: float) -> list[np.ndarray]:
    """:meth:`Contender.driven` of one hypothesis with several values of its parameters, each on commands (n_u, N) of its own."""
    first = machines[0]
    if not first.loops:
        return list(commands)
    values = np.array([one.problem.values for one in machines])
    return under_feedback(first.begun, first.simulator, first.loops, values, commands, step)


@dataclass(frozen=True)
class Prediction:
    """Outputs ``y`` (C, N, n_y) and ``states`` (C, N, n_x) of C records; ``slopes`` (C, N, n_y, n_d), the outputs' derivatives by the free
    parameters and start states; ``start`` (C, n_x), the states that they begin with.
    """

    y: np.ndarray
    states: np.ndarray
    slopes: np.ndarray | None
    start: np.ndarray


def contender(
    name: str,
    probability: float,
    model: GreyBoxModel,
    data: DataSet,
    starts: Mapping[str, Mapping[str, float]],
    loops: Sequence[Loop] = (),
) -> Contender:
    """A hypothesis on the recordings of ``data`` that it was estimated from, holding its values.

    Args:
        starts: its start states, by recording and state.
        loops: the controller that a new recording runs under.

    Raises:
        NumericalError: it cannot be simulated on any of them.
    """
    used = [r for r in data.recordings if r.name in starts] or list(data.estimation())
    problem = make_problem(data, model, used)
    initial = problem.initial.copy()
    for e, recording in enumerate(used):
        for i, state in enumerate(model.states):
            initial[e, i] = starts.get(recording.name, {}).get(state.name, initial[e, i])
    problem = replace(problem, initial=initial)
    simulator = simulator_for(problem)
    records = problem.driving_records
    run = simulator.run(records, _pass(problem, problem.records, initial, True))
    information, level, memory = _known(problem, run)
    if not np.isfinite(level).all():
        raise NumericalError(
            f"{name}: its simulation of {', '.join(r.name for r in used)} overflows; nothing can be designed with it"
        )
    assert run.states is not None
    along = np.concatenate([run.states[e, :length] for e, length in enumerate(problem.records.lengths)])
    reach = np.abs(along).max(axis=0)
    return Contender(name, probability, problem, simulator, information, level, memory, tuple(loops), reach)


def _pass(problem: Problem, records: Records, starts: np.ndarray, tangents: bool) -> Pass:
    n_x = len(problem.model.states)
    directions = np.eye(n_x)[problem.free_states]
    return Pass(
        whole_records(records),
        problem.values,
        starts,
        tangents=tangents,
        start_directions=np.broadcast_to(directions, (len(starts), *directions.shape)) if tangents else None,
        keep_states=True,
    )


def _known(problem: Problem, run: Run) -> tuple[np.ndarray, np.ndarray, float]:
    """Information on the parameters, error level by output, and samples that errors are correlated for, from the runs of its recordings."""
    errors, slopes, starts = [], [], int(problem.initial_free.sum())
    count = int(problem.free.sum())
    assert run.dy is not None
    for e, length in enumerate(problem.records.lengths):
        measured = problem.records.y[:, problem.records.span(e)].T
        errors.append(measured - run.y[e, :length])
        own = np.zeros((length, len(measured[0]), count + starts * len(problem.initial)))
        sizes = np.fmax(np.abs(run.y[e, :length]).max(axis=0), np.abs(errors[-1]).max(axis=0))
        # for every design: derivatives that have grown without bound would determine everything, and let no rival move
        seen, at = trusted(run.dy[e, :length], problem.values[problem.free], sizes), count + e * starts
        own[..., :count], own[..., at : at + starts] = seen[..., :count], seen[..., count:]
        slopes.append(own)
    level = np.sqrt(np.nanmean(np.concatenate(errors) ** 2, axis=0))
    memory = max(correlation_length(column[~np.isnan(column)]) for e in errors for column in e.T)
    known = ~np.isnan(np.concatenate(errors))
    flat = (np.concatenate(slopes) / level[:, None])[known]
    return _without_starts(np.nan_to_num(flat.T @ flat), count) / memory, level, memory


def _without_starts(whole: np.ndarray, count: int) -> np.ndarray:
    """The information on the first ``count`` unknowns where the others are unknown too (Schur complement)."""
    mixed = whole[:count, count:]
    return whole[:count, :count] - mixed @ scaled_inverse(whole[count:, count:]) @ mixed.T
