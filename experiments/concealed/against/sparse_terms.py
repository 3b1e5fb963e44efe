"""Some terms of the regression's library as a law at a port, so that they can be simulated and re-estimated like any other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import torch

from experiments.concealed.against.terms import Term
from greybox_torch import GreyBoxModel, Mechanism, Parameter, Probe, Signals, Surroundings
from greybox_torch.estimate import Problem, problem_for
from greybox_torch.mechanisms import Attachment, AugmentedModel, attach


class SparseTerms(Mechanism):
    """Σ w_i φ_i(s): the terms φ_i with weights w_i, which start at ``weights``."""

    name = "sparse_terms"
    kinds = ("body", "coupling", "balance", "actuator")

    def __init__(self, terms: Sequence[Term], weights: Sequence[float] = ()) -> None:
        self.terms = tuple(terms)
        self.weights = tuple(weights) or (0.0,) * len(self.terms)
        self.needs = tuple(dict.fromkeys(n for t in terms for n in t.needs))  # type: ignore[misc]
        self.signal = (
            "speed" if "speed" in self.needs else ""
        )  # at an actuator the driving body's speed is handed out on request

    def parameters(self, around: Surroundings) -> list[Parameter]:
        return [
            Parameter(f"w_{i}", float(w), around.force_unit, description=t.name)
            for i, (t, w) in enumerate(zip(self.terms, self.weights, strict=True))
        ]

    def force(self, s: Signals, p: Signals, z: Signals) -> Any:
        return sum(p[f"w_{i}"] * t.value(s) for i, t in enumerate(self.terms))

    def probes(self, around: Surroundings) -> Sequence[Probe]:
        return [Probe((f"w_{i}",)) for i in range(len(self.terms))]

    def signals(self) -> tuple[str, ...]:
        return self.needs


def extended(
    base: GreyBoxModel, port: str, law: SparseTerms, surroundings: Mapping[str, Surroundings]
) -> tuple[AugmentedModel, Attachment]:
    """``base`` with ``law`` at ``port``."""
    attachment = attach(base, port, law)
    return AugmentedModel(base, [attachment], surroundings), attachment


def columns(problem: Problem, model: AugmentedModel, attachment: Attachment, states: np.ndarray) -> np.ndarray:
    """The terms (N, n) along states (N, n_x) of the plain model; positions and time are integrated along each experiment.

    Args:
        problem: of the plain model, on the experiments that the states belong to.
    """
    restated = problem_for(problem, model, {})
    records = restated.driving_records
    names = [s.name for s in model.states]
    full = torch.zeros(len(names), len(states), dtype=torch.float64)
    full[: states.shape[1]] = torch.as_tensor(states.T.copy())
    u = torch.as_tensor(records.u)
    pairs = zip(restated.names, restated.values, strict=True)
    p = Signals("parameter", {n: torch.tensor(float(v), dtype=torch.float64) for n, v in pairs})
    with torch.no_grad():
        rates = model.rates(full, u, p)[states.shape[1] :] * torch.as_tensor(records.dt)
        for e in range(len(records.first)):
            span = records.span(e)
            full[states.shape[1] :, span] = torch.cumsum(rates[:, span], dim=1) - rates[:, span]
        x = Signals("state", {n: full[i] for i, n in enumerate(names)})
        inputs = Signals("input", {s.name: u[i] for i, s in enumerate(model.inputs)})
        local = model.local_signals(attachment, x, inputs, p)
        law = attachment.mechanism
        assert isinstance(law, SparseTerms)
        return np.stack([np.broadcast_to(t.value(local).numpy(), len(states)) for t in law.terms], axis=1)
