"""Row 2: the free run of four experiments with 12 forward sensitivities."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from experiments.speed.peers.versus import records_for_peers
from experiments.speed.records import SAMPLE_TIME, SAMPLES, SENSITIVE, SENSITIVE_INDEX, simulated_records
from experiments.speed.row import Entry, Row, Target, apart
from experiments.speed.rows import Needs, Progress
from experiments.speed.settings import Settings
from experiments.speed.timing import interleaved, once
from greybox_torch.simulation import Pass, Records, Simulator, whole_records
from greybox_torch.systems import RobotArm

TITLE = "Free run with 12 forward sensitivities, 4 experiments × 19 838 samples"
NEEDS = Needs(peers=("jax", "numba"))
TOLERANCE = 1e-9

Route = Callable[[], np.ndarray]
JAX, NUMBA = "JAX, jacfwd of the scan, jit, vmap", "Numba, derivatives by hand"


def routes(records: Records, p: np.ndarray, x0: np.ndarray) -> dict[str, Route]:
    """Our ways to the derivatives (E, N, 12) of the speeds, by name. The fastest that agrees with the peers counts."""
    simulator, windows = Simulator.of(RobotArm(), SENSITIVE), whole_records(records)

    def sequential() -> np.ndarray:
        derivatives = simulator.run(records, Pass(windows, p, x0, tangents=True)).dy
        assert derivatives is not None
        return derivatives[:, :, 0]

    return {"ours, stepper on whole records": sequential}


def measure(settings: Settings, progress: Progress) -> Row:
    from experiments.speed.peers import jax_arm, numba_arm, numba_sensitivities

    records = simulated_records(4, 2000 if settings.quick else SAMPLES)
    p, x0, u = records_for_peers(records)
    ours = routes(records, p, x0)
    jitted = jax_arm.sensitivities(SAMPLE_TIME, SENSITIVE_INDEX)
    seed, fixed = np.zeros((numba_arm.PARAMETERS, len(SENSITIVE))), np.zeros((numba_arm.STATES, len(SENSITIVE)))
    seed[SENSITIVE_INDEX, np.arange(len(SENSITIVE))] = 1.0
    peers: dict[str, Route] = {
        JAX: lambda: np.asarray(jitted(p, x0, u)[1]),
        NUMBA: lambda: numba_sensitivities.sensitivities(p, x0, u, SAMPLE_TIME, seed, fixed)[1],
    }
    progress("compiling")
    compiling = {name: once(call)[0] for name, call in peers.items()}
    exact = peers[NUMBA]()
    distances = {name: _apart(call(), exact) for name, call in (ours | peers).items()}
    progress("timing")
    times = interleaved(ours | peers, repeats=settings.repeats(9))
    best = min((n for n in ours if distances[n] <= TOLERANCE), key=lambda n: times[n].median, default=None)
    ratio = float("nan") if best is None else times[JAX].median / times[best].median
    return Row(
        "sensitivities",
        TITLE,
        entries=tuple(Entry(n, times[n].median, compiling.get(n), n in ours) for n in (*ours, *peers)),
        targets=(Target("faster than JAX", "at least", 3.0, ratio),),
        agreement="; ".join(f"{n}: {d:.1e} from derivatives by hand" for n, d in distances.items())
        + f" (worst direction; allowed for ours {TOLERANCE:.0e})",
    )


def _apart(one: np.ndarray, other: np.ndarray) -> float:
    """Largest difference in any direction, as a share of that direction's largest value."""
    return max(apart(one[..., d], other[..., d]) for d in range(other.shape[-1]))
