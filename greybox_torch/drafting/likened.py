"""Columns of a further file that are called as those of the first one with something added to all, "uval" and "yval" for "u" and "y", or as
they are in another structure: "log.az" for "az".
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence

from greybox_torch.data.column_units import without_unit


def likened(first: Mapping[str, str], columns: Sequence[str]) -> dict[str, str]:
    """By channel its column among ``columns``, where these have other names than those of the ``first`` file, by channel, and one ending or
    one beginning leads from all of those to some of these; the shortest one. Empty where none does.
    """
    known, wanted = set(columns), list(first.values())
    if not all(wanted) or not wanted or known & set(wanted):
        return {}
    endings = {name.removeprefix(wanted[0]) for name in columns if name.startswith(wanted[0])}
    beginnings = {name.removesuffix(wanted[0]) for name in columns if name.endswith(wanted[0])}
    affixes = [("", ending) for ending in endings] + [(beginning, "") for beginning in beginnings]
    for before, behind in sorted(affixes, key=lambda affix: (len(affix[0] + affix[1]), affix)):
        found = {channel: f"{before}{name}{behind}" for channel, name in first.items()}
        if known.issuperset(found.values()):
            return found
    return {}


def of_the_same_last_name(first: Mapping[str, str], found: Mapping[str, str], columns: Sequence[str]) -> dict[str, str]:
    """By channel that has a column in the ``first`` file and none ``found`` in this one, the free column that is called so within its
    structure; none where two are, or where two channels are called so.
    """
    free = [column for column in columns if column not in found.values()]
    alike: dict[str, str] = {}
    for channel, known in first.items():
        own = [column for column in free if _last(column) == _last(known)]
        if channel not in found and len(own) == 1:
            alike[channel] = own[0]
    taken = Counter(alike.values())
    return {channel: column for channel, column in alike.items() if taken[column] == 1}


def _last(column: str) -> str:
    """ "az" of "log.imu.az [g]". A point before a blank is none between names."""
    name = without_unit(column)
    return name.rpartition(".")[2] if all(part.isidentifier() for part in name.split(".")) else name
