"""The equation of a found law, as one would write it into the model's class."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import torch

from greybox_torch.codegen.expression import Graph
from greybox_torch.codegen.formula import formula
from greybox_torch.codegen.trace import nodes_of, separate_symbols
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.model import Balance, Body, Coupling, Signals
from greybox_torch.model.ports import Port

LONGEST = 600
"""Characters up to which a formula is shown: six harmonics of a ripple have 420."""


def equation(
    attachment: Attachment, site: Port, around: Surroundings, named: Callable[[str], str], parameters: Sequence[str]
) -> str:
    """What a law adds at its port, from the code that computes it; where that is no formula, as its class describes it. "" for a curve.

    Args:
        named: the model's own name of a signal at the port.
        parameters: the law's, as it has them in the model.
    """
    law = attachment.mechanism
    if law.free:
        return ""
    deflects = law.kinematic and isinstance(site, Coupling)
    if not isinstance(site, Body | Coupling | Balance) or law.states(around) or (law.kinematic and not deflects):
        return law.described_here()
    try:
        text = _formula(law, around, named, parameters)
    except Exception:  # a law of one's own may compute its force in any way
        return law.described_here()
    if len(text) > LONGEST:
        return law.described_here()
    if not deflects:
        return f"port.{site.name} += {text}"
    words = set(re.findall(r"\w+", text))
    beside = [name for name in parameters if name not in words]
    further = f"; {' and '.join(beside)} {'act' if len(beside) > 1 else 'acts'} beside that" if beside else ""
    return f"the spring at {site.name} sees {text}{further}"


def _formula(law: Mechanism, around: Surroundings, named: Callable[[str], str], parameters: Sequence[str]) -> str:
    signals = list(dict.fromkeys([*around.ranges, *law.needs, *law.reads, *(f"position@{body}" for body in law.links)]))
    graph = Graph()
    local = dict(zip(signals, separate_symbols(graph, "x", len(signals)), strict=True))
    own = dict(zip(parameters, separate_symbols(graph, "p", len(parameters)), strict=True))
    s = Signals("signal", {**local, "sample_time": torch.tensor(around.sample_time, dtype=torch.float64)})
    p = Signals("parameter", own)
    with torch.no_grad():
        force = law.deflection(s, p) if law.kinematic else law.force(s, p, Signals("memory", {}))
        if not law.kinematic and law.elsewhere(s, p, Signals("memory", {})):
            raise ValueError("acts at several bodies")
    names = {"x": [named(signal) for signal in signals], "p": list(parameters)}
    return formula(graph, nodes_of(graph, torch.as_tensor(force).reshape(1))[0], lambda kind, place: names[kind][place])
