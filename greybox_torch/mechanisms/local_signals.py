"""What an attached mechanism sees of the model: the signals at its port, its own parameters, and its memory."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from greybox_torch.errors import UserError
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.delayed_input import channels
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.spring_force import moved_states, spring_force
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Signals
from greybox_torch.model.along_motion import ALONG, DIRECTION, direction
from greybox_torch.model.own_rate import RATE, own_rate
from greybox_torch.model.port_forces import no_forces
from greybox_torch.model.ports import Actuator, Port, Sensor, driving_body, value_of
from greybox_torch.model.signals_elsewhere import ABOVE, DIFFERENCE, above, difference
from greybox_torch.model.states_at_no_port import STATE
from greybox_torch.model.within_turn import TURN, TURN_OF, within_turn


class LocalSignals:
    """Signals by the names that mechanisms know, from the states, inputs and parameters of ``base`` with ``attachments``."""

    def __init__(
        self, base: GreyBoxModel, attachments: Sequence[Attachment], surroundings: Mapping[str, Surroundings]
    ) -> None:
        self.base = base
        self.attachments = tuple(attachments)
        self.surroundings = surroundings
        self.ports: dict[str, Port] = {port.name: port for port in base.all_ports}
        self._moved: dict[str, list[str]] = {}
        self._grouped: tuple[tuple[str, ...], dict[str, dict[str, str]]] = ((), {})

    def at(
        self, a: Attachment, x: Any, u: Any, p: Any, forces: Signals | None = None, unmoved: Signals | None = None
    ) -> Signals:
        """The signals at the port of an attachment; ``forces`` at the ports, where others are attached (a sensor may show them, and they
        change the rate at a port); ``unmoved`` the states where laws have moved ``x`` to change a deflection: bodies are where they were.
        """
        true = x if unmoved is None else unmoved
        site = self.ports[a.port]
        values: dict[str, Any] = {
            name: value_of(signal, x, u, p) for name, signal in site.signals.items() if name != "position"
        }
        if "position" in (*a.mechanism.needs, getattr(a.mechanism, "signal", ""), getattr(a.mechanism, "factor", "")):
            values["position"] = self._position(a.position, true, u, p)
        if isinstance(site, Body) and getattr(a.mechanism, "signal", "") == TURN:
            values[TURN] = within_turn(site, true, u, p)
        if isinstance(site, Coupling) and a.position and self._shows_load(a):
            values["load"] = value_of(self.body(a.position).signals["load"], x, u, p)
        if a.mechanism.kinematic and a.position:
            values["speed"] = value_of(self.body(a.position).speed, x, u, p)
        driving = driving_body(self.ports.values())
        if (
            driving is not None
            and isinstance(site, Actuator | Coupling)
            and "speed" in (*a.mechanism.needs, getattr(a.mechanism, "signal", ""))
        ):
            values["speed"] = value_of(driving.speed, x, u, p)
        if isinstance(site, Sensor):
            values["output"] = self.base.outputs_with(x, u, p, forces or self.no_forces())[site.output]
        values |= self.sampling(a.port)
        if "delayed" in a.mechanism.needs:
            for names in channels(a.mechanism):
                value, slope, at = (u[f"{a.prefix}.{n}"] for n in names)
                values[names[0]] = value + (p[f"{a.prefix}.T"] - at) * slope
        values |= {f"input@{name}": u[name] for name in a.mechanism.drives}
        values |= {f"position@{link}": self._position(link, true, u, p) for link in a.mechanism.links}
        values |= {one: self._from_elsewhere(site, one, x, u, p, forces) for one in a.mechanism.reads}
        values |= self.clock(x)
        return Signals("signal", values)

    def with_load(self, a: Attachment, local: Signals, x: Signals, u: Signals, p: Signals) -> Signals:
        """The signals ``local`` of a law that follows a body's position, with what a coupling carries where the model does not tell."""
        if not (a.mechanism.kinematic and a.position and a.shifted_state) or "load" in local:
            return local
        if "load" not in self.surroundings[a.port].ranges:
            return local
        none = self.no_forces()
        if a.port not in self._moved:
            self._moved[a.port] = moved_states(self.base, a.port, none)
        return local.replaced(load=spring_force(self.base, a.port, a.shifted_state, self._moved[a.port], x, u, p, none))

    def _shows_load(self, a: Attachment) -> bool:
        """Whether the model tells what the body of an attachment carries."""
        return "load" in self.surroundings[a.port].ranges and "load" in self.body(a.position).signals

    def sampling(self, port: str) -> dict[str, Any]:
        """The sample time in s, for laws of bodies, actuators and sensors that may act within a sample."""
        return (
            {"sample_time": self.surroundings[port].sample_time}
            if isinstance(self.ports[port], Actuator | Body | Sensor)
            else {}
        )

    def clock(self, x: Signals) -> dict[str, Any]:
        return {"time": x["time"]} if self.need("time") else {}

    def states_read(self, a: Attachment, x: Signals) -> dict[str, Any]:
        """The states of the model that a law reads."""
        return {one: x[one.removeprefix(STATE)] for one in a.mechanism.reads if one.startswith(STATE)}

    def parameters(self, a: Attachment, p: Signals) -> Signals:
        """The mechanism's own parameters, by their short names."""
        names = tuple(p)
        if names != self._grouped[0]:
            self._grouped = names, _by_prefix(names, {one.prefix for one in self.attachments})
        return Signals("parameter", {short: p[name] for short, name in self._grouped[1][a.prefix].items()})

    def memory(self, a: Attachment, x: Signals) -> Signals:
        """The mechanism's own states, by their short names."""
        names = [s.name for s in a.mechanism.states(self.surroundings[a.port])]
        return Signals("memory", {n: x[f"{a.prefix}.{n}"] for n in names})

    def need(self, signal: str) -> bool:
        """Whether any mechanism uses a signal."""
        return any(
            signal in a.mechanism.needs or getattr(a.mechanism, "signal", "") == signal for a in self.attachments
        )

    def integrated_bodies(self) -> list[str]:
        """Bodies whose position has to be integrated from their speed."""
        names = [a.position for a in self.attachments if a.position]
        return [n for n in dict.fromkeys(names) if self.body(n).position is None]

    def unseen_positions(self) -> list[str]:
        """States with positions that no sensor shows: integrated ones, and those of the model that nothing else depends on."""
        kept = self.base.carried_states()
        names = dict.fromkeys(a.position for a in self.attachments if a.position)
        states = [f"{n}.position" if self.body(n).position is None else self.body(n).position for n in names]
        return [s for s in states if isinstance(s, str) and (s in kept or s.endswith(".position"))]

    def body(self, name: str) -> Body:
        body = self.ports[name]
        assert isinstance(body, Body)
        return body

    def no_forces(self) -> Signals:
        """The forces at all ports where nothing acts."""
        return no_forces(self.base)

    def check(self, a: Attachment) -> None:
        """Whether the model has the port of an attachment, and all that it reads a signal of.

        Raises:
            UserError: it has not.
        """
        named = (("port", a.port), *(signal.split("@", 1) for signal in a.mechanism.reads))
        for kind, name in named:
            told, there = (
                ("input", [i.name for i in self.base.inputs])
                if kind in ("input", "along", "above")
                else ("state", [s.name for s in self.base.states])
                if kind == "state"
                else ("port", list(self.ports))
            )
            if name not in there:
                why = "" if kind == "port" else f", which the effect at '{a.port}' depends on"
                raise UserError(f"model {self.base.title} has no {told} '{name}'{why} (it has: {', '.join(there)})")

    def _from_elsewhere(
        self, site: Port, signal: str, x: Signals, u: Signals, p: Signals, forces: Signals | None
    ) -> Any:
        """An input or a state of the model, an input along a body's motion, a signal of another port, its angle within a turn, by how much
        the level of a balance is above another one's or an input, or a port's rate.
        """
        kind, _, name = signal.partition("@")
        if kind == "input":
            return u[name]
        if signal.startswith(STATE):
            return x[name]
        if signal.startswith(ABOVE):
            assert isinstance(site, Balance)
            return value_of(above(site, name), x, u, p)
        if signal.startswith((ALONG, DIRECTION)):
            assert isinstance(site, Body)
            way = direction(value_of(site.speed, x, u, p), self.surroundings[site.name].ranges["speed"].rms)
            return u[name] * way if signal.startswith(ALONG) else way
        other = self.ports[name]
        if signal.startswith(RATE):
            return own_rate(self.base, other, x, u, p, forces or self.no_forces())
        if signal.startswith(DIFFERENCE):
            assert isinstance(site, Balance) and isinstance(other, Balance)
            return value_of(difference(site, other), x, u, p)
        if isinstance(other, Body) and signal.startswith(TURN_OF):
            return within_turn(other, x, u, p)
        return value_of(other.signals[kind], x, u, p)

    def _position(self, name: str, x: Signals, u: Signals, p: Signals) -> Any:
        signal = self.body(name).position
        return x[f"{name}.position"] if signal is None else value_of(signal, x, u, p)


def _by_prefix(names: Sequence[str], prefixes: Collection[str]) -> dict[str, dict[str, str]]:
    """The full names by short ones of what begins with every prefix. (A screen has hundreds of effects and thousands of parameters.)"""
    found: dict[str, dict[str, str]] = {prefix: {} for prefix in prefixes}
    for name in names:
        parts = name.split(".")
        for k in range(1, len(parts)):
            if (prefix := ".".join(parts[:k])) in found:
                found[prefix][".".join(parts[k:])] = name
    return found
