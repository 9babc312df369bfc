"""What lets fluid in or out: taps, rain, holes, and what a prompt says that they do."""

from __future__ import annotations

from wsim.errors import UserError
from wsim.rules import contents
from wsim.rules.cast import Flow, Thing
from wsim.rules.lexicon import lexicon
from wsim.rules.liquids import Filled
from wsim.rules.phrases import Action, Clause, Phrase, Place
from wsim.rules.reader import Reader
from wsim.rules.tokens import NotUnderstood

SOURCES = ("tap", "rain", "drain")
_INTO = ("into", "in", "inside", "onto", "on", "to", "over", "above")
_OUT = ("out_of", "from")
_POURS = ("pour", "run", "fall", "fill", "go", "come")
_DRAINS = ("drain", "empty", "pour", "run", "go", "come")
_IS = ("is ", "are ", "was ", "were ", "gets ", "get ")
_SHORTEST = 0.05  # [s] that a flow may last


def is_source(phrase: Phrase | None) -> bool:
    """Whether a phrase names a tap, rain or a hole."""
    noun = lexicon().nouns.get(phrase.kind) if phrase is not None else None
    return noun is not None and noun.family in SOURCES


def named(reader: Reader, phrase: Phrase) -> Flow:
    """The flow that a phrase names: one spoken of before, or a new one.

    Raises:
        NotUnderstood: More is said of it than can be built.
        UserError: There is one already.
    """
    kind = lexicon().nouns[phrase.kind].family
    flow = next((one for one in reader.cast.flows if one.kind == kind), None)
    if id(phrase) in reader.flowing:
        return reader.flowing[id(phrase)]
    if flow is not None and not phrase.definite:
        raise UserError(f"{phrase.words!r}: the builtin planner has one {kind} in a scene; leave the other out")
    if flow is None:
        flow = Flow(kind, phrase.words)
        reader.cast.flows.append(flow)
    reader.flowing[id(phrase)] = flow
    reader.kept.append(phrase)
    _measured(flow, phrase)
    for place in phrase.places:
        _place(reader, flow, place)
    return flow


def _measured(flow: Flow, phrase: Phrase) -> None:
    """How wide it is, or how much it lets through."""
    said = {name for name, value in phrase.measures.items() if value}
    wide = {"diameter", "radius", "y", "x"} if flow.kind != "rain" else set[str]()
    known = said <= wide | {"flow", "rainfall"}
    counted = phrase.count not in (None, 1) or phrase.plural or phrase.masses
    looks = phrase.material or phrase.color or phrase.edges or phrase.shape or phrase.angle is not None
    heavy = phrase.weight is not None and not (flow.kind == "rain" and phrase.weight > 1.0)
    if counted or looks or heavy or not known or phrase.clauses or phrase.scale is not None or phrase.filled:
        raise NotUnderstood([phrase.words], f"lets one {flow.kind} be as wide or run as fast as is said, but not")
    for name, factor in (("diameter", 1.0), ("radius", 2.0), ("y", 1.0), ("x", 1.0)):
        if name in phrase.measures:
            flow.width = factor * phrase.measures[name]
    if phrase.length is not None and flow.kind != "rain":
        flow.width = phrase.length
    for name in ("flow", "rainfall"):
        if name in phrase.measures:
            _rated(flow, phrase.measures[name], name, phrase.words)


def _rated(flow: Flow, value: float, unit: str, words: str) -> None:
    if (unit == "rainfall") != (flow.kind == "rain") or flow.kind == "drain":
        way = {"tap": "a tap in litres per second", "rain": "rain in mm per hour", "drain": "a hole by its width"}
        raise NotUnderstood([words], f"measures {way[flow.kind]}, not so:")
    flow.rate = _once(flow.rate, value, words)


def _once(before: float | None, value: float | None, words: str) -> float | None:
    if before is not None and value is not None and before != value:
        raise UserError(f"{words!r}: the prompt says another number before")
    return value if value is not None else before


