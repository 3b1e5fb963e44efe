"""The units that a file says beside those that the card says: one of them is wrong where they differ, and nobody else would notice."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from greybox_torch.data.card_channels import ChannelEntry, TimeEntry
from greybox_torch.data.clocks_written import in_clocks
from greybox_torch.data.counts import check_counts, is_count
from greybox_torch.data.expression import Expression
from greybox_torch.data.own_columns import conversion_written, in_that_experiment
from greybox_torch.data.source import Source
from greybox_torch.data.time_units import unit_of_time
from greybox_torch.data.understood_units import capitals_alone, other_quantity, understood
from greybox_torch.data.units import conversion, slip
from greybox_torch.errors import UserError, check_none
from greybox_torch.files import toml_text


def in_unit(entry: ChannelEntry, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Values (N,) of a file in the channel's unit; units were checked by :func:`check_units`."""
    if entry.file_unit is None:
        return values * entry.scale
    factor, offset = conversion(_of_rate(entry.file_unit, entry), entry.unit, "file_unit")
    return values * factor + offset


def factor_of(entry: ChannelEntry) -> float:
    """By what the values of a file are multiplied for those in the channel's unit; not a number where more is done to them."""
    if entry.derivative is not None or entry.expr is not None:
        return np.nan
    zero, one = in_unit(entry, np.array([0.0, 1.0]))
    return float(one) if zero == 0.0 else np.nan


def check_units(
    place: str,
    channels: Mapping[str, ChannelEntry],
    formulas: Mapping[str, Expression],
    source: Source,
    own: Collection[str] = (),
) -> None:
    """Raises UserError, beginning with `place`, for all channels whose units on the card are not those that their files say; ``own`` are
    those of which the experiment has a column of its own.
    """
    problems: list[str] = []
    for name, formula in formulas.items():
        where = f'channel "{name}"'
        write = partial(conversion_written, name, formula.text, own=name in own)
        try:
            for path, found in _said(source, formula.text).items():
                _check_unit(where, channels[name], formula, path, found, write)
        except UserError as error:
            problems.append(str(error))
    check_none(problems, place, before_one=", ")


def _said(source: Source, column: str) -> dict[Path, str]:
    """The unit that each of the files says that a column is read from: several that follow each other, or one of those joined in time."""
    first = source.table(column)
    tables = source.tables if first in source.tables else (first,)
    return {table.path: table.units.get(column, "") for table in tables}


def _check_unit(
    place: str, entry: ChannelEntry, formula: Expression, path: Path, found: str, write: Callable[[str], str]
) -> None:
    if "scale" in entry.model_fields_set:  # whoever gives a factor has thought of the unit
        return
    column = formula.text
    check_counts(place, formula, path, found if is_count(found) else entry.file_unit or found, entry.unit)
    if entry.file_unit is not None:
        conversion(_of_rate(entry.file_unit, entry), entry.unit, f"{place}, file_unit")
        _check_file_unit(place, entry, column, path, found, write)
        return
    known = understood(found) if found and entry.unit else ""
    rate = _of_rate(known, entry)
    if not known or known == "1" or capitals_alone(found, entry.unit):
        return
    said = f'{place}: {path} has column "{column}" in "{found}", the card says "{entry.unit}"'
    factor = slip(rate, entry.unit)
    if factor is not None:
        conversion(rate, entry.unit, place)  # says so where nobody can tell the factor
        unit = write(f'file_unit = "{known}"')
        raise UserError(f"{said}; expected {unit} to convert it ({factor:.6g}), or the scale")
    if entry.unit != "1" and other_quantity(rate, entry.unit):
        raise UserError(f"{said}; expected another column; or, if the file's unit is wrong, {write('scale = 1.0')}")


def _check_file_unit(
    place: str, entry: ChannelEntry, column: str, path: Path, found: str, write: Callable[[str], str]
) -> None:
    """Raises UserError where the file says that a column is in another unit than `file_unit`."""
    known, given = understood(found) if found else "", entry.file_unit or ""
    if not known or known == "1" or capitals_alone(found, given) or not _differ(known, given):
        return
    raise UserError(
        f'{place}: {path} has column "{column}" in "{found}", the card says file_unit = "{given}"; '
        f"expected {_instead(known, entry, write)}; or, if the file's unit is wrong, {write(_all_the_same(entry, column))} in the place of "
        "file_unit"
    )


def _differ(found: str, given: str) -> bool:
    """Whether two units are known and not the same. Where one may count turns or radians, the card says which."""
    factor = slip(found, given)
    return factor == factor if factor is not None else other_quantity(found, given)


def _instead(known: str, entry: ChannelEntry, write: Callable[[str], str]) -> str:
    """What to write if the file is right."""
    with suppress(UserError):
        factor, offset = conversion(_of_rate(known, entry), entry.unit, "")
        same = abs(factor - 1.0) < 1e-9 and offset == 0.0
        unit = write(f'file_unit = "{known}"')
        return "no file_unit" if same and unit.startswith("file_unit") else unit
    return "another column"


def _all_the_same(entry: ChannelEntry, column: str) -> str:
    """What to write for values in `file_unit` if the card is right: what names no unit of the file is not compared with it."""
    factor, offset = conversion(_of_rate(entry.file_unit or "", entry), entry.unit, "")
    if offset == 0.0:
        return f"scale = {factor:.9g}"
    name = column if column.isidentifier() else f'col("{column}")'
    scaled = name if factor == 1.0 else f"{factor:.9g}*{name}"
    sign = "-" if offset < 0.0 else "+"
    return f"expr = {toml_text(f'{scaled} {sign} {abs(offset):.9g}')}"


def _of_rate(unit: str, entry: ChannelEntry) -> str:
    """The unit of what a channel is made of its column in `unit`: of its rate, where it is that."""
    return unit if entry.derivative is None else f"{unit} / s"


def check_unit_of_time(path: Path, time: TimeEntry, source: Source, clock: str, files: Sequence[str] = ()) -> None:
    """Raises UserError where a file says another unit of its time stamps than the card at `path`, which calls the ``files`` so."""
    said = {table.path: table.units.get(clock, "") for table in source.every}
    other = [file for file, unit in said.items() if unit_of_time(unit) not in ("", time.unit.replace("µ", "u"))]
    if not other:
        return
    found = unit_of_time(said[other[0]])
    if source.joined and len(other) < len(said):
        name = dict(zip((table.path for table in source.every), files, strict=False)).get(other[0], other[0].name)
        expected = in_clocks(name, column=clock, unit=found)
    else:
        expected = (
            f'time = {{ column = "{clock}", unit = "{found}" }}, or, where other files of the card are in "{time.unit}", '
            + in_that_experiment("time", f'column = "{clock}", unit = "{found}"')
        )
    raise UserError(
        f'{path}, time: {other[0]} has column "{clock}" in "{said[other[0]]}", the card says "{time.unit}"; expected {expected}'
    )
