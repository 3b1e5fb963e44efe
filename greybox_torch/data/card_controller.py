"""What a card says of the controller that a machine runs under."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Annotated

from pydantic import Field, field_validator

from greybox_torch.data.card_channels import Entry, Finite, Text
from greybox_torch.errors import did_you_mean


class LoopEntry(Entry):
    """A digital loop that drives the input NAME, so that an output follows its set point r. With y[k] the samples of the output `measured`,
    e = r − y and the sample time T, it is
    `offset` + `gain` · (e[k] + `integral` · T (e[0] + … + e[k−1]) − `derivative` · (y[k] − y[k−1]) / T).

    Set anew at every sample, held in between, and clipped to the input's limits; while it is clipped, the sum does not grow further beyond.
    `gain` is in the input's unit per unit of the output (below zero where the output falls as the input rises), `integral` per second,
    `derivative` in seconds, `offset` in the input's unit. `delay` is how many samples pass before the answer to a sample acts.
    """

    measured: Text
    gain: Finite
    integral: Annotated[Finite, Field(ge=0.0)] = 0.0
    derivative: Annotated[Finite, Field(ge=0.0)] = 0.0
    offset: Finite = 0.0
    delay: Annotated[int, Field(ge=0, le=1000)] = 0

    @field_validator("gain")
    @classmethod
    def _acts(cls, gain: float) -> float:
        if gain == 0.0:
            raise ValueError("found 0, which follows nothing; expected a number above zero, or below it")
        return gain


def check_loops(loops: Mapping[str, LoopEntry], channels: Collection[str], hold: str) -> None:
    """Raises ValueError where a loop is of channels that the card does not have, or loops do not go together."""
    known = list(channels)
    outputs: dict[str, str] = {}
    for name, loop in loops.items():
        for place, channel in ((name, name), (f"{name}, measured", loop.measured)):
            if channel not in channels:
                hint = did_you_mean(channel, known)
                raise ValueError(
                    f'[controller], {place}: no channel is named "{channel}"{hint}; expected one of {", ".join(known)}'
                )
        if loop.measured == name:
            raise ValueError(f'[controller], {name}, measured: found "{name}" itself, expected an output')
        if loop.measured in outputs:
            raise ValueError(
                f'[controller], {name}, measured: "{loop.measured}" is what {outputs[loop.measured]} follows; '
                "expected an output of its own for every loop"
            )
        outputs[loop.measured] = name
    if loops and hold != "zoh":
        raise ValueError(
            f'[controller]: a loop holds its output between samples, the card says hold = "{hold}"; expected "zoh"'
        )