def _place(reader: Reader, flow: Flow, place: Place) -> None:
    """Where it is, how much it lets through, and when.

    Raises:
        NotUnderstood: It cannot be there, or so.
    """
    at, words = place.phrase, place.words
    if place.preposition in ("flow", "rainfall"):
        _rated(flow, place.value or 0.0, place.preposition, words)
    elif place.preposition in ("time", "in time") and flow.kind != "drain":
        flow.lasts = _once(flow.lasts, place.value, words)
    elif place.preposition == "time":
        reader.cast.duration = place.value
    elif place.preposition == "after" and flow.kind != "drain":
        flow.start = _once(flow.start, place.value, words)
    elif place.preposition == "up to" and flow.kind == "tap":
        flow.level = _once(flow.level, place.length, words)
    elif place.preposition == "from" and place.length is not None and flow.kind == "tap":
        flow.height = _once(flow.height, place.length, words)
    elif place.preposition == "side" and place.side is not None and place.side.key == "above" and at is not None:
        if flow.kind == "tap" and place.length is not None:
            flow.height = _once(flow.height, place.length, words)
        _vessel(reader, flow, at, words)
    elif at is not None and flow.kind == "drain" and place.preposition in ("in", "at", "on", "inside", "into"):
        _in_wall(reader, flow, at, words)
    elif at is not None and flow.kind != "drain" and place.preposition in _INTO:
        _vessel(reader, flow, at, words)
    else:
        raise NotUnderstood([words], f"cannot let a {flow.kind} be there, or do so:")


def _in_wall(reader: Reader, flow: Flow, at: Phrase, words: str) -> None:
    """A hole in a tank's floor, or in its wall."""
    wall = at.kind == "wall" or (at.kind == "part" and at.part == "edge")
    floor = at.kind == "ground" or (at.kind == "part" and at.part in ("bottom", "middle"))
    owner = at.owner if at.kind == "part" else None
    if wall or floor:
        wide = at.length or at.measures.get("y") or at.measures.get("diameter")
        if wide and floor:  # "in its floor that is 5 cm wide": the hole is
            flow.width, at.length, at.measures = _once(flow.width, wide, words), None, {}
        if at.adorned:
            raise NotUnderstood([words], "knows holes in a tank's floor or wall, not so:")
        flow.wall = wall
        if owner is not None:
            _vessel(reader, flow, owner, words)
        return
    _vessel(reader, flow, at, words)


def _vessel(reader: Reader, flow: Flow, at: Phrase, words: str) -> None:
    """The tank, the vessel, or what rain falls on."""
    if at.kind == "pronoun":
        vessels = reader.cast.family("vessel")
        flow.vessel = flow.vessel or (vessels[-1] if len(vessels) == 1 and reader.cast.tank is None else None)
        return
    if at.kind == "ground" and flow.kind == "rain" and words.startswith("on"):
        reader.scenery(at)
        flow.ground = True
        return
    if at.kind == "water" and reader.cast.tank is not None:
        return
    noun = lexicon().nouns.get(at.kind)
    if noun is not None and noun.family == "tank":
        reader.scenery(at)
        return
    if noun is not None and noun.family == "vessel" and flow.kind != "drain":
        if at.filled or at.share is not None:
            contents.full(reader.cast, at)
        held, at.filled, at.share = at.filled, None, None
        flow.vessel = reader.thing(at)
        reader.cast.stands = reader.cast.stands or bool(held)
        return
    if noun is not None and flow.kind == "rain" and noun.family in ("roof", "furniture", "solid"):
        flow.on = reader.thing(at)
        return
    into = {
        "tap": "into a tank, a bucket or a bowl",
        "rain": "on a tank, a roof, a table or a box",
        "drain": "of a tank",
    }
    raise NotUnderstood([words], f"lets fluid run {into[flow.kind]}, not there:")


def sourced(action: Action) -> bool:
    """Whether an action names what fluid comes from, or how fast."""
    return any(is_source(place.phrase) or place.preposition == "flow" for place in action.places)


def comes_later(clause: Clause) -> None:
    """ "Fill an empty tank with milk from a tap": what fills it is not in it before."""
    for action in clause.actions:
        for phrase in clause.subjects:  # "water from a hose fills a tank"
            if phrase.kind == "water":
                action.places += [place for place in phrase.places if is_source(place.phrase)]
                phrase.places = [place for place in phrase.places if not is_source(place.phrase)]
        by = sourced(action)
        for phrase in clause.subjects if action.verb == "fill" else ():
            if phrase.filled and (by or phrase.share == 0.0):
                full = Phrase(phrase.kind, phrase.words, filled=phrase.filled)
                action.places.append(Place("full", words=phrase.words, full=full))
                phrase.filled = None


