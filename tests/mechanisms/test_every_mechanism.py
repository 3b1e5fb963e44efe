"""Every mechanism of the library attached to a model: nothing at zero amplitude, something otherwise."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.codegen.lower import lower
from greybox_torch.codegen.trace import Symbol
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism
from greybox_torch.model import GreyBoxModel
from tests.mechanisms.attaching import ARM, ARM_START, Tank, at, attached, free_run, records_of, starts, values_of


def of_kind(mechanism: Mechanism) -> tuple[GreyBoxModel, np.ndarray, Attachment]:
    """A model with a port that the mechanism fits, its start state, and the attachment."""
    kind, position = mechanism.kinds[0], "motor" if "position" in mechanism.needs else ""
    if kind == "balance":
        return Tank(), np.ones((1, 1)), at("water", mechanism)
    port = {"body": "motor", "coupling": "gear_spring"}.get(kind, kind)
    shifted = "+gear_twist" if mechanism.kinematic else ""
    return ARM, ARM_START, at(port, mechanism, position=position, shifted_state=shifted)


@pytest.fixture(scope="module")
def plain() -> dict[str, np.ndarray]:
    records = records_of(8)
    arm, tank = (free_run(m, records, values_of(m), x) for m, x in ((ARM, ARM_START), (Tank(), np.ones((1, 1)))))
    return {"robot_arm": arm, "Tank": tank}


@pytest.mark.parametrize("mechanism", [pytest.param(m(), id=m.name) for m in LIBRARY.values()])
def test_changes_nothing_at_zero_amplitude(mechanism, around, plain) -> None:
    base, x0, effect = of_kind(mechanism)
    probe = mechanism.probes(around)[0]
    model = attached(base, around, effect, probed=[effect])
    assert model.parameter_name(effect, SHARE) in model.values()
    zero = {f"{effect.prefix}.{name}": 0.0 for name in probe.directions}
    own = {f"{effect.prefix}.{name}": value for name, value in probe.values.items()}
    p = values_of(model, **own, **zero)
    assert np.array_equal(free_run(model, records_of(8), p, starts(model, x0, lagged=2.0)), plain[base.title])


def test_laws_are_traced_without_torch_taking_them_apart(around, monkeypatch) -> None:
    """The first operation that torch takes apart makes it import its distributed tensors, half a second of every diagnosis."""
    found: list[tuple[str, str]] = []

    def note(cls, func, types, args=(), kwargs=None):
        found.append((effect.mechanism.name, str(func)))
        return dispatched(cls, func, types, args, kwargs)

    dispatched = Symbol.__torch_dispatch__.__func__
    monkeypatch.setattr(Symbol, "__torch_dispatch__", classmethod(note))
    for mechanism in LIBRARY.values():
        base, _, effect = of_kind(mechanism())
        assert lower(attached(base, around, effect, probed=[effect]), ())
    assert not found


@pytest.mark.parametrize("mechanism", [pytest.param(m(), id=m.name) for m in LIBRARY.values()])
def test_acts_on_the_output(mechanism, around, plain) -> None:
    base, x0, effect = of_kind(mechanism)
    model = attached(base, around, effect)
    size = {name: 0.004 for probe in mechanism.probes(around) for name in probe.directions if name != SHARE}
    size |= {name: 0.5 for name in ("limit", "threshold", "where") if name in mechanism.probes(around)[0].values}
    size |= {"side": -1.0} if mechanism.name == "end_stop" else {}
    p = values_of(model, **{f"{effect.prefix}.{n}": v for n, v in size.items()})
    changed = free_run(model, records_of(8), p, starts(model, x0, lagged=2.0, bristle=0.1, slip=0.1, stretch=0.1))
    assert np.abs(changed - plain[base.title]).max() > 1e-9
