"""Verdicts on a folder of cases: made by the command line as a user would, compared with earlier ones, scored against keys."""