def flows(reader: Reader, clause: Clause, scenery: list[Phrase], subjects: list[Thing], action: Action) -> bool:
    """Take an action in which fluid comes in or goes out; False for the others."""
    source = next((phrase for phrase in scenery if is_source(phrase)), None)
    if source is not None:
        _of_source(reader, named(reader, source), clause, action)
        return True
    by = next((place for place in action.places if is_source(place.phrase)), None)
    liquid = bool(scenery) and all(phrase.kind == "water" for phrase in scenery) and not subjects
    vessels = [thing for thing in subjects if thing.noun.family == "vessel"]
    tank = bool(scenery) and all(lexicon().nouns[p.kind].family == "tank" for p in scenery if p.kind in lexicon().nouns)
    if action.verb == "fill" and (tank or vessels) and not (tank and vessels):
        return _filled(reader, vessels, clause, action, by)
    if action.verb in ("drain", "empty") and tank and not liquid and not subjects:
        _emptied(reader, None, action)
        return True
    kind = lexicon().nouns[by.phrase.kind].family if by is not None and by.phrase is not None else ""
    out = [place for place in action.places if place.preposition in _OUT and not is_source(place.phrase)]
    drains = kind == "drain" or action.verb == "drain" or any(place.phrase is not None for place in out)
    if liquid and action.verb in _DRAINS and drains:
        _emptied(reader, next((p.phrase for p in out if p.phrase is not None), None), action)
        return True
    timed = any(place.preposition in ("flow", "rainfall") for place in action.places)
    if liquid and action.verb in _POURS and (by is not None or timed or "flow" in scenery[0].measures):
        _poured(reader, scenery[0], action, by)
        return True
    if any(phrase is not None and is_source(phrase) for phrase in (action.target, *(p.phrase for p in action.places))):
        raise NotUnderstood([clause.words], "lets taps, rain and holes fill and drain tanks and vessels, not")
    return False


def _of_source(reader: Reader, flow: Flow, clause: Clause, action: Action) -> None:
    """What a tap, rain or a hole does."""
    verb, target = action.verb, action.target
    known = {
        "tap": ("pour", "run", "fill", "open", "close", "stop", "start", "rest"),
        "rain": ("fall", "pour", "fill", "stop", "start", "rest"),
        "drain": ("open", "drain", "rest"),
    }[flow.kind]
    done_to = action.words.startswith(_IS) and verb in ("fill", "drain", "pour", "run")  # "a tap is filled"
    if verb not in known or len(clause.subjects) > 1 or done_to:
        raise NotUnderstood([f"{flow.words} {action.words}"], "cannot let a tap, rain or a hole do this:")
    if verb in ("close", "stop"):
        _ends(flow, action)
        return
    if target is not None and target.kind == "water" and verb != "fill":
        _amount(reader, flow, target)
    elif target is not None and verb in ("fill", "drain"):
        _target(reader, flow, target)
    elif target is not None:
        raise NotUnderstood([action.words], "pours water and other liquids, but not this")
    for place in action.places:
        if place.preposition == "full" and place.full is not None and place.full.filled:
            contents.fill(reader.cast, place.full.filled, place.words)
        else:
            _place(reader, flow, place)


def _ends(flow: Flow, action: Action) -> None:
    """ "Is turned off after 2 seconds"."""
    times = [place.value for place in action.places if place.preposition == "after" and place.value is not None]
    if len(times) != 1 or len(action.places) != 1 or times[0] - (flow.start or 0.0) < _SHORTEST:
        raise NotUnderstood(
            [f"{flow.words} {action.words}"], "shuts a tap after a time, as 'after 2 seconds' says, not"
        )
    flow.lasts = _once(flow.lasts, times[0] - (flow.start or 0.0), action.words)


def _amount(reader: Reader, flow: Flow, liquid: Phrase) -> None:
    """ "Pours 2 litres of oil": which liquid, and how much of it."""
    if liquid.filled or liquid.share is not None or liquid.places:
        raise NotUnderstood([liquid.words], "pours a liquid into a tank, a bucket or a bowl, not so:")
    flow.volume = _once(flow.volume, liquid.volume, liquid.words)
    if contents.depth_of(liquid) is not None:
        flow.level = _once(flow.level, contents.depth_of(liquid), liquid.words)
    for unit in ("flow", "rainfall"):
        if unit in liquid.measures:
            _rated(flow, liquid.measures[unit], unit, liquid.words)
    contents.fill(reader.cast, Filled(liquid.liquid, color=liquid.color), liquid.words)
    reader.cast.water = reader.cast.water or liquid.words


