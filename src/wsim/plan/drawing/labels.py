"""Where names go in a picture: in the thing if they fit, else beside it, clear of other names as far as can be."""

from __future__ import annotations

from dataclasses import dataclass

Rect = tuple[float, float, float, float]  # left, top, right, bottom [pixels]
MARGIN = 3.0
MOST_TOGETHER = 3  # names, or numbers, in one label


@dataclass(frozen=True)
class Wanted:
    """A name that looks for a place.

    Attributes:
        text: The name.
        size: Its width and height [pixels].
        thing: Bounding rectangle of what it names.
        inside: "middle" if the name may lie over the thing's middle, "corner" if its middle is for others.
    """

    text: str
    size: tuple[float, float]
    thing: Rect
    inside: str


def place(wanted: list[Wanted], frame: Rect) -> list[Rect]:
    """A rectangle for each name, in order; the same names give the same places.

    Args:
        wanted: The names; those of small things find a place first, since they have the fewest.
        frame: What they must stay in.
    """
    placed: dict[int, Rect] = {}
    for index in sorted(range(len(wanted)), key=lambda k: (_area(wanted[k].thing), k)):
        one = wanted[index]
        # What the thing lies on does not count: its name may lie there too.
        others = [
            w.thing
            for k, w in enumerate(wanted)
            if k != index and w.inside == "middle" and not _holds(w.thing, one.thing)
        ]
        best, lowest = None, 0.0
        for cost, rect in _candidates(one):
            if rect[0] < frame[0] or rect[1] < frame[1] or rect[2] > frame[2] or rect[3] > frame[3]:
                cost += 1000.0
            room = _area(rect)
            cost += sum(50.0 * _shared(rect, other) / room for other in placed.values())
            if best is None or cost < lowest:  # the rest can only make it worse
                cost += sum(4.0 * _shared(rect, other) / room for other in others)
            if best is None or cost < lowest:
                best, lowest = rect, cost
        assert best is not None
        placed[index] = _kept(best, frame)
    return [placed[k] for k in range(len(wanted))]


def together(names: list[str]) -> str:
    """One label for things at one place: "block_1, 2, 3", "ball, block_1"; of many, the first and how many more."""
    stems: dict[str, list[str]] = {}
    for name in sorted(names, key=lambda name: (len(name), name)):
        stem, _, number = name.rpartition("_")
        key, end = (stem, number) if stem and number.isdigit() else (name, "")
        stems.setdefault(key, []).append(end)
    parts = []
    for stem, ends in stems.items():
        numbers = [end for end in ends if end]
        parts += [stem] * (len(ends) - len(numbers))
        if len(numbers) > MOST_TOGETHER:
            parts.append(f"{stem}_{numbers[0]} … {numbers[-1]}")
        elif numbers:
            parts.append(f"{stem}_{', '.join(numbers)}")
    more = f" +{len(parts) - MOST_TOGETHER}" if len(parts) > MOST_TOGETHER else ""
    return ", ".join(parts[:MOST_TOGETHER]) + more


def _candidates(one: Wanted) -> list[tuple[float, Rect]]:
    """Places with what each costs before others are asked: near and inside is cheap."""
    width, height = one.size
    left, top, right, bottom = one.thing
    x, y = (left + right) / 2, (top + bottom) / 2
    fits = right - left >= width + 2 * MARGIN and bottom - top >= height + 2 * MARGIN
    found = []
    if one.inside == "middle":
        found.append((0.0 if fits else 3.0 + width / max(right - left, 1.0), _at(x, y, one.size)))
    elif fits:
        inner = (
            (left + MARGIN + width / 2, right - MARGIN - width / 2),
            (
                top + MARGIN + height / 2,
                bottom - MARGIN - height / 2,
            ),
        )
        found += [(0.1 * k, _at(inner[0][k % 2], inner[1][k // 2], one.size)) for k in range(4)]
    for ring in range(12):
        away = MARGIN + height / 2 + 1.1 * ring * height
        cost = 1.0 + 0.7 * ring
        for shift in (0.0, -0.5, 0.5):
            aside = x + shift * (width + right - left)
            found.append((cost + abs(shift), _at(aside, top - away, one.size)))
            found.append((cost + abs(shift) + 0.05, _at(aside, bottom + away, one.size)))
        sideways = MARGIN + width / 2 + 0.4 * ring * width
        found.append((cost + 0.3, _at(right + sideways, y, one.size)))
        found.append((cost + 0.35, _at(left - sideways, y, one.size)))
    return found


def _at(x: float, y: float, size: tuple[float, float]) -> Rect:
    return (x - size[0] / 2, y - size[1] / 2, x + size[0] / 2, y + size[1] / 2)


def _kept(rect: Rect, frame: Rect) -> Rect:
    dx = max(frame[0] - rect[0], 0.0) or min(frame[2] - rect[2], 0.0)
    dy = max(frame[1] - rect[1], 0.0) or min(frame[3] - rect[3], 0.0)
    return (rect[0] + dx, rect[1] + dy, rect[2] + dx, rect[3] + dy)


def _holds(outer: Rect, inner: Rect) -> bool:
    return outer[0] <= inner[0] and outer[1] <= inner[1] and outer[2] >= inner[2] and outer[3] >= inner[3]


def _area(rect: Rect) -> float:
    return max((rect[2] - rect[0]) * (rect[3] - rect[1]), 1.0)


def _shared(a: Rect, b: Rect) -> float:
    """Area that two rectangles share [pixels^2]."""
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    return width * height if width > 0.0 and height > 0.0 else 0.0
