"""Row 6: how the time of a free run with 12 sensitivities grows with the samples."""

from __future__ import annotations

import numpy as np

from experiments.speed.peers.versus import records_for_peers
from experiments.speed.records import SAMPLE_TIME, SENSITIVE, SENSITIVE_INDEX, simulated_records
from experiments.speed.row import Entry, Row, Target
from experiments.speed.rows import Needs, Progress
from experiments.speed.settings import Settings, missing_peers
from experiments.speed.timing import interleaved
from greybox_torch.simulation import Pass, Simulator, whole_records
from greybox_torch.systems import RobotArm

TITLE = "Growth with samples: one record, 12 sensitivities, normal matrices"
NEEDS = Needs()
OURS, JAX = "ours", "JAX, jacfwd of the scan"
LONGEST_JAX = 100_000
"""Samples beyond which JAX is left out, for its Jacobian's memory and everybody's patience."""


def measure(settings: Settings, progress: Progress) -> Row:
    sizes = (1000, 3000, 10_000) if settings.quick else (10_000, 30_000, 100_000, 300_000, 1_000_000)
    simulator, points, distance = Simulator.of(RobotArm(), SENSITIVE), {OURS: [], JAX: []}, 0.0
    matrix = None
    if not missing_peers(("jax",)):
        from experiments.speed.peers import jax_arm

        matrix = jax_arm.normal_matrix(SAMPLE_TIME, SENSITIVE_INDEX)
    for samples in sizes:
        progress(f"{samples} samples")
        records = simulated_records(1, samples)
        p, x0, u = records_for_peers(records)
        windows, weights, measured = whole_records(records), np.ones(1), records.y[0]

        def ours(records=records, windows=windows, p=p, x0=x0, weights=weights) -> np.ndarray:
            normal = simulator.run(records, Pass(windows, p, x0, tangents=True, weights=weights)).normal
            assert normal is not None
            return normal[0]

        rivals = {OURS: ours}
        if matrix is not None and samples <= LONGEST_JAX:
            rivals[JAX] = lambda p=p, x0=x0, u=u, y=measured: np.asarray(matrix(p, x0[0], u[0], y))
            distance = max(distance, _apart(rivals[JAX](), ours()))
        for name, timing in interleaved(rivals).items():
            points[name].append((float(samples), timing.median))
    return Row(
        "growth",
        TITLE,
        entries=tuple(
            Entry(f"{name}, {samples:.0f} samples", seconds, ours=name == OURS)
            for name, curve in points.items()
            for samples, seconds in curve
        ),
        targets=(Target("log-log slope of ours", "at most", 1.05, slope(points[OURS]), unit=""),),
        agreement=f"normal matrices of ours and JAX differ by {distance:.1e}"
        if points[JAX]
        else "JAX is not installed",
        notes=(f"log-log slope of JAX {slope(points[JAX]):.3f}",) if len(points[JAX]) > 1 else (),
        curves={name: curve for name, curve in points.items() if curve},
    )


def slope(curve: list[tuple[float, float]]) -> float:
    """Exponent of the power law through points (samples, seconds), by least squares in the logarithms."""
    x, y = np.log(np.array(curve)).T
    return float(np.polyfit(x, y, 1)[0])


def _apart(one: np.ndarray, other: np.ndarray) -> float:
    """Largest difference of two normal matrices whose columns are scaled to length one, unless they vanish beside the largest."""
    length = np.sqrt(np.diag(other))
    length = np.maximum(length, 1e-12 * length.max())
    return float(np.max(np.abs(one - other) / np.outer(length, length)))
