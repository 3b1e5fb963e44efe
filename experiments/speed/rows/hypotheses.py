"""Row 7: what 100 hypothetical effects add to a pass over short windows."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from experiments.speed.records import SAMPLES, simulated_problem
from experiments.speed.row import Entry, Row, Target, apart
from experiments.speed.rows import Needs, Progress
from experiments.speed.settings import Settings
from experiments.speed.timing import interleaved, once
from greybox_torch import Surroundings
from greybox_torch.diagnosis.screen import Screen, candidates
from greybox_torch.estimate import Problem, WindowFit, shifted_states, survey
from greybox_torch.mechanisms import Attachment
from greybox_torch.simulation import DEFAULT, Pass, Simulator, cut, whole_records

TITLE = "100 hypothesis columns over windows of 310 samples, 4 experiments"
NEEDS = Needs()
COLUMNS, LENGTH = 100, 310
PLAIN, COLUMNS_PASS = "pass with 12 sensitivities", "the same with 100 hypothesis columns"
SCREEN = "the same as the screen does it, memories carried along and start states projected out"


def measure(settings: Settings, progress: Progress) -> Row:
    problem = simulated_problem(4, 2000 if settings.quick else SAMPLES)
    plain = Simulator.of(problem.model, problem.free_names)
    surroundings = survey(problem.model, problem, plain)
    offered = chosen(
        candidates(problem.model, shifted_states(problem.model, problem), surroundings, flexible=False),
        surroundings,
        COLUMNS,
    )
    progress("compiling the screen")
    screen, compiling = _compiled(
        lambda: Screen.of(problem.model, (), offered, surroundings, problem.free_names, DEFAULT)
    )
    fitted = _windows(problem, plain)
    count, n_x = fitted.starts.shape
    eye = np.broadcast_to(np.eye(n_x), (count, n_x, n_x))

    def sensitivities() -> np.ndarray:
        run = plain.run(
            problem.driving_records,
            Pass(
                fitted.windows,
                problem.values,
                fitted.starts,
                tangents=True,
                start_directions=eye,
                weights=problem.weights,
            ),
        )
        assert run.normal is not None
        return run.normal

    progress("timing")
    columns_pass = _columns_pass(screen, fitted)
    rivals = {PLAIN: sensitivities, COLUMNS_PASS: columns_pass, SCREEN: lambda: screen.projected(fitted).total()}
    agreement = apart(columns_pass()[:, :12, :12], sensitivities()[:, :12, :12])
    times = {n: t.median for n, t in interleaved(rivals, repeats=settings.repeats(9)).items()}
    columns = sum(len(group) for group in screen.directions)
    return Row(
        "hypotheses",
        TITLE,
        entries=(
            Entry(PLAIN, times[PLAIN], ours=True, note=f"{count} windows, start states free"),
            Entry(
                COLUMNS_PASS, times[COLUMNS_PASS], compiling, True, f"{columns} columns of {len(screen.probed)} probes"
            ),
            Entry(SCREEN, times[SCREEN], ours=True, note=f"{times[SCREEN] / times[PLAIN]:.3g} times the plain pass"),
        ),
        targets=(Target("time of the plain pass", "at most", 5.0, times[COLUMNS_PASS] / times[PLAIN]),),
        agreement=f"matrices of the 12 parameters in both passes differ by {agreement:.1e}",
        notes=("window start states are free in all three; the target is on the pass alone",),
    )


def _columns_pass(screen: Screen, fitted: WindowFit) -> Callable[[], np.ndarray]:
    """The screen's pass alone: memories begin where carrying them along has put them, once."""
    values, begun = screen.values(fitted.problem), screen.starts(fitted)
    records, (count, own) = screen.model.prepared(fitted.problem.records, values), fitted.starts.shape
    eye = np.broadcast_to(np.eye(own, begun.shape[1]), (count, own, begun.shape[1]))

    def columns() -> np.ndarray:
        run = screen.simulator.run(
            records,
            Pass(
                fitted.windows,
                values,
                begun,
                tangents=True,
                start_directions=eye,
                weights=fitted.problem.weights,
                probes=screen.probes,
            ),
        )
        assert run.packed is not None
        return run.packed.rows(np.arange(12))

    return columns


def chosen(offered: list[Attachment], around: dict[str, Surroundings], columns: int) -> list[Attachment]:
    """Attachments in the order offered, and again from the first, that together have ``columns`` directions."""
    result, room = [], columns
    while room:
        before = room
        for attachment in offered:
            size = sum(len(probe.directions) for probe in attachment.mechanism.probes(around[attachment.port]))
            if 0 < size <= room:
                result.append(attachment)
                room -= size
        if room == before:
            break
    return result


def _windows(problem: Problem, simulator: Simulator) -> WindowFit:
    """Windows that begin on the free run."""
    windows = cut(problem.records, LENGTH)
    run = simulator.run(
        problem.records, Pass(whole_records(problem.records), problem.values, problem.initial, keep_states=True)
    )
    experiment = np.searchsorted(problem.records.first, windows.start, side="right") - 1
    begun = np.array(run.states[experiment, windows.start - problem.records.first[experiment]])
    return WindowFit(problem, windows, begun, 1.0, np.ones(len(windows.start)), 0)


def _compiled(make: Callable[[], Screen]) -> tuple[Screen, float]:
    """What ``make`` returns, and the seconds that takes with nothing in the cache of machine code."""
    kept = os.environ.get("GREYBOX_CACHE")
    with tempfile.TemporaryDirectory() as folder:
        os.environ["GREYBOX_CACHE"] = str(Path(folder))
        try:
            seconds, screen = once(make)
        finally:
            os.environ.pop("GREYBOX_CACHE") if kept is None else os.environ.update(GREYBOX_CACHE=kept)
    assert isinstance(screen, Screen)
    return screen, seconds
