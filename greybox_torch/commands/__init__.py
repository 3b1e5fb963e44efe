"""The work behind the command line: one file a command, each with a function `run(…, options)`."""
