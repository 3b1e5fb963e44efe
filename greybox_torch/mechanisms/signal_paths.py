"""The way of an input through the laws at its actuator, and of an output through those at its sensor: one law behind the other.

Dead times come first, as they are of what was recorded, then the laws as they were attached. The looks of a screen, which are not there,
see what the laws that are there pass on, and leave one another alone; free curves among them are of the signal before all laws, as they
may stand for any of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.local_signals import LocalSignals
from greybox_torch.model import Signals
from greybox_torch.model.ports import Actuator, Sensor

Share = Callable[[Attachment, Signals], Any]
"""The factor on a law that is a look of a screen, or can be turned off; 1 for the others."""


class SignalPaths:
    """What reaches every law at an actuator or a sensor, and what leaves the last of them.

    Args:
        probed: prefixes of the looks of a screen.
        share: the factor on an attachment's effect, by parameters.
    """

    def __init__(self, local: LocalSignals, probed: frozenset[str], share: Share) -> None:
        self.local, self.share = local, share
        self.at_actuators = _in_series((a for a in local.attachments if self._is(a, Actuator)), probed)
        self.at_sensors = _in_series((a for a in local.attachments if self._is(a, Sensor)), probed)

    def inputs(self, x: Signals, u: Signals, p: Signals) -> tuple[Signals, dict[str, Signals]]:
        """The inputs that act, and by prefix those that reach each law at an actuator; ``u`` as they are recorded."""
        there, looks = self.at_actuators
        acting, reaching = u, {}
        for a in there:
            reaching[a.prefix] = _before(a, u, acting)
            acting = self._passed(a, x, reaching[a.prefix], acting, p)
        passed = acting
        for a in looks:
            reaching[a.prefix] = u if a.mechanism.free else _before(a, u, passed)
            acting = self._passed(a, x, reaching[a.prefix], acting, p)
        return acting, reaching

    def outputs(self, true: Mapping[str, Any], x: Signals, p: Signals) -> tuple[dict[str, Any], dict[str, Any]]:
        """The outputs as recorded, by name, and by prefix what reaches each law at a sensor; ``true`` before all of them."""
        there, looks = self.at_sensors
        recorded, reaching = dict(true), {}
        for a in there:
            reaching[a.prefix] = recorded[self._output(a)]
            recorded[self._output(a)] = recorded[self._output(a)] + self._shown(a, reaching[a.prefix], x, p)
        passed = dict(recorded)
        for a in looks:
            reaching[a.prefix] = (true if a.mechanism.free else passed)[self._output(a)]
            recorded[self._output(a)] = recorded[self._output(a)] + self._shown(a, reaching[a.prefix], x, p)
        return recorded, reaching

    def _passed(self, a: Attachment, x: Signals, before: Signals, acting: Signals, p: Signals) -> Signals:
        """The inputs behind a law that ``before`` reaches."""
        site = self.local.ports[a.port]
        assert isinstance(site, Actuator)
        given = self.local.at(a, x, before, p), self.local.parameters(a, p), self.local.memory(a, x)
        share = self.share(a, p)
        changes = {site.input: a.mechanism.force(*given), **a.mechanism.other_inputs(*given)}
        return acting.replaced(**{name: acting[name] + share * change for name, change in changes.items()})

    def _shown(self, a: Attachment, before: Any, x: Signals, p: Signals) -> Any:
        """What a law at a sensor adds to the output that reaches it."""
        beside = self.local.sampling(a.port) | self.local.clock(x) | self.local.states_read(a, x)
        local = Signals("signal", {"output": before, **beside})
        return self.share(a, p) * a.mechanism.force(local, self.local.parameters(a, p), self.local.memory(a, x))

    def _output(self, a: Attachment) -> str:
        site = self.local.ports[a.port]
        assert isinstance(site, Sensor)
        return site.output

    def _is(self, a: Attachment, kind: type) -> bool:
        return isinstance(self.local.ports.get(a.port), kind)


def _before(a: Attachment, u: Signals, acting: Signals) -> Signals:
    """What reaches a law: a dead time the inputs as they were recorded."""
    return u if "delayed" in a.mechanism.needs else acting


def _in_series(
    attachments: Iterable[Attachment], probed: frozenset[str]
) -> tuple[tuple[Attachment, ...], tuple[Attachment, ...]]:
    """The laws that are there, dead times first, and the looks of a screen."""
    in_order = sorted(attachments, key=lambda a: "delayed" not in a.mechanism.needs)
    looks = tuple(a for a in in_order if a.prefix in probed)
    return tuple(a for a in in_order if a.prefix not in probed), looks
