"""The variables of an FMU: their names, which have to differ, and their value references."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from greybox_torch.exporting.exported import ExportedModel, Variable


@dataclass(frozen=True)
class FmiVariable:
    """``kind`` is "input", "output", "state", "parameter", "switch" or "rate"; ``name`` is its name in the FMU."""

    kind: str
    name: str
    reference: int
    of: Variable


def fmi_variables(model: ExportedModel) -> list[FmiVariable]:
    """In the order of their references: inputs, outputs, states, parameters, switches, rates of inputs.

    Inputs, outputs and parameters keep their names as far as these differ; a state is "state.NAME", a switch "PORT.MECHANISM.active".
    Inputs of a model whose recordings run straight between samples have a rate, "NAME.rate": how fast they change during a step.
    """
    own = [p for p in model.parameters if not p.is_switch]
    switches = [p for p in model.parameters if p.is_switch]
    rates = [_rate(i) for i in model.inputs] if model.hold == "foh" else []
    groups: dict[str, Sequence[Variable]] = {
        "input": model.inputs,
        "output": model.outputs,
        "state": model.states,
        "parameter": own,
        "switch": switches,
        "rate": rates,
    }
    found: list[FmiVariable] = []
    taken: set[str] = set()
    for kind in ("output", "input", "parameter", "state", "switch", "rate"):  # who keeps the plain name
        for v in groups[kind]:
            name = _name(kind, v, taken)
            taken.add(name)
            found.append(FmiVariable(kind, name, 0, v))
    order = list(groups)
    found.sort(key=lambda v: order.index(v.kind))  # stable
    return [FmiVariable(v.kind, v.name, k, v.of) for k, v in enumerate(found)]


def _rate(of: Variable) -> Variable:
    about = f"rate at which {of.name} runs on from its value during a step"
    return Variable(f"{of.name}.rate", f"{of.unit}/s" if of.unit else "", 0.0, about)


def _name(kind: str, variable: Variable, taken: set[str]) -> str:
    if kind == "state":
        return f"state.{variable.name}"
    if kind == "switch":
        return f"{variable.name.rpartition('.')[0]}.active"
    return f"{kind}.{variable.name}" if variable.name in taken else variable.name
