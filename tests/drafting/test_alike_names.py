"""Two columns whose names fit two channels alike: the ports tell them apart, or the card says so."""

from __future__ import annotations

from itertools import permutations
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import greybox_torch as gt

TIME = np.arange(0.0, 200.0)


class Vessel(gt.GreyBoxModel):
    """A heated vessel in a jacket."""

    states: ClassVar = [gt.State("T", "degC"), gt.State("T_j", "degC")]
    inputs: ClassVar = [gt.Input("power", "W")]
    outputs: ClassVar = [gt.Output("T", "degC"), gt.Output("T_j", "degC")]
    parameters: ClassVar = [gt.Parameter("C", 100.0, unit="J/K"), gt.Parameter("UA", 1.0, unit="W/K")]
    ports: ClassVar = [gt.Balance("vessel", level="T"), gt.Balance("jacket", level="T_j")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        lost = p.UA * (x.T - x.T_j)
        return {"T": (u.power - lost + port.vessel) / p.C, "T_j": (lost + port.jacket) / p.C}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"T": x.T, "T_j": x.T_j}


class Unnamed(Vessel):
    """The same, of which no port says what is what."""

    ports: ClassVar = [gt.Balance("one", level="T"), gt.Balance("other", level="T_j")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        lost = p.UA * (x.T - x.T_j)
        return {"T": (u.power - lost + port.one) / p.C, "T_j": (lost + port.other) / p.C}


def drafted(folder: Path, model: gt.GreyBoxModel, names: tuple[str, ...]) -> dict[str, dict[str, Any]]:
    rows = np.column_stack([TIME, *(np.sin(TIME + k) for k in range(len(names)))])
    np.savetxt(folder / "run.csv", rows, "%.6g", ",", header=",".join(["time", *names]), comments="")
    return {row["channel"]: row for row in gt.card(folder / "run.csv", model).rows}


@pytest.mark.parametrize("names", list(permutations(["power", "reactor temp [degC]", "jacket temp [degC]"])))
def test_a_column_called_as_a_port_is_the_level_there(tmp_path: Path, names: tuple[str, ...]) -> None:
    """Seen: both exchanged, with the words of a guess that nothing speaks against."""
    rows = drafted(tmp_path, Vessel(), names)
    assert (rows["T"]["column"], rows["T_j"]["column"]) == ("reactor temp [degC]", "jacket temp [degC]")
    assert "fits as well" not in rows["T"]["remark"] + rows["T_j"]["remark"]


@pytest.mark.parametrize("names", list(permutations(["power", "reactor temp [degC]", "jacket temp [degC]"])))
def test_where_nothing_tells_them_apart_each_is_said_to_fit_as_well(tmp_path: Path, names: tuple[str, ...]) -> None:
    rows = drafted(tmp_path, Unnamed(), names)
    both = {rows["T"]["column"], rows["T_j"]["column"]}
    assert both == {"reactor temp [degC]", "jacket temp [degC]"}
    for channel, other in (("T", "T_j"), ("T_j", "T")):
        assert f'guessed from the name, which "{rows[other]["column"]}" fits as well' in rows[channel]["remark"]
    assert rows["power"]["remark"] == ""
