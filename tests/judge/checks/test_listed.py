"""No check is forgotten: what the modules define is what the judge asks."""

import importlib
import inspect
import pkgutil

import wsim.judge.checks
from wsim.judge.checks.check import Check
from wsim.judge.checks.registry import physics_checks, run_checks


def test_every_check_is_asked_once():
    defined = {
        name
        for module in pkgutil.iter_modules(wsim.judge.checks.__path__, "wsim.judge.checks.")
        for name, thing in vars(importlib.import_module(module.name)).items()
        if inspect.isclass(thing)
        and issubclass(thing, Check)
        and not thing.__subclasses__()  # those that others build on ask nothing themselves
        and thing.__module__ == module.name
    }
    asked = [check.name for check in [*run_checks(), *physics_checks()]]
    assert len(defined) > 25
    missing = defined - set(asked)
    assert not missing, f"name {sorted(missing)} in CHECKS of their files"
    assert len(asked) == len(set(asked))
