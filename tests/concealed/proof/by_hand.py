"""A proof of six cases that no simulation and no tool is needed for: answers, and verdicts written by hand."""

from __future__ import annotations

from typing import Any

from experiments.concealed.machines import MACHINES


def answer(
    machine: str, effects: tuple[str, ...], visibility: float = 10.0, section: str = "library"
) -> dict[str, Any]:
    """A key as the generator writes it."""
    chosen = [MACHINES[machine].catalogue[name] for name in effects]
    names = [c.name for c in MACHINES[machine].outputs]
    return {
        "effects": list(effects) or ["none"],
        "accept": [[list(pair) for pair in e.accept] for e in chosen] or [[]],
        "near": [[list(pair) for pair in e.near] for e in chosen] or [[]],
        "ports": [list(e.ports) for e in chosen] or [[]],
        "outside": [e.outside for e in chosen],
        "sigma": 0.1 if len(names) == 1 else dict.fromkeys(names, 0.1),
        "machine": machine,
        "section": section,
        "estimation": "estimation",
        "noise": 1.0,
        "visibility": visibility if effects else 0.0,
        "strength": ("weak" if visibility < 6 else "moderate") if effects else "none",
        "seed": 1,
        "number": 0,
    }


def verdict(machine: str, *effects: tuple[str, str, float], before: float = 1.0, after: float = 0.1) -> dict[str, Any]:
    """What the tool would write."""
    fit = [
        {"experiment": role, "role": role, "output": c.name, "refit": {"rmse": before}, "augmented": {"rmse": after}}
        for role in ("estimation", "validation")
        for c in MACHINES[machine].outputs
    ]
    found = [{"port": p, "mechanism": m, "probability": q, "alternatives": []} for p, m, q in effects]
    return {"mismatch": bool(found), "effects": found, "fit": fit, "seconds": 1.0, "complete": True}


ANSWERS = {
    "c000": answer("arm", (), section="none"),
    "c001": answer("stage", ("coulomb",)),
    "c002": answer("arm", ("backlash",)),
    "c003": answer("pendulum", ("notch",), section="outside"),
    "c004": answer("stage", ("input_bias",), visibility=3.0, section="noise"),
    "c005": answer("pendulum", ("gravity", "deadzone"), section="two effects"),
}
VERDICTS = {
    "c000": verdict("arm"),
    "c001": verdict("stage", ("carriage", "stribeck_friction", 0.9)),
    "c002": verdict("arm", ("gear_spring", "nonlinear_stiffness", 0.7), after=0.6),
    "c003": verdict("pendulum", ("pivot", "unknown", 0.9)),
    "c004": verdict("stage"),
    "c005": verdict("pendulum", ("pivot", "gravity", 0.95), ("sensor.speed", "sensor_gain", 0.4)),
}
