"""Which cases a set of the proof has."""

from __future__ import annotations

import pytest

from experiments.concealed.proof.errors import ProofError
from experiments.concealed.proof.plan import NOISES, by_mechanism, mechanism, plans


def test_standard_set_has_every_mechanism_at_three_strengths_and_what_the_wider_proof_asks_for():
    from experiments.concealed.machines import ENGINE, MACHINES

    planned = plans("standard", 5)
    assert len(planned) >= 220
    assert sum(not p.plan for p in planned) >= 45
    assert sum(p.machine in ENGINE for p in planned) >= 60
    assert sum("overwhelming" in p.words for p in planned) >= 40
    assert sum(p.quiet < 1.0 for p in planned if not p.plan) >= 20  # nothing is missing, and the sensors are good
    assert sum(p.section == "richer laws" for p in planned) >= 8
    assert {p.machine for p in planned} == set(MACHINES)
    singles = [p for p in planned if p.section == "library" and p.machine not in ENGINE]

    strengths: dict[str, set[str]] = {}
    for p in singles:
        strengths.setdefault(mechanism(MACHINES[p.machine].catalogue[p.plan[0]]), set()).add(p.words[0])
    assert strengths == {name: {"weak", "moderate", "dominant"} for name in by_mechanism()}
    excitations = [p for p in planned if p.section == "excitation"]
    assert len(excitations) == 8 and len({(p.number, p.estimation) for p in excitations}) == 8
    assert sorted(p.noise for p in planned if p.section == "noise") == sorted(NOISES * 2)
    assert sum(p.section == "two effects" for p in planned) >= 8
    assert sum(p.section == "outside" for p in planned) >= 10
    assert plans("standard", 5) == planned != plans("standard", 6)


def test_quick_set_has_eight_cases_on_all_machines():
    planned = plans("quick", 1)
    assert len(planned) >= 8
    assert {"arm", "stage", "pendulum"} < {p.machine for p in planned}
    with pytest.raises(ProofError, match="no such set"):
        plans("slow", 1)


def test_every_mechanism_of_the_library_is_concealed_but_those_of_balances():
    from greybox_torch.mechanisms.library import LIBRARY

    balances = {"linear_leak", "threshold_flow"}  # no machine of the proof has a level that leaks
    assert set(by_mechanism()) == set(LIBRARY) - balances
