"""Start states that are to be measured, and that no output or input of the model measures, or one that shows another state."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from greybox_torch.checking.finding import Finding, Level
from greybox_torch.checking.source import Source
from greybox_torch.estimate.measured_states import measuring_signal, not_measured
from greybox_torch.files import toml_key
from greybox_torch.model import Body, GreyBoxModel
from greybox_torch.model.sensed_states import sensed_states


def unmeasured_starts(model: GreyBoxModel, source: Source, given: Collection[str] | None) -> Iterator[Finding]:
    """Findings for all of them but those whose start is ``given`` by a card. The equations are computed.

    Without a card (None) they are warnings, as one may give these starts.
    """
    level: Level = "warning" if given is None else "error"
    for state in model.states:
        if state.name not in (given or ()) and state.initial == "measured" and measuring_signal(model, state) is None:
            line = source.line_of(f'State("{state.name}"')
            yield Finding(level, "declaration", *not_measured(model, state), source.file, line)


def borrowed_starts(model: GreyBoxModel, source: Source, given: Collection[str] | None) -> Iterator[Finding]:
    """Notes on states that no output shows and that begin with one that shows another state, as it is the only one in their unit. Bodies
    that are coupled often move alike before a record begins; temperatures and levels seldom are alike.
    """
    shown = sensed_states(model)
    moving = {name for port in model.ports if isinstance(port, Body) for name in (port.speed, port.position)}
    of_signal = {signal: name for name, signal in shown.items()}
    for state in model.states:
        if state.initial != "measured" or state.name in {*shown, *moving, *(given or ())}:
            continue
        signal = measuring_signal(model, state)
        if signal in of_signal:
            line = source.line_of(f'State("{state.name}"')
            other = f"the only output in its unit, which shows '{of_signal[signal]}'"
            found = f"state '{state.name}' begins with the first sample of {signal}, {other}"
            on_card = f"{toml_key(state.name)} = {{ value = … }} under [model.initial] on the card"
            write = (
                f'a number to begin with, if it may begin elsewhere: State("{state.name}", …, initial=…), or {on_card}'
            )
            yield Finding("note", "declaration", found, write, source.file, line)
