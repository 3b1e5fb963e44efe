"""Where the signals around every port moved in the recordings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import torch

from greybox_torch.estimate.excitation import any_input_moves, excited_up_to
from greybox_torch.estimate.force_unit import force_unit
from greybox_torch.estimate.free_run import visited_states
from greybox_torch.estimate.measured_range import as_measured, farther, no_farther
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.shifted_states import shifted_state
from greybox_torch.estimate.travel import comes_back, either_way, integrated
from greybox_torch.mechanisms.added_declarations import position_unit
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.spring_force import moved_states, spring_force
from greybox_torch.mechanisms.unknown import INPUT
from greybox_torch.model import Balance, Body, Coupling, GreyBoxModel, Port, Signals
from greybox_torch.model.along_motion import ALONG, DIRECTION, direction, inputs_that_push
from greybox_torch.model.joined_bodies import turns_with
from greybox_torch.model.own_rate import RATE, balanced_state, without_laws
from greybox_torch.model.port_forces import no_forces
from greybox_torch.model.ports import Actuator, Sensor, Signal, driving_body
from greybox_torch.model.sensed_states import sensed_states
from greybox_torch.model.signals_elsewhere import (
    ABOVE,
    DIFFERENCE,
    SPEED,
    positions_elsewhere,
    signals_elsewhere,
    turning_elsewhere,
)
from greybox_torch.model.states_of import states_of
from greybox_torch.model.unit_of_rate import unit_of_integral, unit_of_rate
from greybox_torch.model.within_turn import TURN, WHOLE
from greybox_torch.simulation.simulator import Simulator

SEEN_AGAIN = 1.5
"""Turns that a shaft has to travel for what depends on its angle to be seen to repeat."""

A_TURN = Range(0.0, WHOLE, WHOLE / 3**0.5)
"""Where a shaft stands within its turn."""


def survey(model: GreyBoxModel, problem: Problem, simulator: Simulator) -> dict[str, Surroundings]:
    """Ranges of the signals around every port of ``model``, along the free run of ``problem`` (of that model, or of it augmented)."""
    return surroundings_along(model, problem, np.concatenate(visited_states(problem, simulator)))


def surroundings_along(model: GreyBoxModel, problem: Problem, states: np.ndarray) -> dict[str, Surroundings]:
    """Ranges of the signals around every port of ``model``, along states (N, n_x or more) at the samples of the problem's records."""
    x, u = model.named_signals(torch.as_tensor(states.T), torch.as_tensor(problem.records.u))
    p = problem.parameter_tensors
    times = np.concatenate([problem.records.time(e) for e in range(len(problem.records.first))])
    excited, timed = excited_up_to(problem.records), len(model.outputs) > 1 or any_input_moves(problem.records)
    around = {port.name: _around(model, port, x, u, p, times, problem) for port in model.all_ports}
    return {name: replace(one, excited=excited, timed=timed) for name, one in around.items()}


