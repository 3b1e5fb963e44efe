from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.one_of import Alternative, OneOf
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.traces import InputTrace, Trace
from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.estimate.excitation import excited_band
from greybox_torch.mechanisms.library import LIBRARY
from greybox_torch.report.about import About
from greybox_torch.report.page import render_page
from greybox_torch.report.sections.bode import _unit
from greybox_torch.report.sections.frequency import Responses, _clear, responses
from tests.report.conftest import BACKLASH, verdict_of

STEP = 0.001
LAG = replace(BACKLASH, port="actuator", mechanism="input_lag", curve=None)


def lagged(verdict_effect: Effect = LAG, *, feedback: bool = False, samples: int = 8000) -> Verdict:
    """A first-order plant behind a lag of 5 samples, which the model before lacks, and noise a hundredth of the output."""
    rng, time = np.random.default_rng(3), STEP * np.arange(samples)
    noise = 0.01 * rng.normal(size=samples)

    def plant(u: np.ndarray) -> np.ndarray:
        return np.asarray(lfilter([0.0, 0.05], [1.0, -0.95], u))

    u = rng.normal(size=samples)
    lag = [0.2], [1.0, -0.8]
    if feedback:  # the noise comes back into the input, one sample later
        u = u - 20.0 * np.concatenate([[0.0], noise[:-1]])
    true = plant(np.asarray(lfilter(*lag, u)))
    trace = Trace("Noise", "validation", "speed", "rad/s", time, true + noise, plant(u), plant(u), true)
    drive = InputTrace("Noise", "voltage", "V", time, u)
    return replace(verdict_of(verdict_effect, traces=(trace,)), inputs=(drive,))


def shown(verdict: Verdict) -> Responses:
    found = responses(verdict, verdict.effects[0])
    assert found is not None
    return found


def _percent(caption: str, after: str) -> float:
    """The percentage that follows some words."""
    return float(caption.split(after)[1].split(" %")[0])


def test_a_lag_is_shown_measured_before_and_after() -> None:
    found = shown(lagged())
    (chart,) = found.charts
    assert [len(column) for column in chart.columns] == [2, 2]
    assert chart.columns[0][0].y_label == "amplitude [(rad/s)/V]"
    for column in chart.columns:
        for panel in column:
            assert [(m.kind, m.series) for m in panel.marks] == [
                ("area", "measured"),
                ("line", "before"),
                ("line", "after"),
                ("points", "measured"),
            ]
    # the lag turns the phase by up to 50° beyond the model before
    assert chart.columns[1][1].y.low < -45.0
    before, after = (_percent(chart.caption, words) for words in ("from it is ", " before and "))
    assert before > 20.0 > 5.0 > after
    assert "feedback" not in chart.caption


def test_a_class_with_a_linear_member_is_shown() -> None:
    one_of = OneOf("…", 0.9, (Alternative("pivot", "gravity", 0.5), Alternative("actuator", "input_gain", 0.4)))
    assert shown(lagged(replace(LAG, mechanism="gravity", one_of=one_of))).charts


def test_no_response_shows_what_is_not_linear() -> None:
    assert responses(lagged(BACKLASH), BACKLASH) is None
    unknown = replace(LAG, mechanism="unknown")
    assert responses(lagged(unknown), unknown) is None


def test_under_feedback_the_region_is_wider() -> None:
    free, closed = (shown(lagged(feedback=f)).charts[0] for f in (False, True))
    told = "recorded under feedback, or their inputs later than they act"
    assert told in closed.caption and "recorded under feedback" not in free.caption
    assert _percent(closed.caption, "region is ") > 1.3 * _percent(free.caption, "region is ")


def test_under_feedback_it_ends_with_the_excited_band() -> None:
    """Beyond it the input is the controller's answer to what the output does there, distortion of the machine included."""
    verdict = lagged(feedback=True)
    (drive,), (trace,) = verdict.inputs, verdict.traces
    slow = lfilter([0.05], [1.0, -0.95], drive.values)
    drive = replace(
        drive, values=np.asarray(slow) - 20.0 * np.concatenate([[0.0], (trace.measured - trace.augmented)[:-1]])
    )
    verdict = replace(verdict, inputs=(drive,))
    band = excited_band(drive.values, STEP, verdict.settings.excited_share)
    wide = replace(verdict, settings=DiagnosisSettings(excited_share=0.9999))
    ends = [shown(v).charts[0].columns[0][0].x.high for v in (verdict, wide)]
    assert ends[0] <= band and ends[0] <= ends[1]


@pytest.mark.parametrize("samples", [30, 8000])
def test_an_input_that_excites_nothing(samples: int) -> None:
    verdict = lagged(samples=samples)
    if samples > 30:
        verdict = replace(verdict, inputs=(replace(verdict.inputs[0], values=np.ones(samples)),))
    found = shown(verdict)
    assert not found.charts and "excite too few frequencies" in found.note


def test_without_inputs_nothing_is_said() -> None:
    assert responses(replace(lagged(), inputs=()), LAG) is None


def test_a_run_that_overflows_is_left_out() -> None:
    verdict = lagged()
    lost = replace(verdict.traces[0], refit=np.full(8000, np.inf))
    assert responses(replace(verdict, traces=(lost,)), LAG) is None


def test_the_page_has_it(about: About) -> None:
    html = render_page(lagged(), about)
    assert "Frequency response from voltage to speed" in html and "local polynomial method" in html


def test_laws_that_are_linear() -> None:
    linear = {name for name, law in LIBRARY.items() if law.linear}
    shifts = {name for name, law in LIBRARY.items() if law.nature == "a time shift"}
    assert linear == shifts | {"input_gain", "sensor_gain", "additional_mode"}


def test_a_lone_frequency_beyond_the_band_is_left_out() -> None:
    """Seen: dots at the border of the chart, beyond the end of lines and region."""
    gains = np.ones((3, 40), dtype=complex)
    radius = np.where((np.arange(40) < 12) | (np.arange(40) == 30), 0.1, np.inf)
    found = _clear(1.0 + np.arange(40), gains, radius)
    assert found is not None and found.frequency[-1] == 12.0
    sparse = _clear(1.0 + np.arange(40), gains, np.where(np.arange(40) % 4 == 0, 0.1, np.inf))
    assert sparse is not None and sparse.frequency[-1] == 37.0


def test_the_unit_of_a_gain_by_a_number_is_that_of_the_output() -> None:
    assert [_unit("1", "m/s^2"), _unit("V", "m"), _unit("", "m")] == ["m/s^2", "m/V", ""]
