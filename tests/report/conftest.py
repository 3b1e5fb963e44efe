from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from greybox_torch.diagnosis.effect import Curve, Effect, Profile
from greybox_torch.diagnosis.memory import Memory
from greybox_torch.diagnosis.one_of import Alternative
from greybox_torch.diagnosis.traces import Trace
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.comparison import Score
from greybox_torch.estimate.metrics import fit_percent, root_mean_square
from greybox_torch.report.about import About

MODELS = ("start", "refit", "augmented")

BACKLASH = Effect(
    port="gear_spring",
    mechanism="backlash",
    probability=0.94,
    signals=("gear_twist",),
    where="81 % of what it explains lies within -0.031 < gear_twist < 0.031 rad",
    parameters={"half_gap": {"value": 0.031, "std": 0.0004, "unit": "rad"}},
    explained=0.97,
    alternatives=(Alternative("gear_spring", "nonlinear_stiffness", 0.04),),
    curve=Curve(
        "gear_twist", "rad", np.linspace(-0.1, 0.1, 50), np.linspace(0.5, -0.5, 50) ** 3, "N m", np.full(50, 0.01)
    ),
    profiles=(Profile("gear_twist", "rad", np.linspace(-0.1, 0.1, 11), np.full(10, 0.1)),),
    explanation="There is play: within a gap the coupling transmits nothing.",
    source="M. Nordin, P.-O. Gutman, Automatica 38(10), 2002",
    separating_experiment="reversals at low torque",
    size=0.9,
    equation="the spring at gear_spring sees 0",
)

UNKNOWN = replace(
    BACKLASH,
    port="motor",
    mechanism="unknown",
    probability=0.88,
    parameters={"w_0": {"value": 0.1, "std": 0.01, "unit": "N m"}},
    explanation="Something repeatable is missing here that no known mechanism describes.",
)

FREQUENCY = np.geomspace(0.05, 20.0, 41)
REMEMBERED = 0.02 - 0.3 / (1.0 + 0.5j * FREQUENCY)

MEMORY = replace(
    UNKNOWN,
    parameters={"T": {"value": 0.08, "std": 0.002, "unit": "s"}},
    signals=("motor_speed",),
    memory=Memory(
        "motor_speed",
        "N m/(rad/s)",
        False,
        1,
        0.08,
        0.002,
        FREQUENCY,
        REMEMBERED,
        np.full(41, 0.004),
        np.full(41, 0.02),
    ),
)


def trace(experiment: str, role: str, error: float, samples: int = 3000) -> Trace:
    """A sine with errors of three sizes, one gap, 1 ms apart."""
    time = np.arange(samples) * 0.001
    measured = 10.0 * np.sin(2 * np.pi * 2.0 * time) + np.random.default_rng(1).normal(0, 0.05, samples)
    clean = 10.0 * np.sin(2 * np.pi * 2.0 * time)
    ripple = np.sin(2 * np.pi * 15.0 * time)
    measured[100:120] = np.nan
    return Trace(
        experiment,
        role,
        "motor_speed",
        "rad/s",
        time,
        measured,
        0.8 * clean,
        clean + error * ripple,
        clean + 0.02 * ripple,
    )


def verdict_of(*effects: Effect, traces: tuple[Trace, ...] | None = None) -> Verdict:
    if traces is None:
        error = 1.0 if effects else 0.02
        traces = tuple(trace(n, r, error) for n, r in (("Steps", "estimation"), ("Sweep <1>", "validation")))
    scores = {
        model: tuple(
            Score(t.experiment, t.role, t.output, fit_percent(t.measured, s), root_mean_square(t.measured, s))
            for t in traces
            for s in (getattr(t, model),)
        )
        for model in MODELS
    }
    return Verdict(
        dataset="Arm & drive",
        model="robot_arm",
        seed=7,
        seconds=42.3,
        confidence=0.97,
        effects=effects,
        scores=scores,
        evidence=("The residual correlates with past torque.",),
        stages={"refit": 2.0, "screen": 40.0},
        ranking=(("gear_spring", "backlash", 0.62, 0.97), ("motor", "coulomb_friction", 0.0004, None)),
        traces=traces,
    )


VERDICTS = {
    "found": (BACKLASH,),
    "several": (BACKLASH, replace(BACKLASH, port="arm_spring")),
    "unknown": (UNKNOWN,),
    "memory": (MEMORY,),
    "nothing": (),
}


@pytest.fixture(params=VERDICTS)
def verdict(request: pytest.FixtureRequest) -> Verdict:
    """Each of the kinds of answer."""
    return verdict_of(*VERDICTS[request.param])


@pytest.fixture
def of_kind() -> Callable[[str], Verdict]:
    """The verdict of a kind: "found", "several", "unknown", "memory", "nothing"."""
    return lambda kind: verdict_of(*VERDICTS[kind])


@pytest.fixture
def with_traces() -> Callable[..., Verdict]:
    """The verdict "found" with other traces, made by `trace`."""
    return lambda *rows: verdict_of(BACKLASH, traces=tuple(trace(*row) for row in rows))


@pytest.fixture
def about() -> About:
    return About(
        version="1.2.3",
        created=datetime(2026, 11, 20, 6, 0, tzinfo=UTC),
        values={"F_c": 0.5983, "gear_spring.backlash.half_gap": 0.031},
        units={"F_c": "N m", "gear_spring.backlash.half_gap": "rad"},
        command="greybox compare dataset.toml results/arm/model",
    )
