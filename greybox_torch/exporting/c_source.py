"""One header and one source in C without dependencies, and an example of their use."""

from __future__ import annotations

from collections.abc import Sequence

from greybox_torch.exporting.c_delays import delay_places
from greybox_torch.exporting.c_language import C
from greybox_torch.exporting.exported import ExportedModel, Variable
from greybox_torch.exporting.fill import filled
from greybox_torch.exporting.statements import statements


def c_files(model: ExportedModel) -> dict[str, str]:
    """The texts by file name: NAME.h, NAME.c and example.c."""
    places = _places(model)
    name = model.identifier
    return {
        f"{name}.h": filled("model.h", places),
        f"{name}.c": filled("model.c", places),
        "example.c": filled("example.c", places),
    }


def quoted(text: str) -> str:
    """A string literal of C, in ASCII."""
    escaped = text.encode("ascii", "replace").decode().replace("\\", "\\\\").replace('"', '\\"').replace("?", "\\?")
    return f'"{escaped}"'


def comment(text: str) -> str:
    """Text that may stand in a comment, in ASCII."""
    return text.encode("ascii", "replace").decode().replace("*/", "* /").replace("/*", "/ *")


def _places(model: ExportedModel) -> dict[str, object]:
    language = C()
    equations = model.equations
    rates, outputs = (
        _function(model, roots, target, language)
        for roots, target in ((equations.rates, "dx"), (equations.outputs, "y"))
    )
    numbers = [f"    x[{i}] = {language.constant(s.value)};" for i, s in enumerate(model.states)]
    numbers += [f"    p[{i}] = {language.constant(q.value)};" for i, q in enumerate(model.parameters)]
    count, acting = len(model.inputs), len(model.inputs) + len(model.delays)
    return {
        **delay_places(model),
        "name": model.identifier,
        "NAME": model.identifier.upper(),
        "TITLE": comment(model.title),
        "DESCRIPTION": comment(model.description) or "A model with the physics that recordings showed.",
        "NX": len(model.states),
        "NU": count,
        "NY": len(model.outputs),
        "NP": len(model.parameters),
        "NA": acting,
        "ROOM_U": max(acting, 1),
        "ROOM_P": max(len(model.parameters), 1),
        "ROW": max(acting, 1) + 1,
        "ROW_NUMBERS": count + 1,
        "STEP": repr(model.step),
        "NEXT_INPUT": "now" if model.hold == "zoh" else "next",
        "HELD": "is held until" if model.hold == "zoh" else "runs straight to that of",
        "STATES": _listed("x", model.states),
        "INPUTS": _listed("u", model.inputs),
        "OUTPUTS": _listed("y", model.outputs),
        "PARAMETERS": _listed("p", model.parameters),
        "STATE_NAMES": _names(model.states),
        "INPUT_NAMES": _names(model.inputs),
        "OUTPUT_NAMES": _names(model.outputs),
        "PARAMETER_NAMES": _names(model.parameters),
        "INPUT_LIST": comment(", ".join(v.name for v in model.inputs) or "none"),
        "STATE_LIST": comment(", ".join(v.name for v in model.states)),
        "DEFAULTS": "\n".join(numbers),
        "RATES": rates,
        "OUTPUT_ROWS": outputs,
        "HELPERS": "".join(f"{text}\n" for text in language.helpers),
    }


def _function(model: ExportedModel, roots: Sequence[int], target: str, language: C) -> str:
    lines, named = statements(model.equations.graph, roots, language)
    return "\n".join([*lines, *(f"    {target}[{i}] = {value};" for i, value in enumerate(named))])


def _listed(array: str, variables: Sequence[Variable]) -> str:
    """A comment with a line for each variable."""
    if not variables:
        return "/*   none */"
    rows = [
        f"{array}[{i}]  {v.name}" + (f" [{v.unit}]" if v.unit else "") + (f": {v.description}" if v.description else "")
        for i, v in enumerate(variables)
    ]
    return "/*   " + "\n *   ".join(comment(row) for row in rows) + " */"


def _names(variables: Sequence[Variable]) -> str:
    return ", ".join(quoted(v.name) for v in variables) or "0"
