"""The skill library: how to write programs, one pattern a folder, and which skills some words call for."""

from wsim.skills.library import Skill, SkillError, skills, skills_folder
from wsim.skills.retrieval import Picked, for_finding, pick

__all__ = ["Picked", "Skill", "SkillError", "for_finding", "pick", "skills", "skills_folder"]
