"""Charts for the page: vector curves that stretch with the screen, under texts that keep their size.

A picture with its own letters would be unreadable on a phone or too coarse on a desk. Here only curves are drawn (SVG); scales, ticks
and labels are text of the page, so that it follows the reader's font, width, and light or dark setting.
"""
