"""What users call, from Python and through the command line: one function and its result a file."""
