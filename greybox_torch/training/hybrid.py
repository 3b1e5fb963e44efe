"""A physical model with a network at one of its ports, as an estimation problem."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

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

NETWORKS: dict[str, type[Network]] = {"friction": FrictionNet, "residual": ResidualNet, "memory": MemoryNet}
"""By the name that users choose them by."""

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
    def is_network(self) -> np.ndarray:
        """Which parameters (n_p,) are the network's."""
        return np.array([name.startswith(f"{self.network.prefix}.") for name in self.problem.names])

    @property
    def heights(self) -> np.ndarray:
        """Which parameters (n_p,) are weights of its output, zero where there is no network."""
        shrunk = np.array([p.shrunk for p in self.problem.model.declared_parameters], dtype=bool)
        return shrunk & self.is_network


def default_port(model: GreyBoxModel, net: str) -> str:
    """Where a network acts if nothing is said: the driving body, else (for a network that is not friction) the first port.

    Raises:
        UserError: a friction network, and no body.
    """
    body = driving_body(model.ports)
    if body is not None:
        return body.name
    if net == "friction":
        raise ArgumentError("net", net, f'model {model.title} has no body; expected "residual" and a port')
    return model.all_ports[0].name


def network_at(
    model: GreyBoxModel, net: str, port: str | None, signals: Sequence[str], **options: object
) -> tuple[Port, Network]:
    """The port of ``model``, by default where such a network belongs, and the network for it; raises as the two functions below."""
    site = port_named(model, port or default_port(model, net))
    return site, make_network(net, site, signals, **options)


def make_network(net: str, port: Port, signals: Sequence[str], **options: object) -> Network:
    """A network for ``port``: "friction", "residual" or "memory", reading ``signals`` (the usual ones of such a port where there are none).

    Raises:
        UserError: no such network, or one that does not belong at such a port.
    """
    if net not in NETWORKS:
        raise ArgumentError("net", net, f"unknown{did_you_mean(net, NETWORKS)}; expected one of {', '.join(NETWORKS)}")
    made = NETWORKS[net]
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


def check_signals(network: Mechanism, port: Port, around: Surroundings) -> None:
    """Raises UserError where ``network`` reads a signal that there is not around ``port``."""
    known = [name for name in around.ranges if name != "delayed" and "@" not in name]
    for signal in network.needs:
        if signal not in known:
            hint = did_you_mean(signal, known)
            problem = f"there is no such signal at {port.name}{hint}; there is: {', '.join(known)}"
            raise ArgumentError("signals", signal, problem)


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
    check_signals(network, site, surroundings[site.name])
    attachments = (*others, attach(physics.model, port, network))
    model = AugmentedModel(physics.model, attachments, surroundings)
    return Hybrid(problem_for(physics, model, {}), attachments, surroundings)
