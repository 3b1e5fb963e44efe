"""Columns of a further file that are called as those of the first one with something added to all: "uval" and "yval" for "u" and "y"."""

from __future__ import annotations

from collections.abc import Mapping, Sequence


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
