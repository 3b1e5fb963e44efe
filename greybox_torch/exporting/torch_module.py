"""A plain module of torch that needs nothing of this package."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.exporting.exported import ExportedModel, Variable
from greybox_torch.exporting.fill import filled
from greybox_torch.exporting.statements import statements
from greybox_torch.exporting.torch_language import Torch


def torch_files(model: ExportedModel) -> dict[str, str]:
    """The text by file name: NAME.py."""
    equations = model.equations
    rates, rate_rows = statements(equations.graph, equations.rates, Torch())
    outputs, output_rows = statements(equations.graph, equations.outputs, Torch())
    own = [k for k, p in enumerate(model.parameters) if not p.is_switch]
    switches = [k for k, p in enumerate(model.parameters) if p.is_switch]
    places = {
        "CLASS": "".join(word[:1].upper() + word[1:] for word in model.identifier.split("_")),
        "TITLE": _prose(model.title),
        "DESCRIPTION": _prose(model.description) or "A model with the physics that recordings showed.",
        "STATES": _table(model.states, "start"),
        "INPUTS": _table(model.inputs),
        "OUTPUTS": _table(model.outputs),
        "PARAMETERS": _table([model.parameters[k] for k in own], "value"),
        "EFFECTS": repr([model.parameters[k].name.rpartition(".")[0] for k in switches]),
        "DELAYS": repr([(delay.input, own.index(delay.parameter)) for delay in model.delays]),
        "ORDER": repr([[*own, *switches].index(k) for k in range(len(model.parameters))]),
        "STEP": repr(model.step),
        "HOLD": model.hold,
        "RATES": "\n".join(rates),
        "RATE_ROWS": ", ".join(rate_rows),
        "OUTPUT_LINES": "\n".join(outputs),
        "OUTPUT_ROWS": ", ".join(output_rows),
    }
    return {f"{model.identifier}.py": filled("module.py", places)}


def _table(variables: Sequence[Variable], value: str = "") -> str:
    rows = [
        {"name": v.name, "unit": v.unit, **({value: v.value} if value else {}), "description": v.description}
        for v in variables
    ]
    return "[\n" + "".join(f"        {row!r},\n" for row in rows) + "    ]" if rows else "[]"


def _prose(text: str) -> str:
    """Text that may stand in a docstring."""
    return text.replace("\\", "/").replace('"', "'")
