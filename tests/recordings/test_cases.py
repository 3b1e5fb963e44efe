"""The concealed physics, the models that lack it, and the published ones that have it."""

from __future__ import annotations

import tomllib

import pytest
import torch

from experiments.recordings.cases import CASES, HERE, SHARED, Case, key
from greybox_torch.data import load_dataset
from greybox_torch.estimate.problem import make_problem
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.systems import load_model

PUBLISHED = [case for case in CASES if case.published_model]
here = pytest.mark.skipif(not SHARED.is_dir(), reason="the real recordings, ../shared/recordings, are not here")


def by_name(case: Case) -> str:
    return case.name


def model_of(case: Case):
    card = HERE / case.card
    name = tomllib.loads(card.read_text())["model"]["name"]
    return load_model(str(card.parent / name) if ".py" in name else name)


ELSEWHERE = [case for case in CASES if "elsewhere" in case.folder]
HERE_KNOWN = [case for case in CASES if case not in ELSEWHERE]


@pytest.mark.parametrize("case", HERE_KNOWN, ids=by_name)
def test_answers_are_mechanisms_at_ports_that_take_them(case: Case) -> None:
    ports = {port.name: port.kind for port in model_of(case).all_ports}
    for concealed in case.concealed:
        for port, mechanism in (*concealed.accept, *concealed.near):
            assert ports[port] in LIBRARY[mechanism].kinds
        assert set(concealed.ports) <= set(ports)
        for reading in concealed.readings:
            assert reading.mechanism in {m for _, m in (*concealed.accept, *concealed.near)} | {"stribeck_friction"}


@pytest.mark.parametrize("case", PUBLISHED, ids=by_name)
def test_the_published_model_without_its_extra_terms_is_the_one_that_lacks_them(case: Case) -> None:
    lacking, full = model_of(case), load_model(str(HERE / case.published_model))
    extra = {p.name for p in full.declared_parameters} - {p.name for p in lacking.declared_parameters}
    assert {c.parameter for c in case.concealed} <= extra
    full.set_values(dict.fromkeys(extra, 0.0))
    generator = torch.Generator().manual_seed(0)
    x = torch.randn(len(lacking.states), 20, dtype=torch.float64, generator=generator)
    u = torch.randn(len(lacking.inputs), 20, dtype=torch.float64, generator=generator)
    torch.testing.assert_close(full.rates(x, u, full.physical()), lacking.rates(x, u, lacking.physical()))


@pytest.mark.parametrize("case", PUBLISHED, ids=by_name)
def test_the_published_terms_oppose_the_motion(case: Case) -> None:
    """Friction takes energy from a body that moves; a spring that stiffens pushes back harder."""
    full = load_model(str(HERE / case.published_model))
    full.set_values({c.parameter: 0.0 for c in case.concealed})
    x = torch.full((2, 1), 0.5, dtype=torch.float64)
    u = torch.zeros(1, 1, dtype=torch.float64)
    without = full.rates(x, u, full.physical())[1]
    for concealed in case.concealed:
        if concealed.name != "constant force":
            full.set_values({concealed.parameter: 1.0})
            assert full.rates(x, u, full.physical())[1] < without
            full.set_values({concealed.parameter: 0.0})


@here
@pytest.mark.parametrize("case", CASES, ids=by_name)
def test_cards_fit_their_models_and_recordings(case: Case) -> None:
    cards = [(case.card, "")] + [(case.published_card, case.published_model)] * bool(case.published_card)
    for card, model in cards:
        data = load_dataset(HERE / card)
        loaded = load_model(str(HERE / model) if model else str(data.model))
        problem = make_problem(data, loaded, data.recordings)
        names = dict(zip(problem.names, problem.free, strict=True))
        concealed = {c.parameter for c in case.concealed}
        if card == case.card and not model and concealed <= set(names):  # left out by fixing it at zero
            values = dict(zip(problem.names, problem.values, strict=True))
            assert all(values[name] == 0.0 and not names[name] for name in concealed)
        else:
            assert concealed.isdisjoint(names) or card == case.published_card


def test_each_known_effect_is_left_out_in_turn() -> None:
    singles = {(case.folder, case.concealed[0].name) for case in CASES if len(case.concealed) == 1}
    together = [case for case in CASES if len(case.concealed) > 1]
    assert together
    for case in together:
        assert {(case.folder, concealed.name) for concealed in case.concealed} <= singles
    assert len({case.slug for case in CASES}) == len(CASES)
    assert sum(not case.concealed and not case.answered for case in CASES) >= 5  # nothing known is left out


@here
@pytest.mark.parametrize("case", ELSEWHERE, ids=by_name)
def test_keys_from_elsewhere_name_ports_of_their_models(case: Case) -> None:
    if not case.recordings.is_dir():
        pytest.skip(f"../shared/recordings/{case.folder} is not here")
    ports = {port.name for port in model_of(case).all_ports}
    answers = key(case)
    assert len(answers["effects"]) == len(answers["accept"]) == len(answers["ports"])
    assert {port for places in answers["ports"] for port in places} <= ports
