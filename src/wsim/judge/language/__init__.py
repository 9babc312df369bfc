"""The language of objectives: signal temporal logic over what a recording shows.

One tree has three forms: a plan's JSON (`wsim.plan.schema.formula`), a sentence (`parse`, `sentence`) and Python
(`wsim.judge.language.python`). `evaluate` puts it to `Signals`, of one recording or of many worlds at once.
docs/objectives.md has every operator and predicate.
"""

from wsim.judge.language.evaluate import Outcome, evaluate
from wsim.judge.language.objective import ObjectiveCheck
from wsim.judge.language.sentence import from_json, parse, sentence
from wsim.judge.language.signals import Signals

__all__ = ["ObjectiveCheck", "Outcome", "Signals", "evaluate", "from_json", "parse", "sentence"]
