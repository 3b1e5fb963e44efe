"""What the validation experiments say of a trained network, told where people read it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.api.scores import Scores
from greybox_torch.api.train_advice import NOT_JUDGED, explained_sentence, train_advice
from greybox_torch.api.train_range import Beyond, _beyond
from greybox_torch.estimate.comparison import Score
from greybox_torch.training import Explanation
from tests.training.conftest import Turntable, recorded

QUICK = gt.TrainingSettings(epochs=3)


def said(**fits: Any) -> list[str]:
    return train_advice(scores(**fits))


def scores(*, physics: float, hybrid: float, named: float | None = None, role: str = "validation") -> Scores:
    """With an estimation experiment beside that is simulated well by all."""
    fits = {"start": 10.0, "refit": physics, "augmented": hybrid} | ({} if named is None else {"named": named})
    well = Score("one", "estimation", "y", 99.0, 0.1)
    return {m: [well, Score("two", role, "y", fit, np.inf if np.isinf(fit) else 1.0)] for m, fit in fits.items()}


def test_a_hybrid_that_predicts_worse_than_physics_is_said_to() -> None:
    """Seen: nothing but the table showed that the network had made the validation experiments worse."""
    (told,) = said(physics=91.3, hybrid=85.2)
    assert told.startswith(
        "On the validation experiments the hybrid simulates worse than the physics alone (mean fit 85.2 % for 91.3 %)"
    )
    assert "greybox fit" in told
    (told,) = said(physics=91.3, hybrid=-np.inf)
    assert "(it overflows; mean fit 91.3 % without)" in told
    (told,) = said(physics=91.3, hybrid=95.0, named=70.0)
    assert "the model with the law in the network's place simulates worse" in told


def test_an_output_that_became_worse_is_told_though_the_mean_is_better() -> None:
    """Seen: "Keep the network." with the knee at 99.02 % for 99.05 %, and not a word of that."""
    fits = {"start": (31.4, 34.4), "refit": (97.947, 99.05), "augmented": (98.156, 99.023)}
    both = {
        m: [Score("steps", "validation", o, f, 0.1) for o, f in zip(("motor", "knee"), own, strict=True)]
        for m, own in fits.items()
    }
    (told,) = train_advice(both)
    assert "the hybrid simulates knee worse than the physics alone (mean fit 99.02 % for 99.05 %)" in told


def test_there_is_one_recommendation() -> None:
    """Seen: "Keep the network." above "Use the physics alone" in one output."""
    kept = Explanation(memories=(0.2,))
    assert kept.sentence.endswith("stands for it. Keep the network.")
    assert explained_sentence(kept, scores(physics=59.7, hybrid=42.3)).endswith("stands for it.")
    assert explained_sentence(kept, scores(physics=59.7, hybrid=80.0)) == kept.sentence
    not_judged = explained_sentence(kept, scores(physics=59.7, hybrid=80.0), judged=False)
    assert not_judged.endswith("stands for it."), "seen: Keep the network, of which nearly all held-out runs ran away"
    law: Any = SimpleNamespace(absent="", lost=9.68e3, attachment=SimpleNamespace(prefix="air.constant_bias"))
    ranked = replace(kept, memories=(), curves=(SimpleNamespace(),), terms=(law,))  # pyright: ignore[reportArgumentType]
    assert "with the closest, air.constant_bias" in explained_sentence(ranked, scores(physics=59.7, hybrid=80.0))
    said_of_none = explained_sentence(ranked, scores(physics=59.7, hybrid=80.0), judged=False)
    assert said_of_none == NOT_JUDGED, "seen: the closest of laws whose runs ran away, 9.68e+03 times the network's"
    (told,) = said(physics=59.7, hybrid=42.3, named=90.0)
    assert told.endswith("Use the model with the law in the network's place (`named`).")


@pytest.mark.parametrize(
    "fits",
    [{"physics": 91.3, "hybrid": 95.0}, {"physics": 91.3, "hybrid": 91.295}, {"physics": -np.inf, "hybrid": -np.inf}],
)
def test_nothing_is_said_of_a_hybrid_that_predicts_no_worse(fits: dict[str, float]) -> None:
    assert said(**fits) == []
    assert said(physics=91.3, hybrid=50.0, role="estimation") == [], "nothing to judge by"


def test_a_signal_that_keeps_to_its_range_is_not_told() -> None:
    learned = np.linspace(-1.0, 1.0, 200)
    assert _beyond("speed", "rad/s", learned, 1.005 * learned) is None
    assert _beyond("speed", "rad/s", learned, np.full(200, np.nan)) is None
    assert _beyond("speed", "rad/s", np.array([]), learned) is None
    found = _beyond("speed", "rad/s", learned, 2.0 * learned)
    assert found == Beyond("speed", "rad/s", (-1.0, 1.0), (-2.0, 2.0), pytest.approx(0.49, abs=0.02))


def test_validation_out_of_the_range_learned_over_is_told() -> None:
    """A turntable that is driven seven times as hard in validation."""
    draw = np.random.default_rng(0)
    recordings = []
    for name, most, role in (("slow", 0.12, "estimation"), ("fast", 0.9, "validation")):
        torque = np.repeat(draw.uniform(-most, most, 40), 20)
        signals = {"torque": torque, "speed": recorded(torque, draw)}
        units = {"torque": "N m", "speed": "rad/s"}
        recordings.append(gt.Recording.from_arrays(name, signals, sample_time=0.01, role=role, units=units))
    found = gt.train(Turntable(), gt.DataSet(recordings), net="residual", settings=QUICK, explain=False)
    assert not found.trained.physics_chosen
    (beyond,) = found.beyond
    assert beyond.signal == "speed" and beyond.unit == "rad/s" and beyond.share > 0.5
    assert beyond.visited[1] > 4.0 > 1.5 > beyond.learned[1]
    (told,) = [line for line in found.advice if "outside the range" in line]
    assert told in str(found) and told in found._repr_html_().replace("&#x27;", "'").replace("&#39;", "'")
    kept = found.to_dict()["validation"]
    assert kept["beyond_learned"][0]["learned"] == list(beyond.learned) and told in kept["sentences"]
