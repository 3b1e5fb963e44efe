"""Row 5: one gradient of a batched sequence loss for a friction network."""

from __future__ import annotations

import numpy as np

from experiments.speed.network import network_task
from experiments.speed.ours_network import ours_network_gradient
from experiments.speed.peers.torchdiffeq_network import NetworkGradient
from experiments.speed.row import Entry, Row, Target, apart
from experiments.speed.rows import Needs, Progress
from experiments.speed.settings import Settings
from experiments.speed.timing import interleaved, once

TITLE = "One gradient for a friction network, 64 windows × 200 samples"
NEEDS = Needs()
TOLERANCE = 1e-4
"""Of the gradient, against torchdiffeq's: its rk4 is the 3/8 rule, and its adjoint is that of the differential equation."""

OURS, ADJOINT, BACK = "ours", "torchdiffeq odeint_adjoint, eager", "torchdiffeq odeint, backpropagation"


def measure(settings: Settings, progress: Progress) -> Row:
    task = network_task(*((8, 20) if settings.quick else (64, 200)))
    rivals = {ADJOINT: NetworkGradient(task, adjoint=True), BACK: NetworkGradient(task, adjoint=False)}
    exact: np.ndarray = rivals[BACK]()[1]
    first, result = once(lambda: ours_network_gradient(task))
    again, _ = once(lambda: ours_network_gradient(task))
    distances = {ADJOINT: apart(rivals[ADJOINT]()[1], exact), OURS: apart(result[1], exact)}
    failed = "" if distances[OURS] <= TOLERANCE else "the gradients differ"
    rivals = {OURS: lambda: ours_network_gradient(task), **rivals}
    progress("timing")
    times = {n: t.median for n, t in interleaved(rivals, repeats=settings.repeats(7)).items()}
    agreement = "; ".join(f"{n}: gradient {d:.1e} from that of backpropagation" for n, d in distances.items())
    return Row(
        "network_gradient",
        TITLE,
        entries=tuple(
            Entry(n, times[n], max(first - again, 0.0) if n == OURS else None, n == OURS) for n in (OURS, ADJOINT, BACK)
        ),
        targets=(
            Target(
                "faster than odeint_adjoint", "at least", 20.0, times[ADJOINT] / times[OURS], failed_condition=failed
            ),
        ),
        agreement=agreement,
    )
