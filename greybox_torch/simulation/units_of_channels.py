"""What to write for a channel that is in another unit than the model's."""

from __future__ import annotations

from greybox_torch.data import DataSet
from greybox_torch.data.recording import Channel
from greybox_torch.data.units import conversion, dimensionality, gravity, is_unit, meant, usual_units, written_alike
from greybox_torch.errors import UserError


def other_unit(dataset: DataSet, channel: Channel, wanted: str) -> str:
    """What is expected of a channel whose unit is not the ``wanted`` one: converted values, or another column where none can be."""
    found = channel.unit
    of_one_quantity = not (is_unit(found) and is_unit(wanted)) or dimensionality(found) == dimensionality(wanted)
    if not of_one_quantity:
        return (
            f"{found} cannot be converted to {wanted}{gravity(found, wanted)}; expected a column whose values are in {wanted}, "
            "or in a unit of that quantity"
        )
    return _by_hand(channel.name, found, wanted) if dataset.path is None else _on_the_card(channel, wanted)


def _on_the_card(channel: Channel, wanted: str) -> str:
    """The entries of a channel that give the model's unit: the file's own is converted, and not the one that was taken for it."""
    found, own = channel.unit, channel.file_unit
    unknown = "" if is_unit(found) else f"'{found}' is no unit that is known{meant(found, wanted)}; "
    if own and written_alike(own, wanted):
        said = f', as column "{channel.column}" is in it' if channel.column else ""
        return f'{unknown}expected unit = "{wanted}" without file_unit{said}'
    if own and _converted(own, wanted):
        return f'{unknown}expected unit = "{wanted}" with file_unit = "{own}", which converts the values of the file'
    if unknown or not is_unit(wanted):  # which no file_unit can be, nor be converted to
        known = ", ".join(f'"{unit}"' for unit in usual_units(wanted))
        such = f"with file_unit, a known unit such as {known}, or " if known else "with "
        return f'{unknown}expected unit = "{wanted}", and, where the file is in another unit, {such}a scale'
    return f'expected unit = "{wanted}" with file_unit = "{found}", or with a scale, to convert the values of the file'


def _converted(found: str, wanted: str) -> bool:
    """Whether values in one unit can be converted to another, and anybody can tell the factor."""
    try:
        conversion(found, wanted, "")
    except UserError:
        return False
    return True


def _by_hand(name: str, found: str, wanted: str) -> str:
    """How to convert values of Python, where nothing converts them."""
    try:
        factor, offset = conversion(found, wanted, "")
    except UserError:  # turns or radians, for example
        return f"expected values and unit of the model{meant(found, wanted)}"
    added = f" and add {offset:.9g}" if offset else ""
    return f'expected values in it: multiply those of "{name}" by {factor:.9g}{added}, and write units={{"{name}": "{wanted}"}}'
