"""Arguments by names that there are not: seen, a bare TypeError without the near name, in the place of a message."""

from __future__ import annotations

import inspect
import pickle
from collections.abc import Callable
from typing import Any

import pytest

import greybox_torch as gt
from greybox_torch.keywords import keyword_advice, names_checked
from greybox_torch.systems.robot_arm import RobotArm

GT: Any = gt  # as types are not checked everywhere
ARM: Any = RobotArm


@pytest.mark.parametrize(
    ("call", "argument", "told"),
    [
        (
            lambda: GT.diagnose(timelimit=10),
            "timelimit",
            'diagnose() takes no argument of this name (did you mean "time_limit"?)',
        ),
        (lambda: GT.fit(role=1), "role", "; it takes model, data"),
        (lambda: GT.fit(1), "data", "data: found nothing, fit() needs it, as in fit(model, data)"),
        (lambda: GT.compare(), "data", "compare() needs it, as in compare(data, models)"),
        (lambda: GT.SearchBudget(most_efects=2), "most_efects", '(did you mean "most_effects"?)'),
        (lambda: GT.DiagnosisSettings(most_efects=2), "most_efects", "(did you mean SearchBudget(most_effects=…)?)"),
        (lambda: GT.DiagnosisSettings(most_effect=1), "most_effect", "(did you mean SearchBudget(most_effects=…)?)"),
        (lambda: GT.SearchBudget(what=2), "what", "SearchBudget() takes no argument of this name"),
        (lambda: GT.TrainingSettings(epoch=2), "epoch", '(did you mean "epochs"?)'),
        (lambda: ARM().set_values(m=-1.0), "m", "set_values() takes no argument of this name; it takes values"),
    ],
)
def test_the_near_name_is_told(call: Callable[[], Any], argument: str, told: str) -> None:
    with pytest.raises(gt.ArgumentError) as found:
        call()
    assert str(found.value).startswith(f"{argument}: found ") and told in str(found.value)


def test_nothing_else_changes() -> None:
    assert "time_limit" in inspect.signature(gt.diagnose).parameters
    assert pickle.loads(pickle.dumps(gt.DiagnosisSettings())) == gt.DiagnosisSettings()

    @names_checked
    def any_name(**values: int) -> int:
        return len(values)

    assert any_name(one=1) == 1
    with pytest.raises(TypeError, match="positional"):
        GT.fit(1, 2, 3)
    assert keyword_advice(TypeError("own() got an unexpected keyword argument 'a'")) == ""
