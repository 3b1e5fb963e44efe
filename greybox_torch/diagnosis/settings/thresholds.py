"""Every statistical threshold of a diagnosis."""

from __future__ import annotations

from dataclasses import dataclass

from greybox_torch.diagnosis.settings.card import CardSettings
from greybox_torch.diagnosis.settings.choosing import NoiseSettings, ScreenSettings, SelectionSettings
from greybox_torch.diagnosis.settings.claiming import ConfirmationSettings, ResidualSettings
from greybox_torch.diagnosis.settings.comparing import ComparisonSettings
from greybox_torch.diagnosis.settings.curves import CurveSettings
from greybox_torch.diagnosis.settings.fields import check
from greybox_torch.diagnosis.settings.held_out_decides import HeldOutDecidesSettings
from greybox_torch.diagnosis.settings.probability import ProbabilitySettings
from greybox_torch.diagnosis.settings.sampling import SamplingSettings
from greybox_torch.diagnosis.settings.searching_again import SearchingAgainSettings
from greybox_torch.keywords import fields_checked


@fields_checked
@dataclass(frozen=True, kw_only=True)
class DiagnosisSettings(
    ResidualSettings,
    ProbabilitySettings,
    CardSettings,
    SearchingAgainSettings,
    ConfirmationSettings,
    SamplingSettings,
    CurveSettings,
    HeldOutDecidesSettings,
    SelectionSettings,
    ComparisonSettings,
    ScreenSettings,
    NoiseSettings,
):
    """By what a diagnosis decides: noise, screen, comparison, selection, confirmation, searching again, probability, tests of residuals.

    Every field says in its metadata what it means, its unit and what its default was chosen by; :func:`setting_rows` tabulates that.

    Example: ``DiagnosisSettings(least_significance=4.0)`` claims less.

    Raises:
        UserError: a value is out of its bounds.
    """

    def __post_init__(self) -> None:
        check(self)
