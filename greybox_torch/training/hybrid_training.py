"""From a data set and a model to the trained hybrid: physics first, then Adam on windows, then Gauss-Newton on whole records."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.errors import NumericalError, UserError
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.metrics import final_prediction_error
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.surroundings import survey
from greybox_torch.estimate.termination import Termination
from greybox_torch.estimate.uncertainty import uncertainty
from greybox_torch.mechanisms.network import Network
from greybox_torch.model import GreyBoxModel, Port
from greybox_torch.simulation.simulator import SimulationOptions, Simulator
from greybox_torch.training.curriculum import Curriculum, descend
from greybox_torch.training.gradients import make_gradient
from greybox_torch.training.gradients.tangents import TangentsGradient
from greybox_torch.training.hybrid import USUAL_SIGNALS, Hybrid, attach_network, check_signals, chosen_net, network_at
from greybox_torch.training.keeper import Keeper
from greybox_torch.training.physics import Physics, estimate_physics, training_problem, with_physics
from greybox_torch.training.polish import Polished, polish
from greybox_torch.training.settings import TrainingSettings
from greybox_torch.training.signal_names import readable
from greybox_torch.training.snapshot import Snapshot, check_snapshot, check_unknowns, load_snapshot
from greybox_torch.training.stages import fitted_starts, held_out_samples, stage, window_lengths
from greybox_torch.training.state import TrainingState
from greybox_torch.training.trained import Report, Trained
from greybox_torch.training.unknowns import Unknowns


def train_hybrid(
    data: DataSet,
    model: GreyBoxModel,
    *,
    net: str | None = None,
    port: str | None = None,
    signals: Sequence[str] = (),
    network: dict[str, Any] | None = None,
    settings: TrainingSettings | None = None,
    physics: Physics | None = None,
    device: str = "cpu",
    progress: Callable[[Report], None] | None = None,
    snapshot: Path | None = None,
    resume: bool = False,
) -> Trained:
    """Estimate ``model`` on the experiments of role "estimation", attach a network, and train it.

    Args:
        data: the experiments, from :func:`greybox_torch.load_dataset` or made with ``DataSet(…)``.
        model: the physics, without a network.
        net: "friction" (a body's speed, and what else is asked for) or "residual" (any signals at any port), or "memory" (the
            same with hidden states); by default friction at a body, else residual.
        port: where; the driving body by default, and the first port of a model without bodies.
        signals: what it reads, by their names at the port.
        network: further arguments of :class:`FrictionNet`, :class:`ResidualNet` or :class:`MemoryNet`: units, seed, odd, dissipative,
            memories.
        settings: of the training, its seed among them; by default ``TrainingSettings()``.
        physics: ``model`` as :func:`fit_physics` has estimated it before, so that several trainings share that; estimated here otherwise.
        device: "cpu", "cuda" or "cuda:N".
        progress: is called with what is being done, and at the end of every epoch.
        snapshot: a file that the training can be taken up from; it is written at most every half a second.
        resume: take it up from there.

    Raises:
        UserError: no estimation experiment, a port, network or signal that there is not, records that are too short, or a snapshot that
            is not of this training.
        NumericalError: the simulation overflows even over short windows.
    """
    began, settings, tell = time.perf_counter(), settings or TrainingSettings(), progress or (lambda report: None)
    net = chosen_net(model, net, port)
    site, learner = network_at(model, net, port, signals, **{"seed": settings.seed, **(network or {})})
    problem = training_problem(data, model) if physics is None else physics.result.problem
    lengths = tuple(window_lengths(problem.records, settings))
    about = {
        "data": data.sha256,
        "model": model.title,
        "start": problem.values.tolist(),
        "free": list(problem.free_names),
        "port": site.name,
        "network": {"kind": net, **learner.options(), "inputs": list(learner.inputs)},
        "settings": settings.as_json(),
    }
    if resume:
        check_snapshot(_path(snapshot), about)
    plain = Simulator.of(model, problem.free_names, SimulationOptions(device))
    _check_signals_early(problem, plain, site, learner)
    tell(Report("estimating the physics"))
    alone = physics or estimate_physics(problem, plain, lengths, settings.seed)
    before = load_snapshot(_path(snapshot), about, alone) if resume else None
    alone = alone if before is None else before.physics
    result = alone.result
    plain = plain.with_substeps(result.substeps)
    surroundings = survey(model, result.problem, plain)
    hybrid = attach_network(result.problem, site.name, learner, surroundings)
    hybrid = _frozen(hybrid) if settings.freeze_physics else _begun(hybrid, alone.values)
    if before is not None:
        check_unknowns(_path(snapshot), before, int(hybrid.problem.free.sum()), len(hybrid.problem.model.states))
    simulator = plain.for_model(hybrid.problem.model, hybrid.problem.free_names)
    course = _course(hybrid, simulator, settings, lengths, before)
    state = TrainingState.new(course.unknowns.start, settings.seed) if before is None else before.state
    kept = Keeper(snapshot, about, alone, course)

    def on_epoch(now: TrainingState) -> None:
        kept(now)
        share = (now.stage + now.epoch / settings.epochs) / len(lengths)
        tell(Report(f"windows of {lengths[now.stage]} samples", share, now.history[-1]))

    try:
        descend(course, state, on_epoch)
    finally:
        kept.last()
    polished = polish(course, state.z, result.problem, plain, lambda what: tell(Report(what, 1.0)))
    augmented = _result(polished, simulator)
    seconds = time.perf_counter() - began
    return Trained(result, augmented, hybrid, polished, tuple(state.history), settings, seconds, course)


def _check_signals_early(problem: Problem, plain: Simulator, site: Port, learner: Network) -> None:
    """Refuses a wrong signal before the estimate, which may take minutes, where the model can be simulated with its start values.

    Whether a coupling has a load depends on the parameters: that is left to the check behind the estimate.
    """
    if set(learner.needs) <= {*USUAL_SIGNALS[site.kind], "load"}:
        return
    try:
        around = survey(problem.model, problem, plain)[site.name]
    except NumericalError:
        return
    if not set(learner.needs) <= {*readable(around), "load"}:
        check_signals(learner, problem.model.plain, site, around)


def _path(snapshot: Path | None) -> Path:
    if snapshot is None:
        raise UserError("resume: True needs a snapshot to take the training up from")
    return snapshot


def _frozen(hybrid: Hybrid) -> Hybrid:
    """Only the network is free."""
    free = hybrid.problem.free & hybrid.is_network
    return replace(hybrid, problem=replace(hybrid.problem, free=free))


def _begun(hybrid: Hybrid, values: np.ndarray) -> Hybrid:
    """The physics at ``values``, from short windows."""
    return replace(hybrid, problem=with_physics(hybrid.problem, values))


def _course(
    hybrid: Hybrid,
    simulator: Simulator,
    settings: TrainingSettings,
    lengths: tuple[int, ...],
    before: Snapshot | None,
) -> Curriculum:
    problem = hybrid.problem
    mask = held_out_samples(problem.records, lengths[-1], settings)
    if before is None:
        starts = fitted_starts(problem, simulator, lengths[0])
        batch = stage(problem, lengths[0], starts, mask, settings.warm_up).training_batch
        run = TangentsGradient(problem, simulator).normal(problem.values, batch)
        samples = max(batch.samples, 1)
        mean_square = max(float(run[-1, -1]) / samples, 1e-12 * _spread(problem) ** 2)
        unknowns = Unknowns.of(hybrid, np.diag(run)[:-1] / samples, mean_square)
    else:
        mean_square, rest = before.mean_square, hybrid.problem.values[problem.free] / before.scale
        heights, own = hybrid.heights[problem.free], hybrid.is_network[problem.free]
        unknowns = Unknowns(hybrid, before.scale, np.where(heights, 0.0, rest), own)
    gradient = make_gradient(settings.gradient, problem, simulator)
    return Curriculum(unknowns, simulator, gradient, settings, lengths, mask, mean_square, _spread(problem))


def _spread(problem: Problem) -> float:
    """Root mean square of the weighted outputs about their means."""
    return float(np.sqrt(np.mean(np.nanvar(problem.records.y * problem.weights[:, None], axis=1))))


def _result(polished: Polished, simulator: Simulator) -> Estimation:
    """The hybrid's estimate in the form of any other; deviations allow for the weights, which the data seldom determine one by one."""
    problem, optimum = polished.problem, polished.optimum
    run = FreeRun(problem, simulator)
    here = run.quadratic(run.start)
    mse = float("inf") if here is None else 2.0 * here.cost / problem.samples
    return Estimation(
        problem=problem,
        mse=mse,
        fpe=final_prediction_error(mse, len(run.start), problem.samples),
        samples=problem.samples,
        iterations=0 if optimum is None else optimum.iterations,
        evaluations=0 if optimum is None else optimum.evaluations,
        termination=Termination.stalled if optimum is None else optimum.termination,
        uncertainty=None if here is None else uncertainty(run, run.start),
        substeps=simulator.substeps,
    )