def _around(
    model: GreyBoxModel, port: Port, x: Signals, u: Signals, p: Signals, times: np.ndarray, problem: Problem
) -> Surroundings:
    values = {name: _evaluated(signal, x, u, p, times) for name, signal in port.signals.items()}
    once = frozenset[str]()
    if isinstance(port, Body) and "position" not in values:
        values["position"] = integrated(values["speed"], problem.records)
        once = frozenset[str]() if comes_back(values["position"], problem.records) else frozenset({"position"})
    if isinstance(port, Coupling):
        body = driving_body(model.ports)
        if body is not None:
            if body.position is not None:
                values["position"] = _evaluated(body.position, x, u, p, times)
            else:
                values["position"] = integrated(_evaluated(body.speed, x, u, p, times), problem.records)
            if turns_with(port, body, x, u, p):
                values |= _load(model, port, body, x, u, p, times, problem)
    if isinstance(port, Actuator | Coupling) and (body := driving_body(model.ports)) is not None:
        values["speed"] = _evaluated(body.speed, x, u, p, times)
        if isinstance(port, Actuator) and body.position is not None:
            values["position"] = _evaluated(body.position, x, u, p, times)
    if isinstance(port, Body | Balance):
        values |= {f"{INPUT}{one.name}": np.asarray(u[one.name], dtype=float) for one in model.inputs}
    values |= {name: _evaluated(signal, x, u, p, times) for name, signal in signals_elsewhere(model, port).items()}
    if isinstance(port, Body):
        values |= _along_motion(model, port, u, values["speed"])
    if balanced_state(model, port):
        values[f"{RATE}{port.name}"] = _evaluated(without_laws(model, port), x, u, p, times)
    if isinstance(port, Sensor):
        row = [o.name for o in model.outputs].index(port.output)
        values["output"] = problem.records.y[row][~np.isnan(problem.records.y[row])]
    values["time"] = times
    units = _of_sums(model, port, x, u, p) | _units(model, port)
    _complete(port, units)
    ranges = {name: _range(v) for name, v in values.items()}
    hidden = frozenset[str]()
    if isinstance(port, Coupling):
        hidden = frozenset(n for n, signal in port.signals.items() if not _is_measured(model, signal))
        if "deflection" in ranges and "deflection" not in hidden:
            measured = as_measured(model, port.signals["deflection"], x, u, problem)
            ranges["deflection"] = farther(ranges["deflection"], measured)
    if isinstance(port, Body):
        if port.position is not None and _is_measured(model, port.position):
            ranges["position"] = no_farther(ranges["position"], as_measured(model, port.position, x, u, problem))
        else:
            hidden = frozenset({"position"})
    if isinstance(port, Body) and _repeats(port, ranges["position"], units["position"]):
        ranges[TURN], units[TURN] = A_TURN, "rad"
    for signal, body in turning_elsewhere(model, port).items():
        assert body.position is not None
        if _repeats(body, _range(_evaluated(body.position, x, u, p, times)), position_unit(model, body)):
            fast = f"{SPEED}{body.name}"
            ranges |= {signal: A_TURN, fast: _range(_evaluated(body.speed, x, u, p, times))}
            units |= {signal: "rad", fast: "rad/s"}
    step = float(np.median(problem.records.dt))
    return Surroundings(ranges, units, force_unit(model, port, units), step, hidden, passed_once=once)


def _load(
    model: GreyBoxModel,
    port: Coupling,
    body: Body,
    x: Signals,
    u: Signals,
    p: Signals,
    times: np.ndarray,
    problem: Problem,
) -> dict[str, np.ndarray]:
    """What the driving body carries, or else what a coupling transmits, where a state carries the change of its deflection."""
    if body.load is not None:
        return {"load": _evaluated(body.load, x, u, p, times)}
    shifted = shifted_state(model, problem, port)
    if body.position is None or not shifted:
        return {}
    none = no_forces(model)
    force = spring_force(model, port.name, shifted, moved_states(model, port.name, none), x, u, p, none)
    return {"load": np.broadcast_to(np.asarray(force.detach(), dtype=float), times.shape)}


def _along_motion(model: GreyBoxModel, body: Body, u: Signals, speed: np.ndarray) -> dict[str, np.ndarray]:
    """The inputs that push a body, along its motion, and the direction of that; none of a body that went one way alone, and no input that
    never brakes it: what such a one does is said at its actuator.
    """
    way = direction(torch.tensor(speed), _range(speed).rms).numpy()
    if not either_way(way):
        return {}
    along = {name: np.asarray(u[name], dtype=float) * way for name in inputs_that_push(model)[body.name]}
    braking = {f"{ALONG}{name}": values for name, values in along.items() if either_way(values)}
    return {**braking, f"{DIRECTION}{body.name}": way}


def _repeats(body: Body, travel: Range, unit: str) -> bool:
    """Whether the recordings show again what depends on where a shaft stands within its turn."""
    return body.position is not None and unit == "rad" and travel.span > SEEN_AGAIN * WHOLE


