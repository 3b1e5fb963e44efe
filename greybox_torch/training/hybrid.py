"""A physical model with a network at one of its ports, as an estimation problem."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from inspect import signature

import numpy as np

from greybox_torch.errors import ArgumentError, did_you_mean
from greybox_torch.estimate.problem import Problem, problem_for
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.friction_net import FrictionNet
from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.mechanisms.memory_net import MemoryNet
from greybox_torch.mechanisms.network import Network
from greybox_torch.mechanisms.residual_net import ResidualNet
from greybox_torch.model import GreyBoxModel, Port
from greybox_torch.model.ports import driving_body
from greybox_torch.training.signal_names import local_names, names_in_model, readable, told_names

NETWORKS: dict[str, type[Network]] = {"friction": FrictionNet, "residual": ResidualNet, "memory": MemoryNet}
"""By the name that users choose them by."""

WHAT_IT_ADDS = {
    "body": "force",
    "coupling": "force",
    "balance": "flow",
    "actuator": "change of the input",
    "sensor": "change of the output",
}
"""What a network adds, in words, by kind of port."""

USUAL_SIGNALS = {
    "body": ("speed",),
    "coupling": ("deflection", "rate"),
    "balance": ("level",),
    "actuator": ("input",),
    "sensor": ("output",),
}
"""What a network reads where nothing is asked for, by kind of port."""


@dataclass(frozen=True)
class Hybrid:
    """``problem`` of the augmented model, whose network is the last of its ``attachments``; ``surroundings`` by port."""

    problem: Problem
    attachments: tuple[Attachment, ...]
    surroundings: Mapping[str, Surroundings]

    @property
    def network(self) -> Attachment:
        return self.attachments[-1]

    @property
    def adds(self) -> str:
        """What the network adds to the physics, in words."""
        return WHAT_IT_ADDS[port_named(self.problem.model, self.network.port).kind]

    def told(self, signals: Sequence[str]) -> tuple[str, ...]:
        """The names that the model has for signals of the network's port."""
        return names_in_model(self.problem.model, port_named(self.problem.model, self.network.port), signals)

    @property
    def is_network(self) -> np.ndarray:
        """Which parameters (n_p,) are the network's."""
        return np.array([name.startswith(f"{self.network.prefix}.") for name in self.problem.names])

    @property
    def heights(self) -> np.ndarray:
        """Which parameters (n_p,) are weights of its output, zero where there is no network."""
        shrunk = np.array([p.shrunk for p in self.problem.model.declared_parameters], dtype=bool)
        return shrunk & self.is_network


def default_port(model: GreyBoxModel) -> str:
    """Where a network acts if nothing is said: the driving body, else the first port."""
    body = driving_body(model.ports)
    return model.all_ports[0].name if body is None else body.name


def chosen_net(model: GreyBoxModel, net: str | None, port: str | None) -> str:
    """``net``; where nothing is said, "friction" at a body, and "residual" at any other port.

    Raises:
        UserError: there is no such port.
    """
    if net is not None:
        return net
    return "friction" if port_named(model, port or default_port(model)).kind in FrictionNet.kinds else "residual"


def network_at(
    model: GreyBoxModel, net: str | None, port: str | None, signals: Sequence[str], **options: object
) -> tuple[Port, Network]:
    """The port of ``model``, and the network for it, as nothing is said by default; raises as the two functions below."""
    net = chosen_net(model, net, port)
    if port is None and net == "friction" and driving_body(model.ports) is None:
        raise ArgumentError("net", net, f'model {model.title} has no body; expected the net "residual"')
    site = port_named(model, port or default_port(model))
    return site, make_network(net, site, local_names(model, site, signals), **options)


def make_network(net: str, port: Port, signals: Sequence[str], **options: object) -> Network:
    """A network for ``port``: "friction", "residual" or "memory", reading ``signals`` (the usual ones of such a port where there are none).

    Raises:
        UserError: no such network, one that does not belong at such a port, or an option that it does not have.
    """
    if net not in NETWORKS:
        raise ArgumentError("net", net, f"unknown{did_you_mean(net, NETWORKS)}; expected one of {', '.join(NETWORKS)}")
    made = NETWORKS[net]
    known = [name for name in signature(made).parameters if name != "inputs"]
    for option in options:
        if option not in known:
            problem = (
                f"a {net} network has no such option{did_you_mean(option, known)}; expected some of {', '.join(known)}"
            )
            raise ArgumentError("network", option, problem)
    if port.kind not in made.kinds:
        problem = f"a {net} network belongs at a {' or '.join(made.kinds)}, and this is a {port.kind}; "
        raise ArgumentError("port", port.name, f'{problem}expected another port, or the net "residual"')
    if made is FrictionNet and signals and "speed" not in signals:
        read = ",".join(signals)
        raise ArgumentError("signals", read, 'expected the speed among them, or the net "residual" for other signals')
    return made(signals or USUAL_SIGNALS[port.kind], **options)  # type: ignore[arg-type]


def port_named(model: GreyBoxModel, name: str) -> Port:
    """The port of ``model`` called ``name``. Raises UserError where there is none."""
    ports = {port.name: port for port in model.all_ports}
    if name not in ports:
        known = ", ".join(ports)
        raise ArgumentError(
            "port", name, f"model {model.title} has no such port{did_you_mean(name, ports)}; it has: {known}"
        )
    return ports[name]


def check_signals(network: Mechanism, model: GreyBoxModel, port: Port, around: Surroundings) -> None:
    """Raises UserError where ``network`` reads a signal that there is not around ``port`` of ``model``."""
    known = readable(around)
    for signal, asked in zip(network.needs, told_names(model, port, network.needs), strict=True):
        if signal not in known:
            told = told_names(model, port, known)
            also = (state for name, state in port.signals.items() if name in known and isinstance(state, str))
            hint = did_you_mean(asked, (*told, *also))
            problem = f"there is no such signal at {port.name}{hint}; there is: {', '.join(told)}"
            raise ArgumentError("signals", asked, problem)


def attach_network(
    physics: Problem,
    port: str,
    network: Mechanism,
    surroundings: Mapping[str, Surroundings],
    *,
    others: Sequence[Attachment] = (),
) -> Hybrid:
    """``physics`` with ``network`` at ``port``: the same simulation to begin with.

    Args:
        physics: of the plain model, or with named mechanisms attached already.
        others: those mechanisms, where the hybrid is to have them beside the network; ``physics`` is then of the plain model.

    Raises:
        UserError: there is no such port, or no such signal there.
    """
    site = port_named(physics.model, port)
    check_signals(network, physics.model.plain, site, surroundings[site.name])
    attachments = (*others, attach(physics.model, port, network))
    model = AugmentedModel(physics.model, attachments, surroundings)
    return Hybrid(problem_for(physics, model, {}), attachments, surroundings)
