"""The planted faults: made by the program, by the solver, by what is recorded."""

from benchmarks.judge_worlds.fault import Fault
from benchmarks.judge_worlds.faults.of_fluids import OF_FLUIDS
from benchmarks.judge_worlds.faults.of_joints import OF_JOINTS
from benchmarks.judge_worlds.faults.of_motion import OF_MOTION
from benchmarks.judge_worlds.faults.of_scene import OF_SCENE

FAULTS: tuple[Fault, ...] = (*OF_SCENE, *OF_MOTION, *OF_JOINTS, *OF_FLUIDS)

__all__ = ["FAULTS"]
