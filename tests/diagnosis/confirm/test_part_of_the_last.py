"""The only validation experiment, divided where it alone shows what is missing."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.confirm.held_out import HeldOut
from greybox_torch.diagnosis.confirm.part_of_the_last import promote_part
from greybox_torch.diagnosis.pipeline import diagnose

from .conftest import FAST, SLOW


def promoted(data, search):
    return promote_part(search.study, data, search.state, HeldOut(data, search.study))


def test_what_only_the_last_experiment_shows_is_found_in_a_part_of_it(drag_at_speed, motor) -> None:
    data = drag_at_speed((SLOW, FAST))
    verdict = diagnose(data, motor).verdict
    (effect,) = verdict.effects
    assert (effect.port, effect.mechanism) == ("rotor", "quadratic_drag")
    assert effect.parameters["c"]["value"] == pytest.approx(0.01, rel=0.05)
    roles = {s.experiment: s.role for s in verdict.scores["augmented"]}
    (rest,) = (name for name, role in roles.items() if role == "validation")
    taken = data.recordings[1].name
    assert rest.startswith(f"{taken} from ") and roles[taken] == "estimation"
    assert any(line.startswith(f"The beginning of {taken} was taken") and rest in line for line in verdict.evidence)
    (told,) = verdict.no_longer_validation
    assert told.startswith(f"Of {taken} only {rest} counts as validation: its beginning was taken to choose with")


def test_both_parts_have_a_fifth_of_it_and_each_sample_once(drag_at_speed, motor, begun) -> None:
    data = drag_at_speed((SLOW, FAST))
    more = promoted(data, begun(data, motor))
    assert more is not None
    whole, (first, rest) = data.recordings[1], more.dataset.recordings[1:]
    assert (first.role, rest.role) == ("estimation", "validation") and rest.name == more.rest
    assert min(len(first), len(rest)) >= 0.2 * len(whole)
    for channel, values in whole.signals.items():
        np.testing.assert_array_equal(np.concatenate([first.signals[channel], rest.signals[channel]]), values)


@pytest.mark.parametrize(("levels", "drag"), [((SLOW, FAST, FAST), 0.01), ((SLOW, FAST), 0.0), ((FAST, SLOW), 0.01)])
def test_nothing_is_divided_where_others_are_left_or_it_shows_no_more(
    drag_at_speed, motor, begun, levels, drag
) -> None:
    data = drag_at_speed(levels, drag)
    assert promoted(data, begun(data, motor)) is None


def test_what_was_divided_is_not_divided_again(drag_at_speed, motor, begun) -> None:
    data = drag_at_speed((SLOW, FAST))
    search = begun(data, motor)
    more = promoted(data, search)
    assert more is not None and promoted(more.dataset, search) is None
