"""The English of prompts about worlds: verbs by what can show them, units, numbers in words, words of manner.

Closed lists: a verb that is in none of them asks for nothing here. They are of physics, not of any scene.
"""

from __future__ import annotations

import math


def as_set(words: str) -> frozenset[str]:
    """The words of a text."""
    return frozenset(words.split())


# What happens: an objective must ask for it.
MOTIONS = as_set(
    """
    accelerate alight arc arrive ascend balance barrel bob bounce brake bump capsize careen career carry catch
    chase circle climb close coast collapse collide come crash crawl creep cross crush dangle dart decelerate
    deflect deliver descend detach dip dislodge dive dodge drag drain drift drip drive drop emerge empty enter
    escape evade exit fall fill flap flip float flow fly follow funnel gallop glide go grab grasp graze gush
    gyrate halt haul hit hoist hop hover hurtle impact jerk jolt jostle judder jump keel kick knock land lap
    leap leave lift lower lurch march meet merge migrate miss move nudge open orbit oscillate overflow overtake
    overturn pass patrol pick pitch pivot plop plough plow plummet plunge poke pour precess prod pull push
    quiver raise ram reach rebound recoil reel return reverse revolve ricochet ride rise rock roll rotate run
    rush sail scatter settle shake shift shove shut sink skate skid skim skip slam slap slide slip slither slosh
    slow smash snag soar speed spill spin spiral splash spread spurt squirt stack stagger steer stop strike
    stroll sway sweep swerve swim swing swirl swivel tap teeter thump tilt tip topple toss totter touch tow
    transport travel traverse tremble trickle trip trot trundle tug tumble turn twirl twist unlock unwind upset
    vault veer vibrate waddle walk whack whirl wobble yaw yield zigzag zoom
    """
)
# Of a thing itself, and how far it goes may stand behind it: "rolls 3 m".
GOES = as_set(
    """
    coast creep drift drive fly glide go hop kick launch march move nudge push roll run sail send shoot shove skid
    slide slip speed throw toss travel walk
    """
)
LETS_GO = as_set("release")  # of what is free from the start on, that it is there shows it
TURNS = as_set("turn spin rotate revolve pivot swivel whirl twirl")
# What sets a thing going: its start may show it as well, a velocity, a drive.
CAUSES = as_set(
    """
    crank dispense drive drop eject fire fling flick hurl inject kick launch lob nudge propel pull push release
    roll run rotate send shoot shove slide spin start swing throw toss turn
    """
)
# How things stand to each other: any evidence will do, the objects and joints themselves included.
STATES = as_set(
    """
    align anchor arrange attach bear bolt bridge build chain clamp clip connect contain cover dangle embed end
    enclose face fasten fit fix fold glue guide hang hinge hold hook join keep lay lean lie line link load lock mount
    park perch pile pin place position prop put reside rest screw seal separate sit span stand stay stick string
    submerge support surround suspend tether tie wait weigh weld wrap
    """
)
# What nothing in wsim does: bodies are rigid, water is water, and there is neither heat nor field.
BEYOND = as_set(
    """
    absorb attract bake bend blaze bleed boil break buckle burn burst char chip chop compress condense conduct cook
    cool corrode crack crease crumble crumple curl cut deflate deform dent dissolve drape electrify erode evaporate
    expand explode fizz flex flutter fracture fray freeze fuse glow heat ignite illuminate implode inflate
    magnetise magnetize melt peel pop puncture reflect refract repel rip rupture rust scorch shatter shine shred
    shrink slice smoke smoulder snap solidify splinter split squash squeeze stretch tear thaw unravel vaporise
    vaporize warp wilt wrinkle
    """
)
# But springs do these, and joints with a drive that is stiff.
SPRINGY = as_set("compress squeeze stretch")
# What a schedule does: "opens after a second", "is lifted at 0.5 m/s". How a thing goes on then, or stops, is seen.
SCHEDULED = CAUSES - as_set("roll run slide swing") | as_set("apply close lift lower open raise shut twist wait")
OPENED = as_set("open close shut turn switch stop start")  # what is done to a tap, at the times that it has
IRREGULAR = {
    "ran": "run", "fell": "fall", "fallen": "fall", "slid": "slide", "swung": "swing", "spun": "spin",
    "struck": "strike", "threw": "throw", "thrown": "throw", "shot": "shoot", "flew": "fly", "flown": "fly",
    "sank": "sink", "sunk": "sink", "rose": "rise", "risen": "rise", "drove": "drive", "driven": "drive",
    "rode": "ride", "ridden": "ride", "went": "go", "gone": "go", "came": "come", "met": "meet", "swam": "swim",
    "swum": "swim", "swept": "sweep", "flung": "fling", "caught": "catch", "left": "leave", "leapt": "leap",
    "dove": "dive", "sped": "speed", "crept": "creep", "sent": "send", "broke": "break", "broken": "break",
    "bent": "bend", "burnt": "burn", "tore": "tear", "torn": "tear", "froze": "freeze", "frozen": "freeze",
    "shone": "shine", "stood": "stand", "sat": "sit", "lay": "lie", "laid": "lay", "hung": "hang", "held": "hold",
    "built": "build", "kept": "keep", "stuck": "stick", "tied": "tie", "lying": "lie", "tying": "tie",
    "lies": "lie", "ties": "tie", "shook": "shake", "shaken": "shake", "bore": "bear", "borne": "bear",
    "leant": "lean", "spilt": "spill", "drew": "draw",
}  # fmt: skip
SAME_PAST = as_set("hit put cut burst spread split")  # their past is their base

