"""The explorer: a page on the loopback address on which a flyer's numbers can be moved.

``state`` turns what the page holds into a flyer file and back, ``grammar`` tells the page which
fields there are, ``compute`` and ``jobs`` call the package, ``view`` turns results into figures,
``server`` answers the page. The server keeps nothing of a page: every request says all.
"""
