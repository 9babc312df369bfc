"""What a prompt asks for: the plan, its relations turned into poses, and the builtin planner."""

from wsim.plan.schema import Plan
from wsim.plan.store import load, save

__all__ = ["Plan", "load", "save"]
