"""The screen that a search made last, used again for what it shows: with all hypotheses in it, one takes seconds to compile."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

from greybox_torch.diagnosis.screen.score_test import Screen
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.model import GreyBoxModel
from greybox_torch.simulation.simulator import SimulationOptions


@dataclass(eq=False)
class Screens:
    """Makes screens, and keeps the last one."""

    last: Screen | None = None
    around: Mapping[str, Surroundings] | None = None

    def showing(
        self,
        base: GreyBoxModel,
        accepted: Sequence[Attachment],
        attachments: Sequence[Attachment],
        surroundings: Mapping[str, Surroundings],
        free_names: Sequence[str],
        options: SimulationOptions,
    ) -> Screen:
        """The last screen where it shows all ``attachments``, perhaps among others, else a new one of these alone; see :class:`Screen`."""
        there = self.last
        if (
            there is not None
            and self.around is surroundings
            and _beside(there, base, accepted, free_names, options)
            and {described(a) for a in attachments} <= {described(a) for a, _ in there.probed}
        ):
            return there
        self.around = surroundings
        self.last = Screen.of(base, accepted, attachments, surroundings, free_names, options)
        return self.last


def described(attachment: Attachment) -> Hashable:
    """What tells an attachment from others that were made apart: where it is, its law, and how that was made."""
    law = attachment.mechanism
    made = tuple((name, repr(value)) for name, value in sorted(vars(law).items()))
    return attachment.prefix, attachment.position, attachment.shifted_state, attachment.substeps, type(law), made


def _beside(
    screen: Screen,
    base: GreyBoxModel,
    accepted: Sequence[Attachment],
    free_names: Sequence[str],
    options: SimulationOptions,
) -> bool:
    """Whether a screen looks beside these effects of this model, its parameters and options these."""
    model = screen.base is base and screen.free_names == tuple(free_names) and screen.options == options
    return model and [id(a) for a in screen.accepted] == [id(a) for a in accepted]
