"""Cameras framed on the motion that was recorded: what they are to show, when it matters, and from where it is seen.

`motion` is what is looked at, `subjects` the outlines of what a run is about, `moments` when something happens,
`shown` measures what a view shows, `tried` gives views that may show more, `frame` keeps or corrects a world's cameras.
"""
