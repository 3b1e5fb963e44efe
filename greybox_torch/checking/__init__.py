"""What is wrong with a model before any data: names, code, units, and what moves nothing."""