def _is_measured(model: GreyBoxModel, signal: Signal) -> bool:
    """Whether a signal depends on states alone that outputs show."""
    return states_of(model, signal) <= set(sensed_states(model))


def _evaluated(signal: Signal, x: Signals, u: Signals, p: Signals, times: np.ndarray) -> np.ndarray:
    value = x[signal] if isinstance(signal, str) else signal(x, u, p)
    return np.broadcast_to(np.asarray(value, dtype=float), times.shape)


def _range(values: np.ndarray) -> Range:
    finite = values[np.isfinite(values)]
    if not len(finite):
        return Range(-1.0, 1.0, 1.0)
    return Range(float(finite.min()), float(finite.max()), float(np.sqrt(np.mean(finite**2))))


def _units(model: GreyBoxModel, port: Port) -> dict[str, str]:
    of = {s.name: s.unit for s in (*model.states, *model.inputs)}
    signals = port.signals | signals_elsewhere(model, port)
    units = {name: of[signal] for name, signal in signals.items() if isinstance(signal, str) and signal in of}
    if isinstance(port, Body):
        units["position"] = position_unit(model, port)
    if isinstance(port, Body | Coupling):
        units |= {name: position_unit(model, b) for name, b in positions_elsewhere(model, port).items()}
    if isinstance(port, Body | Balance):
        units |= {f"{kind}{one.name}": one.unit for kind in (INPUT, ALONG) for one in model.inputs}
    if isinstance(port, Balance) and "level" in units:
        units |= {name: units["level"] for name in signals if name.startswith((DIFFERENCE, ABOVE))}
    if state := balanced_state(model, port):
        units[f"{RATE}{port.name}"] = unit_of_rate(of[state])
    if isinstance(port, Actuator):
        units["input"] = of[port.input]
    body = driving_body(model.ports)
    if isinstance(port, Actuator | Coupling) and body is not None and isinstance(body.speed, str):
        units["speed"] = of[body.speed]
    if isinstance(port, Actuator) and body is not None and body.position is not None:
        units["position"] = position_unit(model, body)
    if isinstance(port, Sensor):
        units["output"] = next(o.unit for o in model.outputs if o.name == port.output)
    units["time"] = "s"
    return units


def _complete(port: Port, units: dict[str, str]) -> None:
    """Where only one of a coupling's deflection and its rate has a known unit, the other's follows."""
    if isinstance(port, Coupling):
        if "deflection" in units and "rate" not in units:
            units["rate"] = f"{units['deflection']}/s"
        if "rate" in units and "deflection" not in units:
            units["deflection"] = unit_of_integral(units["rate"])


def _of_sums(model: GreyBoxModel, port: Port, x: Signals, u: Signals, p: Signals) -> dict[str, str]:
    """Units of signals that are sums or differences with a state or an input: a twist of two angles, the play of a nut (a travel less a
    lead times an angle).

    Each state and input is moved by one at two samples: what moves the signal by one, up or down, has the signal's unit.
    """
    found = {}
    few = [0, -1]
    x, u = (Signals(kind, {name: each[name][..., few] for name in each}) for kind, each in (("state", x), ("input", u)))
    declared = [(x, s.name, s.unit) for s in model.states] + [(u, i.name, i.unit) for i in model.inputs]
    for name, signal in port.signals.items():
        if isinstance(signal, str):
            continue
        here, units = torch.as_tensor(signal(x, u, p)), set()
        for among, moved, unit in declared:
            other = among.replaced(**{moved: among[moved] + 1.0})
            there = signal(other, u, p) if among is x else signal(x, other, p)
            if bool(((torch.as_tensor(there) - here).abs() - 1.0).abs().max() < 1e-9):
                units.add(unit)
        if len(units) == 1 and "" not in units:
            found[name] = units.pop()
    return found
