"""The screen that a search made last, used again for what it shows: with all hypotheses in it, one takes seconds to compile."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass

from greybox_torch.diagnosis.screen.score_test import Screen
from greybox_torch.mechanisms.attachment import Attachment


@dataclass(eq=False)
class Screens:
    """The last screen, and the objects that it was made of: what it is about, and what it looks beside."""

    last: Screen | None = None
    beside: tuple[object, ...] = ()

    def showing(self, attachments: Sequence[Attachment], make: Callable[[], Screen], *beside: object) -> Screen:
        """The last screen where it was made of the objects ``beside`` and shows all ``attachments``, perhaps among others.

        Args:
            make: a new one of ``attachments`` alone.
        """
        same = [id(one) for one in self.beside] == [id(one) for one in beside]
        there = {described(a) for a, _ in self.last.probed} if same and self.last is not None else set()
        if self.last is None or not {described(a) for a in attachments} <= there:
            self.last, self.beside = make(), beside
        return self.last


def described(attachment: Attachment) -> Hashable:
    """What tells an attachment from others that were made apart: where it is, its law, and how that was made."""
    law = attachment.mechanism
    made = tuple((name, repr(value)) for name, value in sorted(vars(law).items()))
    return attachment.prefix, attachment.position, attachment.shifted_state, attachment.substeps, type(law), made
