"""`python -m greybox_torch` is the command `greybox`."""

from greybox_torch.cli import main

if __name__ == "__main__":
    main()
