"""An output that the recommended model simulates worse is told, though all of them together are simulated no worse."""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.api.verdict_summary import notes
from greybox_torch.diagnosis.verdict import Left
from greybox_torch.diagnosis.worse_outputs import worse_outputs
from greybox_torch.estimate.comparison import Score
from greybox_torch.report.sections.remains import Remains
from tests.diagnosis.test_verdict import BACKLASH, verdict


def _scores(speed: float, pressure: float) -> tuple[Score, ...]:
    estimation = (Score("Run 1", "estimation", "speed", 90.0, 1.0), Score("Run 1", "estimation", "pressure", 90.0, 9.0))
    judged = (
        Score("Run 3", "validation", "speed", 90.0, speed),
        Score("Run 3", "validation", "pressure", 93.0, pressure),
    )
    return estimation + judged


BEFORE, AFTER = _scores(6.2004, 0.37856), _scores(0.6628, 0.38762)


def test_an_output_that_comes_out_worse(stub) -> None:
    """Seen: friction beside a pressure sensor that clipped; the pressure's error grew, and not a word of it."""
    assert worse_outputs(BEFORE, AFTER, [stub(output="pressure", unit="bar")]) == (
        "With what was found pressure is simulated worse on the validation experiments, root mean square error 0.379 bar before and "
        "0.388 bar with it, though all outputs together no worse.",
    )


def test_no_word_where_none_does() -> None:
    assert worse_outputs(AFTER, BEFORE[:3] + AFTER[3:], [])[0].startswith("With what was found speed")
    assert worse_outputs(BEFORE, _scores(0.66, 0.3786), []) == (), "by less than a hundredth"
    one = [s for s in BEFORE if s.output == "speed"]
    assert worse_outputs(one, [replace(s, rmse=2 * s.rmse) for s in one], []) == ()
    estimated = [replace(s, role="estimation") for s in BEFORE], [replace(s, role="estimation") for s in AFTER]
    assert worse_outputs(*estimated, []) == ()


def test_it_is_told_with_what_remains() -> None:
    scores = {"start": BEFORE, "refit": BEFORE, "augmented": AFTER}
    found = replace(verdict(BACKLASH), scores=scores, left=Left(0.36, 5.4, "36 % of the mismatch remains."))
    (told,) = found.worse_outputs
    assert told in notes(found) and found.as_json()["worse_outputs"] == [told]
    shown = Remains.of(found)
    assert shown is not None and shown.sentence == f"36 % of the mismatch remains. {told}"
    assert "worse_outputs" not in replace(verdict(BACKLASH), scores=dict.fromkeys(scores, BEFORE)).as_json()
