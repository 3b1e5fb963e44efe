"""What the results that draft one text file have in common."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from greybox_torch.api.result import Result
from greybox_torch.files import write_new


class DraftedFile(Result):
    """A result that is the ``text`` of one file, which belongs to ``path``; it never replaces a file that is there."""

    path: Path
    text: str

    def files(self, folder: Path) -> dict[Path, str | bytes]:
        return {folder / self.path.name: self.text}

    def save(self, folder: str | PathLike[str] | None = None) -> tuple[Path, ...]:
        """Write the file to its path, or into another folder.

        Raises:
            UserError: there is a file of that name already, or it cannot be written.
        """
        path = self.path if folder is None else Path(folder) / self.path.name
        write_new(path, self.text)
        return (path,)
