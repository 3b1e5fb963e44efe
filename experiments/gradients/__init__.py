"""When which gradient pays: time, memory and error of the three over the length of a window."""
