"""The model that results from attaching mechanisms to another."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import torch

from greybox_torch.mechanisms import shift
from greybox_torch.mechanisms.added_declarations import added_inputs, added_parameters, added_states, started_at
from greybox_torch.mechanisms.added_forces import AddedForces
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.delayed_input import after, delayed
from greybox_torch.mechanisms.late_outputs import without_what_was_before
from greybox_torch.mechanisms.loaded_starts import loaded_starts
from greybox_torch.mechanisms.local_signals import LocalSignals
from greybox_torch.mechanisms.mechanism import SHARE, Surroundings
from greybox_torch.mechanisms.memories_begun import memories_begun
from greybox_torch.mechanisms.signal_paths import SignalPaths
from greybox_torch.mechanisms.start_positions import position_trials
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.model.ports import Actuator, Port, sensors, value_of


class AugmentedModel(GreyBoxModel):
    """``base`` with mechanisms attached.

    The base's states come first, then positions and time where mechanisms need them, then the mechanisms' memory. Parameters of a
    mechanism are named ``PORT.MECHANISM.PARAMETER``.

    Args:
        surroundings: by port, what the mechanisms may know of it.
        probed: attachments that get a factor ``share`` on the whole of their effect, for the screen: looks, which leave one another alone.
        switched: attachments that get the same factor to be turned on and off.
        start: parameter values that replace the declared ones.

    Raises:
        UserError: an attachment's port, or one that it reads a signal of, is not one of the model's.
    """

    def __init__(
        self,
        base: GreyBoxModel,
        attachments: Sequence[Attachment],
        surroundings: Mapping[str, Surroundings],
        *,
        probed: Sequence[Attachment] = (),
        switched: Sequence[Attachment] = (),
        start: Mapping[str, float] | None = None,
    ) -> None:
        self.attachments = tuple(attachments)
        self.surroundings = dict(surroundings)
        self.probed = frozenset(a.prefix for a in probed)
        self.shared = self.probed | {a.prefix for a in switched}
        self.local = LocalSignals(base, self.attachments, self.surroundings)
        self.paths = SignalPaths(self.local, self.probed, self.share)
        for attachment in attachments:
            self.local.check(attachment)
        self.name = base.title  # type: ignore[misc]
        self.states = [*base.states, *added_states(self.local)]
        self.inputs = [*base.inputs, *added_inputs(self.attachments)]
        self.outputs = list(base.outputs)
        self.ports = list(base.ports)
        added = added_parameters(self.attachments, self.surroundings, self.shared)
        self.declared_parameters = tuple(started_at(p, start or {}) for p in (*base.declared_parameters, *added))
        self.least_substeps = max([base.least_substeps, *(a.substeps for a in self.attachments)])
        super().__init__()
        self.base = base

    def effects_told(self) -> tuple[str, ...]:
        return (*self.base.effects_told(), *(f"{a.mechanism.name} at {a.port}" for a in self.attachments))

    @property
    def plain(self) -> GreyBoxModel:
        return self.base.plain

    @property
    def all_ports(self) -> tuple[Port, ...]:
        """Those of the model without effects: the channels of a delayed input are no inputs of the machine."""
        return self.local.base.all_ports

    def parameter_name(self, attachment: Attachment, parameter: str) -> str:
        return f"{attachment.prefix}.{parameter}"

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        seen = self._seen_states(x, u, p)
        acting, reaching = self.paths.inputs(x, u, p)
        forces = self._forces(seen, reaching, acting, p, port, x)
        extra: dict[str, Any] = {}
        shown = self._shown(seen, x, acting, p, forces)
        for a in (a for a in self.attachments if a.mechanism.states(self.surroundings[a.port])):
            local, own, memory = self.given(a, seen, reaching.get(a.prefix, acting), p, forces, x)
            local = local.replaced(output=shown[a.prefix]) if a.prefix in shown else local
            for name, rate in a.mechanism.rates(local, own, memory).items():
                extra[f"{a.prefix}.{name}"] = rate
        rates = dict(self.base.derivative(seen, acting, p, forces))
        for name in self.local.integrated_bodies():
            rates[f"{name}.position"] = value_of(self.local.body(name).speed, x, u, p)
        if self.local.need("time"):
            rates["time"] = torch.ones_like(x[self.states[0].name])
        return {**rates, **extra}

    def output(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return self.paths.outputs(self._true_outputs(x, u, p, port), x, p)[0]

    def _true_outputs(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        """The outputs before what sensors add; where they are forces, with those that act at the ports."""
        acting, reaching = self.paths.inputs(x, u, p)
        if not self.base.shows_forces:
            return dict(self.base.output(x, acting, p))
        forces = self._forces(self._seen_states(x, u, p), reaching, acting, p, port, x)
        return dict(self.base.outputs_with(x, acting, p, forces))

    def shown_forces(self, seen: Any, reaching: Any, acting: Any, p: Any, port: Any, x: Any) -> Signals | None:
        """:meth:`_forces` where an output shows them; else no law asks for them, and evaluating every law would take long."""
        return self._forces(seen, reaching, acting, p, port, x) if self.base.shows_forces else None

    def _forces(self, seen: Any, reaching: Any, acting: Any, p: Any, port: Any, x: Any) -> Signals:
        """The forces at the ports: ``port``, and what the attached laws add to them (:class:`AddedForces`)."""
        return AddedForces(self, seen, reaching, acting, p, x).to(port)

    def admissible(self, p: Any) -> dict[str, Any]:
        return self.base.admissible(p)

    def prepared(self, records: Any, values: Any) -> Any:
        """The records with the delayed inputs appended: value at the present delay, its slope, and the delay itself.

        What acts during the first T of a record was put in before it and is not known: outputs carry no weight there.
        """
        records = self.base.prepared(records, values)
        names = [p.name for p in self.declared_parameters]
        rows, y = [], records.y
        for a in (a for a in self.attachments if "delayed" in a.mechanism.needs):
            site = self.local.ports[a.port]
            assert isinstance(site, Actuator)
            delay = float(values[names.index(f"{a.prefix}.T")])
            for name in (site.input, *a.mechanism.drives):
                rows += delayed(records, [i.name for i in self.base.inputs].index(name), delay)
            if a.prefix not in self.probed:  # a look at a long delay must not hide records from the other looks
                y = np.where(after(records, delay), y, np.nan)
        return records if not rows else replace(records, u=np.concatenate([records.u, np.array(rows)]), y=y)

    def settled(self, records: Any, values: Any) -> Any:
        records = self.base.settled(records, values)
        own = [a for a in self.attachments if a.mechanism.settling > 0 and a.prefix not in self.probed]
        if not own:
            return records
        names = [p.name for p in self.declared_parameters]
        rows = {site.name: i for i, site in enumerate(sensors(tuple(o.name for o in self.base.outputs)))}
        late = [(a, float(values[names.index(f"{a.prefix}.T")])) for a in own]
        return without_what_was_before(records, rows, late)

    def begun(self, states: np.ndarray, records: Any, samples: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Start states (W, n_x) with the memories that begin as their surroundings say."""
        return memories_begun(self, states, records, samples, values)

    def taken_over(
        self, states: np.ndarray, known: GreyBoxModel, records: Any, samples: np.ndarray, values: np.ndarray
    ) -> np.ndarray:
        return loaded_starts(self, states, known, records, samples, values)

    def _shown(self, seen: Signals, x: Signals, acting: Signals, p: Signals, forces: Any) -> dict[str, Any]:
        """What reaches every law at a sensor, by prefix; nothing where no law stands before another."""
        there, looks = self.paths.at_sensors
        if not there or len(there) + len(looks) < 2:
            return {}
        return self.paths.outputs(self.base.outputs_with(seen, acting, p, forces), x, p)[1]

    def signals_at(
        self, x: Signals, u: Signals, p: Signals, forces: Signals | None, unmoved: Signals | None = None
    ) -> Callable[[Attachment], Signals]:
        """The signals at the port of a law, with what the laws before it at an actuator or a sensor pass on."""
        acting, reaching = self.paths.inputs(x, u, p)
        shown = self._shown(x, x, acting, p, forces or self.local.no_forces())

        def at(a: Attachment) -> Signals:
            local = self.local.at(a, x, reaching.get(a.prefix, acting), p, forces, unmoved)
            return local.replaced(output=shown[a.prefix]) if a.prefix in shown else local

        return at

    def carried_states(self) -> tuple[str, ...]:
        """Positions, time and lasting memories: free in every window, they would explain anything."""
        fading = tuple(f"{a.prefix}." for a in self.attachments if a.mechanism.fades)
        own = [s.name for s in self.states[len(self.base.states) :]]
        return (*self.base.carried_states(), *(n for n in own if not n.startswith(fading)))

    def remembered_states(self) -> tuple[str, ...]:
        """Those of the base model, and of memories that last from before a record."""
        own = [f"{a.prefix}.{name}" for a in self.attachments for name in a.mechanism.lasting]
        return (*self.base.remembered_states(), *own)

    def start_trials(self, values: Any) -> list[dict[str, float]]:
        """Positions at which a record may begin: those of bodies that no sensor sees."""
        if not self.local.unseen_positions():
            return self.base.start_trials(values)
        return position_trials(self.local, dict(zip((p.name for p in self.declared_parameters), values, strict=True)))

    def curve(self, attachment: Attachment, signals: Mapping[str, torch.Tensor], p: Any) -> torch.Tensor:
        """The effect's own force for given local signals (without memory), for plots."""
        memory = Signals(
            "memory", {s.name: torch.zeros(()) for s in attachment.mechanism.states(self.surroundings[attachment.port])}
        )
        local, own = (
            Signals("signal", {**self.local.sampling(attachment.port), **signals}),
            self.local.parameters(attachment, p),
        )
        if attachment.mechanism.kinematic:
            return attachment.mechanism.deflection(local, own) - signals["deflection"]
        return attachment.mechanism.force(local, own, memory)

    def local_signals(self, attachment: Attachment, x: Any, u: Any, p: Any) -> Signals:
        """The signals that an attached mechanism sees."""
        seen = self._seen_states(x, u, p)
        acting, reaching = self.paths.inputs(x, u, p)
        forces = self.shown_forces(seen, reaching, acting, p, self.local.no_forces(), x)
        return self.signals_at(seen, u, p, forces, x)(attachment)

    def _seen_states(self, x: Signals, u: Any, p: Any) -> Signals:
        """States with the deflections changed by kinematic mechanisms."""
        for a in self.attachments:
            if a.mechanism.kinematic:
                local, own, _ = self.given(a, x, u, p)
                change = self.share(a, p) * (a.mechanism.deflection(local, own) - local.deflection)
                x = shift.moved(x, a.shifted_state, change)
        return x

    def given(
        self,
        a: Attachment,
        x: Signals,
        u: Signals,
        p: Signals,
        forces: Signals | None = None,
        unmoved: Signals | None = None,
    ) -> tuple[Signals, Signals, Signals]:
        """What a law is a function of: local signals, own parameters, memory."""
        return self.local.at(a, x, u, p, forces, unmoved), self.local.parameters(a, p), self.local.memory(a, x)

    def share(self, a: Attachment, p: Signals) -> Any:
        return p[f"{a.prefix}.{SHARE}"] if a.prefix in self.shared else 1.0
