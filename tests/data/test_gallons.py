"""Flows in gallons, as instruments write them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt
from greybox_torch.data.column_units import unit_in
from greybox_torch.data.units import conversion

US, IMPERIAL = 3.785411784, 4.54609


@pytest.mark.parametrize(
    ("written", "liters"),
    [
        *(
            (u, US)
            for u in (
                "gpm",
                "GPM",
                "gal/min",
                "US gal/min",
                "US GPM",
                "usgpm",
                "gpm (US)",
                "gal(US)/min",
                "gal/min (US)",
            )
        ),
        *((u, IMPERIAL) for u in ("imp gal/min", "UK gal/min", "Imp. gal/min", "UK gpm")),
    ],
)
def test_flows_in_gallons_a_minute(written: str, liters: float) -> None:
    """Seen: "gpm" was no unit, and "US gal/min" was passed over, so that its values counted as l/min."""
    assert conversion(written, "l/min", "")[0] == pytest.approx(liters, rel=1e-12)
    assert conversion("l/min", written, "")[0] == pytest.approx(1.0 / liters, rel=1e-12)
    assert conversion(f"{written}", "gph (UK)", "")[0] == pytest.approx(60.0 * liters / IMPERIAL)


@pytest.mark.parametrize(
    ("written", "in_liters", "factor"),
    [
        ("psi/gpm", "psi min/l", 1.0 / US),
        ("psi/gpm^2", "psi min^2/l^2", 1.0 / US**2),
        ("gpm2", "l^2/min^2", US**2),
        ("V/(UK gpm)", "V min/l", 1.0 / IMPERIAL),
    ],
)
def test_a_flow_is_divided_by_and_squared_as_a_whole(written: str, in_liters: str, factor: float) -> None:
    """Seen: "psi/gpm", the resistance of a pipe, as psi/gallon/min."""
    assert conversion(written, in_liters, "")[0] == pytest.approx(factor)


def test_the_unit_of_acceleration_is_no_gallon() -> None:
    assert conversion("Gal", "m/s^2", "")[0] == pytest.approx(0.01)
    with pytest.raises(gt.UserError, match='"GAL/s" is no unit that is known'):  # the registry has no such spelling
        conversion("GAL/s", "l/s", "")


@pytest.mark.parametrize("column", ["flow_gpm", "flow [US gal/min]", "Q (GPM)", "Q/gpm", "flow in gpm"])
def test_in_the_name_of_a_column(column: str) -> None:
    assert conversion(unit_in(column), "l/min", "")[0] == pytest.approx(US)


class Tank(gt.GreyBoxModel):
    states = [gt.State("level", "m")]
    inputs = [gt.Input("inflow", "l/min")]
    outputs = [gt.Output("level", "m")]


@pytest.mark.parametrize(
    ("heading", "units"), [("inflow [US gal/min]", ""), ("inflow", "US gal/min"), ("inflow", "GPM")]
)
def test_a_card_converts_them(tmp_path: Path, heading: str, units: str) -> None:
    line = [f"s,{units},m"] if units else []
    rows = [f"{0.5 * k},{10 + k % 3},{k / 7}" for k in range(100)]
    (tmp_path / "log.csv").write_text("\n".join([f"time,{heading},level", *line, *rows]))
    card = gt.card(tmp_path / "log.csv", Tank())
    assert not card.open, card.open
    card.save()
    (first, _) = gt.load_dataset(tmp_path / "dataset.toml").recordings
    np.testing.assert_allclose(first.signals["inflow"][:3], np.array([10.0, 11.0, 12.0]) * US)
