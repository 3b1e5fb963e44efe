"""Parameters, ports, inputs and states that no output depends on."""

from __future__ import annotations

from collections.abc import Iterator

from greybox_torch.checking.declarations import read_as
from greybox_torch.checking.finding import Finding
from greybox_torch.checking.influence import Influence
from greybox_torch.checking.source import Source
from greybox_torch.checking.tracing import Traced
from greybox_torch.model import GreyBoxModel
from greybox_torch.model.own_rate import balanced_state
from greybox_torch.model.states_of import inputs_of
from greybox_torch.name_lists import listed


def without_effect(
    model: GreyBoxModel, influence: Influence, traced: Traced | None, source: Source
) -> Iterator[Finding]:
    """Findings for whatever moves no output."""
    for i, parameter in enumerate(model.declared_parameters):
        if not influence.moves["parameter"][i].any():
            stepwise = traced is not None and _appears(traced, "p", i)
            yield Finding(
                "note" if parameter.fixed else "warning",
                "influence",
                f"parameter '{parameter.name}' moves no output"
                + (
                    ": it stands only where a change of it has no slope (a condition, a sign, a floor)"
                    if stepwise
                    else ""
                ),
                "a smooth form, such as torch.sigmoid((a - b) / width), or fixed=True"
                if stepwise
                else f"{read_as('p', parameter.name)} in derivative() or output(), or nothing of it",
                source.file,
                source.line_of(f'"{parameter.name}"'),
            )
    for i, port in enumerate(model.ports):
        if not influence.moves["port"][i].any():
            yield Finding(
                "warning",
                "influence",
                f"port '{port.name}' reaches no output: nothing that is attached there could be found",
                f"{read_as('port', port.name)} among the forces in derivative()",
                source.file,
                source.line_of(f'"{port.name}"'),
            )
    for i, signal in enumerate(model.inputs):
        if not influence.moves["input"][i].any():
            serves, told = _port_that_reads(model, signal.name), _with_curves_over_inputs(model)
            found, write = (
                f"input '{signal.name}' moves no output",
                f"{read_as('u', signal.name)} in derivative() or output()",
            )
            if serves:
                found += f": laws that are attached at port '{serves}' may depend on it, the model does not"
                write = f"it as it is, if that is meant; else {write}"
            elif told:
                write = f"{write}; or nothing, if diagnose or train is to find what it does at {listed(told, 'or')}"
            level = "note" if serves else "warning"
            yield Finding(level, "influence", found, write, source.file, source.line_of(f'"{signal.name}"'))
    for i, state in enumerate(model.states):
        if not influence.moves["state"][i].any():
            yield Finding(
                "note",
                "influence",
                f"state '{state.name}' is neither measured nor acts on anything that is",
                "it as it is, if it is the position that an effect may depend on; else an output that shows it, or nothing of it",
                source.file,
                source.line_of(f'"{state.name}"'),
            )
    for k, output in enumerate(model.outputs):
        if not any(moved[:, k].any() for kind, moved in influence.moves.items() if kind in ("state", "input")):
            found, write = f"output '{output.name}' depends on no state and no input", "what the sensor measures"
            yield Finding("warning", "influence", found, write, source.file, source.line_of(f'"{output.name}"'))


def _port_that_reads(model: GreyBoxModel, name: str) -> str:
    """The port of which a signal, such as the load that a body carries, depends on an input; "" for none."""
    functions = ((port.name, s) for port in model.ports for s in port.signals.values() if not isinstance(s, str))
    return next((port for port, signal in functions if name in inputs_of(model, signal)), "")


def _with_curves_over_inputs(model: GreyBoxModel) -> list[str]:
    """The bodies and balances at which curves over an input that the equations do not use are tried."""
    return [port.name for port in model.ports if balanced_state(model, port)]


def _appears(traced: Traced, kind: str, index: int) -> bool:
    leaf = traced.graph.leaf(kind, index)
    return leaf in traced.graph.needed([*traced.rates.values(), *traced.outputs.values()])
