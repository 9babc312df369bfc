"""The skill library: how to write programs, one pattern a folder, and which skills some words call for."""

from wsim.skills.library import Skill, SkillError, skills, skills_folder
from wsim.skills.retrieval import Picked, pick

__all__ = ["Picked", "Skill", "SkillError", "pick", "skills", "skills_folder"]
