"""Names that the experiments chosen with leave undecided, asked of the others at hand."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.telling_apart import promote_to_tell_apart
from greybox_torch.diagnosis.pipeline import diagnose
from greybox_torch.diagnosis.select.forward_step import forward_step
from greybox_torch.diagnosis.select.same_effects import with_same_effects
from greybox_torch.diagnosis.select.undecided import undecided
from greybox_torch.diagnosis.stopping import result_of

from ..conftest import STEP, turned

ONE_WAY, BOTH_WAYS = (0.8, 3.0), (-3.0, 3.0)


@pytest.fixture(scope="session")
def rubbing(data_set):
    """A motor with dry friction, by the range of its voltage in every experiment: turned one way, friction is a constant force."""

    def make(*ranges: tuple[float, float]) -> DataSet:
        rng, experiments = np.random.default_rng(4), []
        for lowest, highest in ranges:
            voltage = np.repeat(rng.uniform(lowest, highest, 30), 20)
            speed = turned(voltage, lambda q, v: -0.03 * np.tanh(v / 0.02))
            experiments.append({"voltage": voltage, "speed": speed + rng.normal(0, 0.02, len(speed))})
        roles = ["estimation", *["validation"] * (len(ranges) - 1)]
        return data_set({"voltage": "V", "speed": "rad/s"}, experiments, roles=roles, sample_time=STEP)

    return make


def stepped(search):
    """The state after one step of the search."""
    return result_of(forward_step(search.study, search.state))


def test_the_experiment_that_tells_the_rivals_apart_is_taken(rubbing, motor, begun) -> None:
    data = rubbing(ONE_WAY, ONE_WAY, BOTH_WAYS, ONE_WAY)
    search = begun(data, motor)
    state = stepped(search)
    (effect,) = state.effects
    assert undecided(search.study, state, effect)
    more = promote_to_tell_apart(search.study, data, state, HeldOut(data, search.study), {})
    assert more is not None and more.same_effects and more.taken == data.recordings[2].name
    assert more.why.startswith("it tells ")
    assert [r.role for r in more.dataset.recordings] == ["estimation", "validation", "estimation", "validation"]


@pytest.mark.parametrize("ranges", [(ONE_WAY, ONE_WAY, ONE_WAY), (ONE_WAY, BOTH_WAYS)])
def test_none_is_taken_where_none_would_tell_or_none_would_be_left(rubbing, motor, begun, ranges) -> None:
    data = rubbing(*ranges)
    search = begun(data, motor)
    others = HeldOut(data, search.study)
    assert promote_to_tell_apart(search.study, data, stepped(search), others, {}) is None
    assert promote_to_tell_apart(search.study, data, search.state, others, {}) is None, "nothing was found"


def test_what_was_undecided_is_chosen_once_more_and_nothing_else(rubbing, motor, begun) -> None:
    data = rubbing(ONE_WAY, ONE_WAY, BOTH_WAYS, ONE_WAY)
    search = begun(data, motor)
    before = stepped(search)
    more = promote_to_tell_apart(search.study, data, before, HeldOut(data, search.study), {})
    assert more is not None
    both = begun(more.dataset, motor)
    after = with_same_effects(both.study, both.state, before)
    assert after.prefixes == {"rotor.coulomb_friction"} and len(after.current.problem.records.first) == 2
    (effect,) = after.effects
    assert not undecided(both.study, after, effect)
    assert after.current.values()["rotor.coulomb_friction.F_c"] == pytest.approx(0.03, rel=0.03)


def test_nothing_is_begun_in_windows_of_fewer_experiments(rubbing, motor, begun) -> None:
    """Seen: an arm's mode, tried at the card's values first, of which no verdict came: windows of fewer records."""
    data = rubbing(ONE_WAY, ONE_WAY, BOTH_WAYS, ONE_WAY)
    search = begun(data, motor)
    before = stepped(search)
    *earlier, done = before.steps
    ranked = tuple(_at_card(r, search.plain.fits[0]) for r in done.ranked)
    before = replace(
        before, steps=(*earlier, replace(done, ranked=ranked, taken=_at_card(done.taken, search.plain.fits[0])))
    )
    more = promote_to_tell_apart(search.study, data, before, HeldOut(data, search.study), {})
    both = begun(more.dataset, motor)
    assert with_same_effects(both.study, both.state, before).prefixes == {"rotor.coulomb_friction"}


def _at_card(ranked, windows):
    return replace(ranked, candidate=replace(ranked.candidate, at_card=({},), begun=windows))


def test_what_one_way_motion_leaves_undecided_is_told_by_its_name(rubbing, motor) -> None:
    data = rubbing(ONE_WAY, ONE_WAY, BOTH_WAYS, BOTH_WAYS)
    verdict = diagnose(data, motor).verdict
    (effect,) = verdict.effects
    assert (effect.port, effect.mechanism) == ("rotor", "coulomb_friction") and effect.probability > 0.9
