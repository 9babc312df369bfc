"""The end of a recording, over which what is to be so at last is asked."""

from __future__ import annotations

WINDOW = 1.0  # means are taken over the last second [s],
SHARE = 0.25  # or this share of a longer run,
MOST = 0.5  # but never over more than this share


def final_window(span: float) -> float:
    """The length of the judge's final window in a recording of a span [s]."""
    return min(max(WINDOW, SHARE * span), MOST * span)


def span_for(begins: float) -> float:
    """The least span of a recording whose final window begins so late [s]: the other way round."""
    return min(max(begins + WINDOW, begins / (1.0 - SHARE)), begins / (1.0 - MOST))