def _target(reader: Reader, flow: Flow, target: Phrase) -> None:
    """ "Fills a tank with milk": with what comes, which does not stand in it before."""
    held = target.filled
    if held and flow.kind != "drain" and not (target.definite and reader.cast.tank is not None):
        target.filled = None
        flow.volume, flow.level = (
            _once(flow.volume, held.volume, target.words),
            _once(flow.level, held.level, target.words),
        )
        contents.fill(reader.cast, Filled(held.liquid, color=held.color), target.words)
        reader.cast.water = reader.cast.water or target.words
    _vessel(reader, flow, target, target.words)


def _flow(reader: Reader, kind: str, words: str) -> Flow:
    """The flow of a kind that was spoken of, or a new one that the prompt does not name."""
    flow = next((one for one in reader.cast.flows if one.kind == kind), None)
    if flow is None:
        flow = Flow(kind, words)
        reader.cast.flows.append(flow)
    return flow


def _filled(reader: Reader, vessels: list[Thing], clause: Clause, action: Action, by: Place | None) -> bool:
    """A tank or a vessel is filled: by a tap, else as it is said to stand."""
    empty = reader.cast.share == 0.0
    comes = by is not None or empty or any(place.preposition == "flow" for place in action.places)
    full = next((place.full for place in action.places if place.preposition == "full"), None)
    rest = [place for place in action.places if place.preposition != "full" and place is not by]
    if not comes:
        if vessels or rest or action.target is not None:
            return False
        if full is not None:
            contents.full(reader.cast, full)
            reader.cast.stands = reader.cast.stands or bool(full.filled)
        elif not reader.cast.stands:
            raise NotUnderstood([clause.words], "needs to be told with what, or by what tap, this is filled:")
        return True
    if action.target is not None:
        raise NotUnderstood([f"{clause.words}"], "lets a tank be filled with a liquid, as 'with milk' says, not so:")
    flow = named(reader, by.phrase) if by is not None and by.phrase is not None else _flow(reader, "tap", action.words)
    if vessels:
        flow.vessel = vessels[0]
    filled = full.filled if full is not None else None
    if filled:
        flow.volume = _once(flow.volume, filled.volume, action.words)
        flow.level = _once(flow.level, filled.level, action.words)
        contents.fill(reader.cast, Filled(filled.liquid, color=filled.color), action.words)
    for place in rest:
        _place(reader, flow, place)
    return True


def _emptied(reader: Reader, tank: Phrase | None, action: Action) -> None:
    """Fluid drains out of a tank, by a hole that may be named."""
    by = next((place for place in action.places if is_source(place.phrase)), None)
    if action.target is not None:
        raise NotUnderstood([action.words], "lets a tank drain through a hole, not so:")
    flow = (
        named(reader, by.phrase) if by is not None and by.phrase is not None else _flow(reader, "drain", action.words)
    )
    if flow.kind != "drain":
        raise NotUnderstood([action.words], "lets a tank drain through a hole, not so:")
    flow.empties = flow.empties or action.verb == "empty"
    if tank is not None:
        _vessel(reader, flow, tank, action.words)
    for place in action.places:
        out = place.preposition in _OUT and place.phrase is not None and place.phrase is tank
        if place is not by and not out:
            _place(reader, flow, place)


def _poured(reader: Reader, liquid: Phrase, action: Action, by: Place | None) -> None:
    """ "Water flows from a tap into a tank", "milk pours into a bowl at 0.1 litres per second"."""
    kind = "tap" if by is None or by.phrase is None else lexicon().nouns[by.phrase.kind].family
    if kind == "drain":
        raise NotUnderstood([action.words], "needs to be told out of what tank this runs:")
    flow = named(reader, by.phrase) if by is not None and by.phrase is not None else _flow(reader, kind, action.words)
    _amount(reader, flow, liquid)
    if action.target is not None and action.verb != "fill":
        raise NotUnderstood([action.words], "pours a liquid into a tank, a bucket or a bowl, not so:")
    if action.target is not None:
        _target(reader, flow, action.target)
    for place in action.places:
        if place is not by:
            _place(reader, flow, place)
