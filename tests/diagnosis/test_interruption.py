"""A search that is interrupted answers with the best state that it has reached, wherever that happens."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from greybox_torch.diagnosis import findings, selection
from greybox_torch.diagnosis.confirm import exercised, held_out
from greybox_torch.diagnosis.confirm.free_runs import FreeRuns
from greybox_torch.diagnosis.pipeline import Diagnosis, diagnose
from greybox_torch.diagnosis.refit import rank, refitted
from greybox_torch.diagnosis.screen.score_test import Screen
from greybox_torch.diagnosis.select import offered, plain_model
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.window_fit import WindowFit
from greybox_torch.mechanisms.attachment import Attachment


def fingerprint(value: Any) -> Any:
    """What the result of a fit depends on: attachments and numbers by what they say, fits by which they are, the rest not at all."""
    if isinstance(value, Mapping):
        return tuple(sorted((k, fingerprint(v)) for k, v in value.items() if isinstance(v, int | float | str)))
    if isinstance(value, list | tuple | frozenset):
        return tuple(map(fingerprint, value))
    if isinstance(value, Attachment):
        return value.prefix, repr(vars(value.mechanism))
    if isinstance(value, WindowFit):
        return id(value)
    return None if isinstance(value, Problem) or not isinstance(value, int | float | str) else value


@pytest.fixture(scope="module")
def remembered() -> Any:
    """Every fit is made once, however often the same search is run: what is tested is what happens between the fits."""
    patch = pytest.MonkeyPatch()
    # Two fits beside one another report in the order in which they happen to begin.
    patch.setenv("OMP_NUM_THREADS", "1")
    kept: list[Any] = []

    def once(owner: Any, name: str, key: Callable[..., Any]) -> None:
        work, known = getattr(owner, name), {}

        def remembering(*args: Any, **kwargs: Any) -> Any:
            k = key(*args, **kwargs)
            if k not in known:
                known[k] = work(*args, **kwargs)
                kept.append((args, kwargs))  # what is kept keeps its identity
            return known[k]

        patch.setattr(owner, name, remembering)

    for module in (refitted,):
        once(module, "hypothesis", lambda *args, **kwargs: (fingerprint(args), fingerprint(sorted(kwargs.items()))))
    once(
        rank,
        "_compiled",
        lambda study, current, found, *rest: (id(current), fingerprint([c.attachment for c in found])),
    )
    once(
        offered, "candidates_from_motion", lambda study, current, accepted, wanted: (id(current), fingerprint(accepted))
    )
    once(offered, "scan_orders", lambda study, effects, free, fits: tuple(map(id, fits)))
    once(Screen, "of", lambda model, effects, there, *rest, **how: (fingerprint(effects), fingerprint(there)))
    once(Screen, "scores", lambda screen, fit, *rest: (id(screen), id(fit)))
    for module in (held_out, exercised):
        once(module, "held_out_fits", lambda hypothesis, *rest: (id(hypothesis), fingerprint(rest)))
    once(plain_model, "views_of", lambda problem, motion: problem.weights.tobytes())
    once(findings, "finish", lambda hypothesis, *rest, **how: id(hypothesis))
    once(
        FreeRuns,
        "_compared",
        lambda self, like, values, final, places=None: (like.names, values.tobytes(), final is None, str(places)),
    )
    yield
    patch.undo()


@pytest.fixture(scope="module")
def run(motor_data, motor, remembered) -> Callable[..., tuple[Diagnosis, list[str], SearchState]]:
    """Diagnoses a motor with drag and a bias that it does not know; with the reports, and the state that the search answered with."""
    data = motor_data(1000, torque=lambda q, v: -0.004 * v * abs(v) + 0.05)

    def diagnosed(stop_at: int | None = None) -> tuple[Diagnosis, list[str], SearchState]:
        said, answers = [], []
        patch = pytest.MonkeyPatch()
        confirmed = selection._confirmed
        patch.setattr(
            selection,
            "_confirmed",
            lambda study, state, *rest: (answers.append(state), confirmed(study, state, *rest))[1],
        )

        def progress(text: str) -> None:
            said.append(text)
            if len(said) - 1 == stop_at:
                raise KeyboardInterrupt

        try:
            return diagnose(data, motor, progress=progress), said, answers[0]
        finally:
            patch.undo()

    return diagnosed


@pytest.fixture(scope="module")
def undisturbed(run) -> tuple[Diagnosis, list[str], SearchState]:
    return run()


def test_the_case_visits_the_stages(undisturbed) -> None:
    found, said, _ = undisturbed
    assert found.verdict.complete and len(found.verdict.effects) == 2
    stages = ("screening", "refitting", "polishing", "trying without", "choosing", "confirming", "fitting", "judging")
    assert all(any(text.startswith(stage) for text in said) for stage in stages)


def test_interrupted_at_every_report(run, undisturbed) -> None:
    found, said, _ = undisturbed
    scores, effects = [], []
    for k in range(1, len(said)):
        stopped, told, answer = run(k)
        verdict = stopped.verdict
        assert told[: k + 1] == said[: k + 1], "so far it is the same search"
        assert not verdict.complete and any("stopped before" in line for line in verdict.evidence)
        assert all(answer.step_of(e.prefix) is not None for e in answer.effects), "every effect was chosen in a step"
        _check(stopped)
        scores.append(answer.current.score)
        effects.append(len(answer.effects))
    allowed = DiagnosisSettings().least_gain  # what an effect that is chosen once more may lose
    assert all(later < before + allowed for before, later in pairwise(scores)), "never a weaker branch"
    assert {0, 1, 2} == set(effects)
    again = run()[0].verdict.as_json()
    same = found.verdict.as_json()
    assert {**again, "seconds": 0, "stages": 0} == {**same, "seconds": 0, "stages": 0}


def _check(stopped: Diagnosis) -> None:
    """A verdict that says the same everywhere."""
    verdict = stopped.verdict
    content = verdict.as_json()
    assert content["mismatch"] == bool(verdict.effects) or verdict.unexplained is not None
    assert [a["mechanism"] for a in stopped.attachments] == [e.mechanism for e in verdict.effects]
    assert set(stopped.values) == {p.name for p in stopped.model.declared_parameters}
    assert all(np.isfinite([row["augmented"]["fit"], row["refit"]["fit"]]).all() for row in content["fit"])
    assert all(0.0 < e.probability <= 0.97 and 0.0 <= e.explained <= 1.0 for e in verdict.effects)


def test_before_the_model_as_it_stands_is_fitted_there_is_nothing_to_answer_with(run) -> None:
    with pytest.raises(KeyboardInterrupt):
        run(0)
