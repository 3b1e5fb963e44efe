"""The size of a wave and how well it is known."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.amplitudes import wave_amplitudes
from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.estimate.uncertainty import Uncertainty
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.transmission_error import TransmissionError


def test_what_turns_one_amplitude_into_the_other_leaves_the_size(stub) -> None:
    """Seen: 0.287 ± 0.077 and 0.310 ± 0.094 mrad, as the order was not known exactly."""
    effect = Attachment("gear", TransmissionError())
    names = [f"{effect.prefix}.{n}" for n in ("a", "b", "order")]
    along, across = np.array([0.6, 0.8, 0.0]), np.array([0.8, -0.6, 0.0])
    covariance = 0.01**2 * np.outer(along, along) + 0.5**2 * np.outer(across, across)
    problem = stub(free_names=tuple(names))
    told = Final(problem, Uncertainty(covariance, covariance, ()))
    final = stub(values=lambda: dict(zip(names, (3.0, 4.0, 2.0), strict=True)), told=told)
    assert wave_amplitudes(effect, final) == {"b": (5.0, pytest.approx(0.01))}
    unknown = stub(values=final.values, told=Final(problem, None))
    assert wave_amplitudes(effect, unknown) == {"b": (5.0, None)}
    assert wave_amplitudes(Attachment("gear", ConstantBias()), final) == {}
