"""Start states that are to be measured, and that no output or input of the model measures."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from greybox_torch.checking.finding import Finding, Level
from greybox_torch.checking.source import Source
from greybox_torch.estimate.measured_states import measuring_signal, not_measured
from greybox_torch.model import GreyBoxModel


def unmeasured_starts(model: GreyBoxModel, source: Source, given: Collection[str] | None) -> Iterator[Finding]:
    """Findings for all of them but those whose start is ``given`` by a card. The equations are computed.

    Without a card (None) they are warnings, as one may give these starts.
    """
    level: Level = "warning" if given is None else "error"
    for state in model.states:
        if state.name not in (given or ()) and state.initial == "measured" and measuring_signal(model, state) is None:
            line = source.line_of(f'State("{state.name}"')
            yield Finding(level, "declaration", *not_measured(model, state), source.file, line)
