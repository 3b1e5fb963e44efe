"""The report for print: the sections of the page on sheets of A4, drawn by matplotlib alone."""
