"""The model that results from attaching mechanisms to another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import torch

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.delayed_input import after, delayed
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Surroundings
from greybox_torch.model import Body, Coupling, GreyBoxModel, Input, Parameter, Signals, State
from greybox_torch.model.ports import Actuator, Sensor, Signal, driving_body

OFFSETS = sorted(np.linspace(-0.9, 0.9, 37), key=abs)
"""Start positions tried, in shares of the travel, where an effect acts at one place."""

START_POSITIONS = 12
"""Start positions tried over one period."""


class AugmentedModel(GreyBoxModel):
    """``base`` with mechanisms attached.

    The base's states come first, then positions and time where mechanisms need them, then the mechanisms' memory. Parameters of a
    mechanism are named ``PORT.MECHANISM.PARAMETER``.

    Args:
        surroundings: by port, what the mechanisms may know of it.
        probed: attachments that get a factor ``share`` on the whole of their effect, for the screen.
        start: parameter values that replace the declared ones.
    """

    def __init__(
        self,
        base: GreyBoxModel,
        attachments: Sequence[Attachment],
        surroundings: Mapping[str, Surroundings],
        *,
        probed: Sequence[Attachment] = (),
        start: Mapping[str, float] | None = None,
    ) -> None:
        self.attachments = tuple(attachments)
        self.surroundings = dict(surroundings)
        self.probed = frozenset(a.prefix for a in probed)
        self.base_ports = {port.name: port for port in base.all_ports}
        for attachment in attachments:
            if attachment.port not in self.base_ports:
                raise UserError(
                    f"model {base.title} has no port '{attachment.port}' (it has: {', '.join(self.base_ports)})"
                )
        self.name = base.title  # type: ignore[misc]
        self.states = [*base.states, *self._position_states(base), *self._time_state(), *self._memory_states()]
        self.inputs = [*base.inputs, *self._delayed_inputs()]
        self.outputs = list(base.outputs)
        self.ports = list(base.ports)
        self.declared_parameters = tuple(
            _restarted(p, start or {}) for p in (*base.declared_parameters, *self._own_parameters())
        )
        super().__init__()
        self.base = base
        self._parameter_names = {
            a.prefix: [q.name for q in a.mechanism.parameters(self.surroundings[a.port])] for a in self.attachments
        }

    @property
    def plain(self) -> GreyBoxModel:
        return self.base.plain

    def parameter_name(self, attachment: Attachment, parameter: str) -> str:
        return f"{attachment.prefix}.{parameter}"

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        seen = self._seen_states(x, u, p)
        acting = self._acting_inputs(x, u, p)
        forces = dict(port)
        extra: dict[str, Any] = {}
        for a in self.attachments:
            site = self.base_ports[a.port]
            local, own, memory = self._local(a, seen, u if isinstance(site, Actuator) else acting, p)
            if not a.mechanism.kinematic and not isinstance(site, Actuator | Sensor):
                forces[a.port] = forces[a.port] + self._share(a, p) * a.mechanism.force(local, own, memory)
            for place, force in self._kinematic_forces(a, local, own):
                forces[place] = forces[place] + self._share(a, p) * force
            for name, rate in a.mechanism.rates(local, own, memory).items():
                extra[f"{a.prefix}.{name}"] = rate
        rates = dict(self.base.derivative(seen, acting, p, Signals("port", forces)))
        for name in self._positions():
            rates[f"{name}.position"] = _value(self._body(name).speed, x, u, p)
        if self._needs("time"):
            rates["time"] = torch.ones_like(x[self.states[0].name])
        return {**rates, **extra}

    def _kinematic_forces(self, a: Attachment, local: Signals, own: Signals) -> list[tuple[str, Any]]:
        """What a kinematic law that follows a body does beyond the change of deflection: forces by port."""
        if not (a.mechanism.kinematic and a.position):
            return []
        found = [(a.position, a.mechanism.reaction(local, own)), (a.port, a.mechanism.damped(local, own))]
        return [(place, force) for place, force in found if force is not None]

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        values = dict(self.base.output(x, self._acting_inputs(x, u, p), p))
        true = dict(values)
        for a in self.attachments:
            site = self.base_ports[a.port]
            if isinstance(site, Sensor):
                local = Signals("signal", {"output": true[site.output], **self._clock(x)})
                own, memory = self._own(a, p), self._memory(a, x)
                values[site.output] = values[site.output] + self._share(a, p) * a.mechanism.force(local, own, memory)
        return values

    def admissible(self, p: Any) -> dict[str, Any]:
        return self.base.admissible(p)

    def prepared(self, records: Any, values: Any) -> Any:
        """The records with the delayed inputs appended: value at the present delay, its slope, and the delay itself.

        What acts during the first T of a record was put in before it and is not known: outputs carry no weight there.
        """
        records = self.base.prepared(records, values)
        names = [p.name for p in self.declared_parameters]
        rows, y = [], records.y
        for a in self._delays():
            site = self.base_ports[a.port]
            assert isinstance(site, Actuator)
            channel = [i.name for i in self.base.inputs].index(site.input)
            delay = float(values[names.index(f"{a.prefix}.T")])
            rows += delayed(records, channel, delay)
            if a.prefix not in self.probed:  # a look at a long delay must not hide records from the other looks
                y = np.where(after(records, delay), y, np.nan)
        return records if not rows else replace(records, u=np.concatenate([records.u, np.array(rows)]), y=y)

    def begun(self, states: np.ndarray, records: Any, samples: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Start states (W, n_x) with the memories that begin as their surroundings say."""
        names = [s.name for s in self.states]
        x = Signals("state", {n: torch.as_tensor(states[:, i]) for i, n in enumerate(names)})
        u = Signals("input", {s.name: torch.as_tensor(records.u[i, samples]) for i, s in enumerate(self.inputs)})
        pairs = zip(self.declared_parameters, values, strict=True)
        p = Signals("parameter", {q.name: torch.tensor(float(v), dtype=torch.float64) for q, v in pairs})
        own = len(self.base.states), len(self.base.declared_parameters)
        result = states.copy()
        result[:, : own[0]] = self.base.begun(states[:, : own[0]], records, samples, values[: own[1]])
        for a in self.attachments:
            for name, value in a.mechanism.starts(self._local(a, x, u, p)[0]).items():
                result[:, names.index(f"{a.prefix}.{name}")] = np.asarray(value)
        return result

    def carried_states(self) -> tuple[str, ...]:
        """Positions, time and lasting memories: free in every window, they would explain anything."""
        fading = tuple(f"{a.prefix}." for a in self.attachments if a.mechanism.fades)
        own = [s.name for s in self.states[len(self.base.states) :]]
        return (*self.base.carried_states(), *(n for n in own if not n.startswith(fading)))

    def start_trials(self, values: Any) -> list[dict[str, float]]:
        """Positions at which a record may begin: those of bodies that no sensor sees, over one period of the slowest periodic effect."""
        bodies = self._positions()
        if not bodies:
            return self.base.start_trials(values)
        numbers = dict(zip((p.name for p in self.declared_parameters), values, strict=True))
        if any(a.position and not _periodic(a.mechanism) for a in self.attachments):
            travel = [self.surroundings[a.port].ranges["position"] for a in self.attachments if a.position]
            span = max(r.high - r.low for r in travel)
            return [{f"{b}.position": share * span for b in bodies} for share in OFFSETS]
        orders = [abs(float(numbers.get(f"{a.prefix}.order", 1.0))) for a in self.attachments if a.position]
        period = 2 * np.pi / max(min(orders), 1e-9)
        return [{f"{b}.position": k * period / START_POSITIONS for b in bodies} for k in range(START_POSITIONS)]

    def curve(self, attachment: Attachment, signals: Mapping[str, torch.Tensor], p: Any) -> torch.Tensor:
        """The effect's own force for given local signals (without memory), for plots."""
        memory = Signals(
            "memory", {s.name: torch.zeros(()) for s in attachment.mechanism.states(self.surroundings[attachment.port])}
        )
        local, own = Signals("signal", signals), self._own(attachment, p)
        if attachment.mechanism.kinematic:
            return attachment.mechanism.deflection(local, own) - signals["deflection"]
        return attachment.mechanism.force(local, own, memory)

    def local_signals(self, attachment: Attachment, x: Any, u: Any, p: Any) -> Signals:
        """The signals that an attached mechanism sees."""
        return self._local(attachment, self._seen_states(x, u, p), u, p)[0]

    def _seen_states(self, x: Signals, u: Any, p: Any) -> Signals:
        """States with the deflections changed by kinematic mechanisms."""
        for a in self.attachments:
            if a.mechanism.kinematic:
                local, own, _ = self._local(a, x, u, p)
                change = self._share(a, p) * (a.mechanism.deflection(local, own) - local.deflection)
                name = a.shifted_state[1:]
                x = x.replaced(**{name: x[name] + change if a.shifted_state[0] == "+" else x[name] - change})
        return x

    def _acting_inputs(self, x: Signals, u: Signals, p: Signals) -> Signals:
        acting = u
        for a in self.attachments:
            site = self.base_ports[a.port]
            if isinstance(site, Actuator):
                local, own, memory = self._local(a, x, u, p)
                change = self._share(a, p) * a.mechanism.force(local, own, memory)
                acting = acting.replaced(**{site.input: acting[site.input] + change})
        return acting

    def _local(self, a: Attachment, x: Signals, u: Signals, p: Signals) -> tuple[Signals, Signals, Signals]:
        site = self.base_ports[a.port]
        values: dict[str, Any] = {
            name: _value(signal, x, u, p) for name, signal in site.signals.items() if name != "position"
        }
        if "position" in a.mechanism.needs or getattr(a.mechanism, "signal", "") == "position":
            values["position"] = self._position(a.position, x, u, p)
        if isinstance(site, Coupling) and a.position and "load" in self.surroundings[a.port].ranges:
            values["load"] = _value(self._body(a.position).signals["load"], x, u, p)
        if a.mechanism.kinematic and a.position:
            values["speed"] = _value(self._body(a.position).speed, x, u, p)
        driving = driving_body(self.base_ports.values())
        if (
            driving is not None
            and isinstance(site, Actuator | Coupling)
            and "speed" in (*a.mechanism.needs, getattr(a.mechanism, "signal", ""))
        ):
            values["speed"] = _value(driving.speed, x, u, p)
        if isinstance(site, Sensor):
            values["output"] = self.base.output(x, u, p)[site.output]
        if "delayed" in a.mechanism.needs:
            value, slope, at = (u[f"{a.prefix}.{n}"] for n in ("delayed", "slope", "delay"))
            values["delayed"] = value + (p[f"{a.prefix}.T"] - at) * slope
        values |= self._clock(x)
        return Signals("signal", values), self._own(a, p), self._memory(a, x)

    def _clock(self, x: Signals) -> dict[str, Any]:
        return {"time": x["time"]} if self._needs("time") else {}

    def _own(self, a: Attachment, p: Signals) -> Signals:
        start = f"{a.prefix}."
        return Signals(
            "parameter", {name.removeprefix(start): value for name, value in p.items() if name.startswith(start)}
        )

    def _memory(self, a: Attachment, x: Signals) -> Signals:
        names = [s.name for s in a.mechanism.states(self.surroundings[a.port])]
        return Signals("memory", {n: x[f"{a.prefix}.{n}"] for n in names})

    def _share(self, a: Attachment, p: Signals) -> Any:
        return p[f"{a.prefix}.{SHARE}"] if a.prefix in self.probed else 1.0

    def _needs(self, signal: str) -> bool:
        return any(
            signal in a.mechanism.needs or getattr(a.mechanism, "signal", "") == signal for a in self.attachments
        )

    def _delays(self) -> list[Attachment]:
        return [a for a in self.attachments if "delayed" in a.mechanism.needs]

    def _body(self, name: str) -> Body:
        body = self.base_ports[name]
        assert isinstance(body, Body)
        return body

    def _positions(self) -> list[str]:
        """Bodies whose position has to be integrated from their speed."""
        names = [a.position for a in self.attachments if a.position]
        return [n for n in dict.fromkeys(names) if self._body(n).position is None]

    def _position(self, name: str, x: Signals, u: Signals, p: Signals) -> Any:
        signal = self._body(name).position
        return x[f"{name}.position"] if signal is None else _value(signal, x, u, p)

    def _position_states(self, base: GreyBoxModel) -> list[State]:
        return [State(f"{n}.position", position_unit(base, self._body(n)), 0.0, fixed=True) for n in self._positions()]

    def _time_state(self) -> list[State]:
        return [State("time", "s", 0.0, fixed=True)] if self._needs("time") else []

    def _memory_states(self) -> list[State]:
        return [
            replace(s, name=f"{a.prefix}.{s.name}")
            for a in self.attachments
            for s in a.mechanism.states(self.surroundings[a.port])
        ]

    def _delayed_inputs(self) -> list[Input]:
        return [Input(f"{a.prefix}.{n}") for a in self._delays() for n in ("delayed", "slope", "delay")]

    def _own_parameters(self) -> list[Parameter]:
        result = []
        for a in self.attachments:
            result += [
                replace(q, name=f"{a.prefix}.{q.name}") for q in a.mechanism.parameters(self.surroundings[a.port])
            ]
            if a.prefix in self.probed:
                result.append(Parameter(f"{a.prefix}.{SHARE}", 1.0))
        return result


def _periodic(mechanism: Mechanism) -> bool:
    return hasattr(mechanism, "order") or mechanism.name == "gravity"


def position_unit(model: GreyBoxModel, body: Body) -> str:
    """The unit of a body's position: that of its position state, else its speed's without the per-second."""
    units = {s.name: s.unit for s in model.states}
    if isinstance(body.position, str):
        return units.get(body.position, "")
    return units.get(body.speed, "").replace("/s", "") if isinstance(body.speed, str) else ""


def _value(signal: Signal, x: Signals, u: Signals, p: Signals) -> Any:
    return x[signal] if isinstance(signal, str) else signal(x, u, p)


def _restarted(parameter: Parameter, start: Mapping[str, float]) -> Parameter:
    if parameter.name not in start:
        return parameter
    low, high = parameter.bounds
    return replace(parameter, value=float(np.clip(start[parameter.name], low, high)))