DETERMINERS = as_set("a an the this that these those its his her their our my your each every some any no both")
# After these a base form is a verb: "lets it fall", "to roll", "will tip".
BEFORE_BASE = as_set(
    "to will can must should may would could shall let lets make makes and then it they which that who"
)
PREPOSITIONS = as_set(
    """
    above across against along around at behind below beneath beside between beyond by down from in inside into
    near of off on onto out over past through towards toward under underneath until up upon with within without
    """
)
RELATIONS = PREPOSITIONS - {"of", "by", "with", "at", "without", "until"}

# What is no noun: a number behind one of these counts, and before one of these does not.
NO_NOUN = (
    DETERMINERS
    | PREPOSITIONS
    | BEFORE_BASE
    | as_set(
        """
        after again all also am and are as be been before being but could did do does each even ever first for former
        had has have he her here him how if is just last later latter less more most must next not now once one only
        or other others otherwise own past remaining same she since so still than them there these they this
        those though too twice was we were what when where while whose why you almost exactly least nearly roughly upon
        versus via
        """
    )
)
QUANTITIES = as_set(  # whose value may stand right behind them
    """
    acceleration angle coefficient damping density depth distance factor friction gravity height length level mass
    radius rate ratio restitution scale share size speed spacing stiffness thickness time velocity weight width
    """
)
NUMBERED = as_set("number no nr type model mark mk version class series")  # a number behind these is a name's
COMPARES = as_set("as the its their that this more less")  # after "twice" and "three times": how much, not how often
BY_THEN = frozenset((("less", "than"), ("later", "than"), ("at", "most")))  # before a time: by then at the latest
BEFORE_TIMES = as_set(
    "within under in for after than every about almost over just"
)  # "a second" behind these is a time
DENIES = as_set("not never cannot without no nothing none neither nobody avoid avoids avoiding avoided")
OF_TIME = as_set("after as before during first initially once since still then until when while yet")
KEEPS_FROM = as_set("keep keeps kept prevent prevents prevented stop stops stopped hinder hinders hindered")
# Between a denial and its verb: "does not ever get to be touched", "without a single block falling".
BETWEEN = as_set(
    """
    ever even once yet then either or nor to be been being get gets got have has had do does did will would can could
    at any all time longer again
    """
)

# Manner without a number: nothing measures it unless a clause of its own says what does.
MANNERS = as_set("gently softly slowly quickly rapidly suddenly smoothly violently carefully lightly barely hard fast")
NO_MANNER = as_set(
    """
    assembly belly bully completely directly evenly exactly family finally fly freely fully horizontally hourly
    initially jelly likely lily mutually nearly only partially perfectly previously rally rapidly reply roughly
    simultaneously supply symmetrically trolley uniformly vertically approximately entirely tightly loosely equally
    diagonally radially axially continuously repeatedly alternately immediately early
    """
)

_ONES = """zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen
seventeen eighteen nineteen"""
_TENS = "twenty thirty forty fifty sixty seventy eighty ninety"
WORDS: dict[str, float] = {word: float(k) for k, word in enumerate(str.split(_ONES))}
WORDS |= {word: 10.0 * k for k, word in enumerate(str.split(_TENS), start=2)}
SCALES = {"hundred": 100.0, "thousand": 1000.0, "dozen": 12.0}
PARTS = {"half": 0.5, "quarter": 0.25, "halves": 0.5, "quarters": 0.25, "thirds": 1 / 3, "third": 1 / 3}

