"""The forces at a model's ports: those that act there already, and what attached laws add to them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.model import Signals
from greybox_torch.model.ports import Actuator, Sensor

if TYPE_CHECKING:
    from greybox_torch.mechanisms.augmented_model import AugmentedModel


class AddedForces:
    """The forces of a model's laws at one time.

    Args:
        seen: the states with the deflections changed by kinematic laws.
        acting: the inputs as actuators pass them on; ``reaching`` as they reach each law at an actuator, by prefix.
        x: the states themselves: bodies are there, whatever a spring sees.
    """

    def __init__(
        self,
        model: AugmentedModel,
        seen: Signals,
        reaching: Mapping[str, Signals],
        acting: Signals,
        p: Signals,
        x: Signals,
    ) -> None:
        self._model, self._seen, self._reaching, self._acting, self._p = model, seen, reaching, acting, p
        self._x = x

    def to(self, before: Signals) -> Signals:
        """The forces ``before``, and those of all laws."""
        everything = self._model.attachments
        first = [a for a in everything if not a.mechanism.by_rate]
        forces = self._of(first, before, None)
        if len(first) == len(everything):
            return forces
        # Looks leave one another alone: none changes the rate that another one reads.
        laws = [a for a in first if a.prefix not in self._model.probed]
        under = forces if len(laws) == len(first) else self._of(laws, before, None)
        return self._of([a for a in everything if a.mechanism.by_rate], forces, under)

    def _of(self, attachments: Sequence[Attachment], before: Signals, under: Signals | None) -> Signals:
        """The forces ``before`` and those of ``attachments``, where rates are those under forces ``under``."""
        model, p, forces = self._model, self._p, dict(before)
        for a in attachments:
            site = model.local.ports[a.port]
            if isinstance(site, Sensor):
                continue  # it shows forces, and adds none
            local, own, memory = model.given(
                a, self._seen, self._reaching.get(a.prefix, self._acting), p, under, self._x
            )
            if not a.mechanism.kinematic and not isinstance(site, Actuator):
                forces[a.port] = forces[a.port] + model.share(a, p) * a.mechanism.force(local, own, memory)
            local = model.local.with_load(a, local, self._seen, self._acting, p)
            for place, force in (*_kinematic(a, local, own), *a.mechanism.elsewhere(local, own, memory).items()):
                forces[place] = forces[place] + model.share(a, p) * force
        return Signals("port", forces)


def _kinematic(a: Attachment, local: Signals, own: Signals) -> list[tuple[str, Any]]:
    """What a kinematic law does beyond the change of deflection: forces by port."""
    if not a.mechanism.kinematic:
        return []
    followed = [(a.position, a.mechanism.reaction(local, own))] if a.position else []
    found = [*followed, (a.port, a.mechanism.force_beside(local, own))]
    return [(place, force) for place, force in found if force is not None]
