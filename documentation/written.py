"""The pages that are written from the code. In docs/ a page of the same name says how to get each of them."""

from __future__ import annotations

from documentation import card_fields, command_line, gallery, settings_table

WRITTEN = {
    "reference/command_line.md": command_line.page,
    "reference/card_fields.md": card_fields.page,
    "reference/settings.md": settings_table.page,
    "reference/mechanisms.md": gallery.page,
}
"""By their place on the site, and what writes them."""
