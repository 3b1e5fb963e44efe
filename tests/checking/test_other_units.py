"""A channel that is 100 times as large in one experiment as in another is told; small amplitudes, steps and a scale on the card are not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.api.data_warnings import data_warnings
from greybox_torch.checking.other_units import other_units
from greybox_torch.data import DataSet, Recording, load_dataset

TIME: np.ndarray = 0.1 * np.arange(600)
VALVE: np.ndarray = np.round(50.0 + 45.0 * np.sin(TIME) * np.cos(3.1 * TIME), 1)
AIR: np.ndarray = np.round(20.0 + 2.0 * np.sin(0.3 * TIME), 2)


def runs(*experiments: dict[str, np.ndarray], unit: str = "%") -> DataSet:
    units = {name: {"valve": unit, "air": "degC"}[name] for name in experiments[0]}
    of = [
        Recording.from_arrays(f"run {k}", {n: v.copy() for n, v in signals.items()}, sample_time=0.1, units=units)
        for k, signals in enumerate(experiments)
    ]
    return DataSet(of, held_out_by_default=False)


@pytest.mark.parametrize(
    ("unit", "factor", "write"),
    [
        ("%", 100.0, "values of run 0 times 100 if so"),
        ("1", 100.0, "values of run 1 times 0.01 if so"),
        ("rad", 180.0 / np.pi, "values of run 1 times 0.01745 if so"),
        ("mA", 1000.0, "values of run 0 times 1000 if so"),
    ],
)
def test_two_experiments(unit: str, factor: float, write: str) -> None:
    (told,) = other_units(runs({"valve": VALVE / factor, "air": AIR}, {"valve": VALVE, "air": AIR}, unit=unit))
    assert told.found.startswith('channel "valve": ') and f"about {factor:.4g} times as much" in told.found
    assert told.write == write


@pytest.mark.parametrize(
    "experiments",
    [
        ({"valve": VALVE, "air": AIR}, {"valve": 0.8 * VALVE, "air": AIR}),
        ({"valve": 0.1 * VALVE, "air": AIR}, {"valve": VALVE, "air": AIR}),
        ({"valve": 0.01 * VALVE, "air": 0.01 * AIR}, {"valve": VALVE, "air": AIR}),  # small amplitudes
        ({"valve": np.where(VALVE > 50, 1.0, 0.0), "air": AIR}, {"valve": VALVE, "air": AIR}),  # steps
        ({"valve": 0.01 * VALVE, "air": AIR}, {"valve": 0.1 * VALVE, "air": AIR}, {"valve": VALVE, "air": AIR}),
        ({"valve": 0.01 * VALVE}, {"valve": VALVE}),  # nothing else tells small amplitudes from other units
        ({"valve": 0.01 * VALVE, "air": AIR}, {"valve": VALVE + 200.0, "air": AIR}),
        ({"valve": VALVE, "air": AIR},),
    ],
)
def test_nothing_is_told(experiments: tuple[dict[str, np.ndarray], ...]) -> None:
    assert not [*other_units(runs(*experiments))]


CARD = """sample_time = 0.1
[channels]
valve = { column = "valve", unit = "%" }
air = { column = "air", unit = "degC" }
[[experiment]]
name = "january"
file = "january.csv"
[[experiment]]
name = "march"
file = "march.csv"
role = "validation"
"""


def test_what_to_write_mends_it(tmp_path: Path) -> None:
    """Seen: a valve from 0 to 1 in one file and from 0 to 100 in the other; a share of the heat was missing, and not a word."""
    for name, factor in (("january", 0.01), ("march", 1.0)):
        rows = [f"{v:.4f},{a}" for v, a in zip((factor * VALVE).tolist(), AIR.tolist(), strict=True)]
        (tmp_path / f"{name}.csv").write_text("\n".join(["valve,air", *rows]))
    card = tmp_path / "dataset.toml"
    card.write_text(CARD)
    (told,) = data_warnings(load_dataset(card), None)
    assert '% in "january" and' in told.found and '% in "march", about 100 times as much' in told.found
    line, _, rest = told.write.partition(" in [[")
    assert line == 'columns = { valve = { column = "valve", scale = 100 } }' and rest.startswith(
        'experiment]] "january"'
    )
    card.write_text(CARD.replace('"january.csv"\n', f'"january.csv"\n{line}\n'))
    mended = load_dataset(card)
    assert not data_warnings(mended, None)
    np.testing.assert_allclose(mended.recordings[0].signals["valve"], VALVE, atol=0.01)
