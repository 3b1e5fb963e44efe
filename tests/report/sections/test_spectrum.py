from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import welch

from greybox_torch.diagnosis.verdict import Verdict
from greybox_torch.report.sections.spectrum import Spectra, _density, _panel, spectra


def test_power_and_place(with_traces: Callable[..., Verdict]) -> None:
    """The error before is a sine of 15 Hz and amplitude 1: half a unit of power, all of it there."""
    (found,) = spectra(with_traces(("A", "validation", 1.0), ("B", "validation", 1.0, 5000), ("C", "estimation", 9.0)))
    assert set(found.density) == {"output", "before", "after"}
    assert found.frequency[int(np.argmax(found.density["before"]))] == pytest.approx(15.0, abs=1.5)
    near = (found.frequency > 10) & (found.frequency < 20)
    power = np.trapezoid(found.density["before"][near], found.frequency[near])
    assert power == pytest.approx(0.5, rel=0.1)
    high = found.frequency > 100
    assert np.median(found.density["after"][high]) == pytest.approx(0.05**2 / 500.0, rel=0.2)
    assert len(found.frequency) < 150


def test_experiments_of_another_sample_time_have_their_own(with_traces: Callable[..., Verdict]) -> None:
    verdict = with_traces(("A", "validation", 1.0), ("B", "validation", 1.0))
    first, second = verdict.traces
    verdict = replace(verdict, traces=(first, replace(second, time=2.0 * second.time)))
    assert [s.frequency[-1] for s in spectra(verdict)] == pytest.approx([490, 245], rel=0.05)


def test_nothing_missing(of_kind: Callable[[str], Verdict]) -> None:
    (found,) = spectra(of_kind("nothing"))
    assert set(found.density) == {"output", "model"}


@pytest.mark.parametrize(("samples", "segment"), [(4000, 512), (1000, 257), (300, 300)])
def test_the_density_is_welchs(samples: int, segment: int) -> None:
    """As scipy has it, with segments of an even and of an odd number of samples."""
    signal = np.random.default_rng(0).normal(size=samples) + np.sin(np.arange(samples))
    own, theirs = _density(signal, 0.01, segment), welch(signal, 100.0, nperseg=segment)
    for one, other in zip(own, theirs, strict=True):
        assert np.allclose(one, other, rtol=1e-9, atol=1e-18)


def test_the_axis_reaches_to_the_steps_of_a_fine_encoder_and_not_to_rounding() -> None:
    """Seen: eleven decades from an angle's motion to its encoder's steps, both errors cut off above 7 and above 22 Hz."""
    frequency = np.geomspace(0.5, 250.0, 50)
    encoder = Spectra("angle", "rad", frequency, {"output": np.geomspace(0.3, 3e-12, 50), "after": np.full(50, 3e-12)})
    assert _panel(encoder).y.low < 3e-12
    exact = replace(encoder, density={"output": encoder.density["output"], "after": np.full(50, 1e-32)})
    assert 1e-17 < _panel(exact).y.low < 1e-15
