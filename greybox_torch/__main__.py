"""`python -m greybox_torch` is the command `greybox`."""

from __future__ import annotations

import sys


def main() -> None:
    """The command line. Ctrl-C while it is still being loaded ends it as later: with one word and exit code 130."""
    try:
        from greybox_torch.cli import main as command_line

        command_line()
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
