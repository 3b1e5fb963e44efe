"""Row 1: the free run of four experiments."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from experiments.speed.peers.versus import records_for_peers
from experiments.speed.records import SAMPLE_TIME, SAMPLES, simulated_records
from experiments.speed.row import Entry, Row, Target, apart
from experiments.speed.rows import Needs, Progress
from experiments.speed.settings import Settings
from experiments.speed.timing import interleaved, once
from greybox_torch.simulation import Pass, Records, Simulator, whole_records
from greybox_torch.systems import RobotArm

TITLE = "Free run, 4 experiments × 19 838 samples"
NEEDS = Needs(peers=("jax", "numba"))
TOLERANCE = 1e-9
"""Largest allowed difference from the sequential result, as a share of the largest value."""

Route = Callable[[], np.ndarray]
JAX = ("JAX, lax.scan, jit, vmap", "JAX, lax.scan, jit, lax.map")


def routes(records: Records, p: np.ndarray, x0: np.ndarray) -> dict[str, Route]:
    """Our ways to the speeds (E, N), by name. The fastest that agrees with the sequential result counts."""
    simulator, windows = Simulator.of(RobotArm(), ()), whole_records(records)
    return {"ours, stepper on whole records": lambda: simulator.run(records, Pass(windows, p, x0)).y[..., 0]}


def measure(settings: Settings, progress: Progress) -> Row:
    from experiments.speed.peers import jax_arm, numba_arm

    records = simulated_records(4, 2000 if settings.quick else SAMPLES)
    p, x0, u = records_for_peers(records)
    ours = routes(records, p, x0)
    side_by_side, in_turn = jax_arm.free_run(SAMPLE_TIME), jax_arm.free_run_in_turn(SAMPLE_TIME)
    rows = np.tile(p, (len(u), 1))
    peers: dict[str, Route] = {
        JAX[0]: lambda: np.asarray(side_by_side(p, x0, u)),
        JAX[1]: lambda: np.asarray(in_turn(p, x0, u)),
        "Numba, one experiment a thread": lambda: numba_arm.free_run(rows, x0, u, SAMPLE_TIME),
    }
    progress("compiling")
    compiling = {name: once(call)[0] for name, call in peers.items()}
    exact = peers["Numba, one experiment a thread"]()  # sample after sample, in plain scalar arithmetic
    distances = {name: apart(call(), exact) for name, call in (ours | peers).items()}
    progress("timing")
    times = interleaved(ours | peers, repeats=settings.repeats(15))
    best = min((n for n in ours if distances[n] <= TOLERANCE), key=lambda n: times[n].median, default=None)
    ratio = float("nan") if best is None else min(times[n].median for n in JAX) / times[best].median
    return Row(
        "free_run",
        TITLE,
        entries=tuple(Entry(n, times[n].median, compiling.get(n), n in ours) for n in (*ours, *peers)),
        targets=(Target("no slower than the faster JAX", "at least", 1.0, ratio),),
        agreement="; ".join(f"{n}: {d:.1e} from the sequential scalar run" for n, d in distances.items())
        + f" (allowed for ours {TOLERANCE:.0e})",
    )
