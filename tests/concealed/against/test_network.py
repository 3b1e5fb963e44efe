"""The network begins as the plain model, and its sensitivities are those of finite differences."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from experiments.concealed.against.network import force_scale, network_model
from experiments.concealed.against.plain import Plain
from greybox_torch.estimate.problem import problem_for
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import whole_records


def with_network(plain: Plain, width: int = 3):
    model = network_model(plain.problem, plain.simulator, width, seed=1)
    return model, problem_for(plain.problem, model, {})


def test_untrained_it_is_the_plain_model(tuned: Callable[[str], Plain]) -> None:
    plain = tuned("drag")
    model, problem = with_network(plain)
    runs = [
        Simulator.of(p.model, ()).run(p.driving_records, Pass(whole_records(p.records), p.values, p.initial)).y
        for p in (plain.problem, problem)
    ]
    np.testing.assert_array_equal(*runs)
    assert not [n for n in problem.free_names if n.startswith(("scale.", "force."))]


def test_its_sensitivities_are_those_of_finite_differences(tuned: Callable[[str], Plain]) -> None:
    model, problem = with_network(tuned("drag"))
    rng = np.random.default_rng(0)
    values = problem.values + np.where(problem.free, 0.1 * rng.standard_normal(len(problem.values)), 0.0)
    names = problem.free_names
    simulator, records = Simulator.of(model, names), problem.records.part([slice(0, 60)], ["part"])
    windows = whole_records(records)
    run = simulator.run(records, Pass(windows, values, problem.initial, tangents=True))
    assert run.dy is not None
    for k, name in enumerate(names):
        moved = []
        for step in (1e-6, -1e-6):
            there = values.copy()
            there[problem.names.index(name)] += step
            moved.append(simulator.run(records, Pass(windows, there, problem.initial)).y)
        np.testing.assert_allclose(run.dy[..., k], (moved[0] - moved[1]) / 2e-6, rtol=1e-4, atol=1e-6, err_msg=name)


def test_the_scale_of_a_force_is_that_of_the_net_force(tuned: Callable[[str], Plain]) -> None:
    plain = tuned("plain")
    speed, voltage = np.linspace(-1.0, 1.0, 50)[:, None], np.ones((50, 1))
    values = {"J": 0.02, "k": 0.1, "b": 0.03}
    net = 0.1 * voltage - 0.03 * speed
    found = force_scale(plain.problem.model, "rotor", speed, voltage, values)
    np.testing.assert_allclose(found, np.sqrt(np.mean(net**2)))