_LENGTHS = {
    1.0: "m metre metres meter meters", 0.01: "cm centimetre centimetres centimeter centimeters",
    0.001: "mm millimetre millimetres millimeter millimeters", 1000.0: "km kilometre kilometres kilometer kilometers",
    0.0254: "inch inches", 0.3048: "ft foot feet",
}  # fmt: skip
_TIMES = {
    1.0: "s sec secs second seconds", 0.001: "ms millisecond milliseconds", 60.0: "min minute minutes",
    3600.0: "h hour hours",
}  # fmt: skip
_OTHERS = {
    "kg": {1.0: "kg kilogram kilograms kilo kilos", 0.001: "g gram grams", 1000.0: "tonne tonnes ton tons",
           0.45359237: "lb lbs pound pounds", 0.02834952: "oz ounce ounces"},
    "deg": {
        1.0: "deg degree degrees °", 360.0: "revolution revolutions turn turns",
        math.degrees(1.0): "rad radian radians",
    },
    "deg/s": {6.0: "rpm"},
    "m/s": {1000 / 3600: "kmh kph", 1609.344 / 3600: "mph"},
    "m^3": {0.001: "l litre litres liter liters", 1e-6: "ml millilitre millilitres milliliter milliliters",
            1e-5: "cl centilitre centilitres", 0.003785411784: "gallon gallons"},
    "N": {1.0: "n newton newtons", 1000.0: "kn"},
    "Hz": {1.0: "hz hertz"},
    "1": {0.01: "% percent"},
}  # fmt: skip


def _units() -> dict[tuple[str, ...], tuple[str, float]]:
    """A unit's tokens, with its SI unit (angles in degrees) and how many of it one is."""
    found: dict[tuple[str, ...], tuple[str, float]] = {}
    for unit, sizes in ({"m": _LENGTHS, "s": _TIMES} | _OTHERS).items():
        for size, words in sizes.items():
            found |= {(word,): (unit, size) for word in words.split()}
    plain = dict(found)
    times = [(word, size) for size, words in _TIMES.items() for word in words.split()]
    for said, (unit, size) in plain.items():
        word = said[0]
        if unit not in ("m", "deg", "m^3"):
            continue
        for per, seconds in times:
            for between in ("/", "per", "a", "an", "each", "every"):
                if between in ("/", "per") or len(per) > 3:
                    found[(word, between, per)] = (f"{unit}/s", size / seconds)
        if unit == "m" and size == 1.0:
            for square in (("s", "^", "2"), ("s", "²"), ("s", "2"), ("second", "squared")):
                for over in ("/", "per"):
                    found[(word, over, *square)] = ("m/s^2", 1.0)
    for cube in (("m", "^", "3"), ("m", "³"), ("m", "3"), ("cubic", "metre"), ("cubic", "meter")):
        found[("kg", "/", *cube)] = found[("kg", "per", *cube)] = ("kg/m^3", 1.0)
    return found


UNITS = _units()
LONGEST_UNIT = max(map(len, UNITS))
SPELLED = as_set("metre meter centimetre centimeter kilometre kilometer kilogram")  # "a metre above" is one


def stem(word: str) -> str | None:
    """The base form of a verb that is known; None of any other word."""
    if word in IRREGULAR:
        return IRREGULAR[word] if known(IRREGULAR[word]) else None
    for base in _bases(word):
        if known(base):
            return base
    return None


def known(base: str) -> bool:
    """Whether a base form is in one of the lists."""
    return base in MOTIONS or base in CAUSES or base in STATES or base in BEYOND


def _bases(word: str) -> list[str]:
    """What a word may be a form of, by English spelling."""
    found = [word]
    for ending in ("ing", "ed", "es", "s"):
        if not word.endswith(ending) or len(word) <= len(ending) + 1:
            continue
        root = word[: -len(ending)]
        found.append(root)
        if ending in ("ing", "ed"):
            found.append(root + "e")
            if len(root) > 2 and root[-1] == root[-2]:
                found.append(root[:-1])
        if ending in ("ed", "es") and root.endswith("i"):
            found.append(root[:-1] + "y")
    return found
