"""A stage, simulated: rigid bodies and fluid stepped together, frame by frame, and recorded."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import ExitStack
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any

import newton
import numpy as np
import warp as wp

from wsim.errors import UserError
from wsim.forks import uncollected
from wsim.phases import Phases
from wsim.progress import Progress, silent
from wsim.recording import RecordingWriter
from wsim.scene.world import World
from wsim.sim import compiling
from wsim.sim.alike import paths_of
from wsim.sim.cameras import CameraRenderer
from wsim.sim.devices import pick_device, steps_in_c
from wsim.sim.entering import entered
from wsim.sim.events import Events
from wsim.sim.fluid_method import method_of, solids_of
from wsim.sim.framing.frame import write_views
from wsim.sim.framing.motion import MotionLog
from wsim.sim.joint_paths import JointPathController
from wsim.sim.measure import measure
from wsim.sim.model import build_batch, build_model
from wsim.sim.perturb import perturb
from wsim.sim.pictures import Film, Pictures
from wsim.sim.policies import controller_of, launch_all
from wsim.sim.result import SimulationResult
from wsim.sim.rigid import RigidBodies
from wsim.sim.rope_ways import lost_ropes
from wsim.sim.sensors import Sensors, sees
from wsim.sim.starts import start
from wsim.sim.turns import Controller, Turns
from wsim.sim.walked import walked
from wsim.solvers.solver_sph import SolverSPH


class Simulation:
    """Newton simulation of a stage.

    Args:
        stage: USD file, which is checked as `wsim run` checks it (`wsim.scene.check`). Several, of one topology
            (`wsim.sim.alike`), are a batch of as many worlds.
        device: "cpu", "cuda:0", or "auto": what is quicker for this world (`wsim.sim.devices`).
        world_count: Copies of one stage simulated at once.
        time_step: Upper bound of the step [s]; chosen from the stage by default.
        controller: Called every `control_interval` seconds.
        control_interval: Time between calls [s]; rounded to whole steps.
        progress: Told about compilation.
        seeds: One for each world, which then starts a little off what the stage states (`wsim.sim.perturb`); 0 does
            not. By default none does.
        worlds: What `wsim.scene.describe` read from the stages, where they were checked and read already.
        skeletons: Of several stages (`wsim.scene.skeleton`), where they are known.
        processes: That several stages are read in.
        draws: Whether pictures will be taken: their kernels are then compiled beside those of a step.

    Attributes:
        world: What the stage states, the first one of several.
        model: The Newton model.
        state: The present state.
        control: Joint targets and forces.
        sensors: What sensors told last.
        time: Simulated time [s].
        compiled: Seconds that each module took that was compiled for it, by name [s].
    """

    def __init__(
        self,
        stage: str | Path | Sequence[str | Path],
        device: str = "auto",
        world_count: int = 1,
        time_step: float | None = None,
        controller: Controller | None = None,
        control_interval: float = 0.01,
        progress: Progress = silent,
        seeds: Sequence[int] = (),
        worlds: Sequence[World] = (),
        skeletons: Sequence[str] = (),
        processes: int = 1,
        draws: bool = False,
    ) -> None:
        stages = paths_of(stage)
        if not isinstance(world_count, int | np.integer) or world_count < 1:
            raise UserError(f"world_count = {world_count!r}: give a whole number from 1")
        if len(stages) > 1 and world_count != 1:
            raise ValueError(f"world_count={world_count}: {len(stages)} stages are as many worlds; leave it out")
        world_count = max(world_count, len(stages))
        if seeds and len(seeds) != world_count:
            raise ValueError(f"seeds: {len(seeds)} were given for {world_count} worlds; give one for each")
        progress("compiling kernels", 0, 3)
        self.stage = stages[0]
        described = entered(stages, worlds)
        self.device = wp.get_device(pick_device(device, described[0], world_count, progress))
        self._draws = draws
        self.compiled = compiling.compile_first(
            self.device, described[0], steps_in_c(self.device, world_count), draws or sees(described[0]), progress
        )
        if len(stages) > 1:
            self.built = build_batch(stages, described, self.device, time_step, processes, skeletons, progress)
        else:
            self.built = build_model(self.stage, described[0], self.device, world_count, time_step)
        self.world: World = self.built.world
        self.model = self.built.model
        self.dt, self.substeps = self.built.time_step.dt, self.built.time_step.substeps
        self.time, self.step_count = 0.0, 0
        progress("compiling kernels", 1, 3)
        self.rigid = (
            RigidBodies(
                self.model,
                self.built.worlds,
                self.dt,
                controller is not None or bool(self.world.policies or self.world.joint_paths or self.world.reaches),
                self.built.breakable,
                self.built.surfaces,
                self.built.cylinders,
            )
            if self.model.body_count
            else None
        )
        self.fluid = self._make_fluid()
        self.state, self.control = self.model.state(), self.model.control()
        perturb(self.built, self.state, seeds)
        newton.eval_fk(self.model, self.state.joint_q, self.state.joint_qd, self.state)
        start(self.model, self.built.worlds, self.built.bodies, self.state)
        self.control_force = wp.zeros_like(self.state.body_f) if self.rigid else None
        if self.rigid and self.rigid.ledger and controller is not None:
            self.rigid.ledger.control = self.control_force
        self.sensors = Sensors(self.built, self.dt, seeds, wanted=controller is not None)
        self._steered, self._turns = controller is not None, Turns(self.dt)
        self.policies = [
            controller_of(walked(self.model, self.built.worlds, self.built.bodies, k), self.device)
            for k in range(len(self.world.policies))
        ]
        for policy in self.policies:
            self._turns.add(policy, policy.interval)
        if self.world.joint_paths or self.world.reaches:
            schedules = JointPathController(self.model, self.built.worlds, self.dt)
            self._turns.add(schedules, schedules.interval)
        if controller is not None:  # after these: it sees what they set
            self._turns.add(controller, control_interval)
        self._graphs: dict[int, Any] = {}  # by how many steps they are
        self._asked: tuple[Any, ...] = ()
        self._warm_up(progress)
        # What a batch of bodies costs on a CPU is the launches of its kernels, a few hundred a step. In C there are
        # none; and whether a fluid on a CPU sorts its particles anew is asked step by step.
        self._replays = not (self.device.is_cuda or self.fluid) and self.rigid is not None and not self.rigid.on_c
        progress("compiling kernels", 3, 3)

    @property
    def controlled(self) -> bool:
        """Whether a controller, a policy, a schedule or a reach drives joints."""
        return bool(self._turns)

    def _warm_up(self, progress: Progress) -> None:
        """Compile every kernel of a step, on a state that is thrown away."""
        kept, self.state = self.state, self.model.state()
        self.state.assign(kept)
        launched = self._launched()
        self.compiled |= compiling.compile_all(launched, self.device, progress)
        if self.device.is_cuda:
            compiling.load_all(launched, self.device)
        self.state.assign(kept)
        self._forget()  # copies are made in a rehearsal, and what they are of was not computed
        self._push_and_move()
        self.state = kept
        self._forget()
        wp.synchronize_device(self.device)

    def _forget(self) -> None:
        """Forget the steps taken so far: the state is where the next one starts."""
        if self.rigid:
            self.rigid.reset(self.state)
        if self.fluid:
            self.fluid.restart()

    def _launched(self) -> list[compiling.Needed]:
        """What a step launches, and a picture; MuJoCo's C code is left out, which keeps what it is given."""
        kept = self.fluid
        self.fluid = self._make_fluid()  # of the other one the order of its particles would stay
        if self.rigid is None or not self.rigid.on_c:
            needed = compiling.rehearse(self._push_and_move)
        else:
            needed = compiling.rehearse(self._push_and_flow)
        needed += compiling.rehearse(self._follow)
        needed += compiling.rehearse(lambda: launch_all(self.policies, self))
        if self._draws:
            needed += compiling.rehearse(lambda: CameraRenderer(self.model, self.world))
        self.fluid = kept
        return needed

    def _make_fluid(self) -> SolverSPH | None:
        built = self.built
        if not built.sph:
            return None
        try:
            return SolverSPH(self.model, built.sph, built.containers, built.taps, built.drains, built.vessels)
        except ValueError as error:  # what no check of a stage foresaw: the world's fault, and its one line says which
            raise UserError(str(error)) from error

    def step(self) -> None:
        """Advance by one time step: the fluid pushes the bodies, then the bodies move."""
        self._follow()
        self._until_control()
        if self._replays:
            wp.capture_launch(self._captured(1))
        else:
            self._push_and_move()
        self._count(1)

    def _follow(self) -> None:
        """Where a frame begins, let what stands still be there for the fluid until the next one does."""
        begins = self.step_count % self.substeps == 0
        if self.fluid and begins and self.fluid.follow(self.state, self.substeps * self.dt):
            self._graphs.clear()

    def _push_and_move(self) -> None:
        self._push_and_flow()
        if self.rigid:
            self.rigid.step(self.state, self.state, self.control, self.dt)

    def _push_and_flow(self) -> None:
        self.state.clear_forces()
        if self._steered and self.control_force is not None:
            wp.copy(self.state.body_f, self.control_force)
        if self.fluid:
            self.fluid.step(self.state, self.state, self.control, None, self.dt)

    def advance_frame(self) -> None:
        """Advance by one recorded frame.

        On CUDA its steps are captured in a graph once and replayed; with a controller or sensors, those between two of
        their turns. So are those in C taken in one go that are the solver's alone.
        """
        alone = self.rigid if self.rigid and self.rigid.alone and not self.fluid else None
        if not alone and not self.device.is_cuda:
            for _ in range(self.substeps):
                self.step()
            return
        left = self.substeps
        self._follow()
        while left:
            steps = min(left, self._until_control())
            if alone:
                self._push_and_flow()
                alone.steps(self.state, self.control, self.dt, steps)
            else:
                wp.capture_launch(self._captured(steps))
            self._count(steps)
            left -= steps

    def _until_control(self) -> int:
        """Steps until a sensor is read or a controller asked again; those are whose turn is now, sensors first."""
        return min([self.substeps, *(each.ask(self.step_count, self) for each in (self.sensors, self._turns) if each)])

    def _count(self, steps: int) -> None:
        self.step_count += steps
        self.time = self.step_count * self.dt

    def _captured(self, steps: int) -> Any:
        """A graph of some steps as they are asked for now."""
        asked = (self.state, self.control, self.dt, self._steered)
        if self._asked != asked:
            self._graphs.clear()
            self._asked = asked
        if steps not in self._graphs:
            with uncollected(), wp.ScopedCapture(self.device) as capture:  # garbage of another graph gives memory back
                for _ in range(steps):
                    self._push_and_move()
            self._graphs[steps] = capture.graph
        return self._graphs[steps]

    def problems(self) -> list[str]:
        """What went wrong so far: non-finite states, buffer overflows, solver warnings."""
        found = self.rigid.problems() if self.rigid else []
        if self.fluid:
            found += filter(None, self.fluid.faults(self.state))
        arrays = {"body_q": self.state.body_q, "body_qd": self.state.body_qd, "particle_q": self.state.particle_q}
        for name, array in arrays.items():
            if array is not None and not np.isfinite(array.numpy()).all():
                found.append(f"{name} is not finite")
                found += self.rigid.beyond_precision() if self.rigid and name == "body_q" else []
        if self.world.ropes and not found:
            found += lost_ropes(self.world, self.built.bodies, self.model, self.state.body_q.numpy())
        return found

    def run(
        self,
        recording: str | Path,
        video: str | Path | None = None,
        frames_dir: str | Path | None = None,
        review: str | Path | None = None,
        metadata: dict[str, Any] | None = None,
        progress: Progress = silent,
        named: Sequence[str] = (),
        words: str | None = None,
    ) -> SimulationResult:
        """Simulate the stage's duration and record it.

        A run that breaks ends early; what happened until then is recorded, and the problems are in its log.

        Args:
            recording: Path of the `.rrd`.
            video: Path of an MP4 of the first camera; None renders nothing.
            frames_dir: Folder for a few still pictures of every camera, of the moments when something happens.
            review: JSON file of what those pictures show: each object's share of them.
            metadata: Kept in the recording beside the simulator's own.
            progress: Told after each frame.
            named: Names of the objects that the run is about, which its cameras are to show; none: what moves.
            words: A line below the video's pictures, after their time; None: there is none.
        """
        started = time.perf_counter()
        frames = round(self.world.duration * self.world.frame_rate)
        problems: list[str] = []
        phases = Phases()
        if self.rigid:
            self.rigid.keep_contacts()
            self._graphs.clear()  # a step sums them from here on
        with ExitStack() as stack:
            stack.enter_context(phases.phase("record"))
            writer = stack.enter_context(RecordingWriter(recording, self.world, {**(metadata or {}), **self.facts()}))
            pictures = None
            if video:
                with phases.phase("prepare the camera"):
                    again = partial(build_model, self.stage, self.world, self.device, 1, self.dt)
                    film = Film(Path(video), frames_dir, review, named, words)
                    drawn = Pictures(self.world, self.built, again, writer, film, progress, phases)
                pictures = stack.enter_context(drawn)
            writer.log(0.0, "INFO", self._summary())
            events = Events(self.built, self.fluid)
            self.sensors.tell(writer.sample)
            moved = MotionLog()
            for frame in range(frames + 1):
                with phases.phase("simulate"):
                    if frame:
                        self.advance_frame()
                    problems = self.problems()
                measured = measure(self.built, self.state, self.rigid, self.fluid)
                writer.frame(self.time, measured)
                moved.add(self.time, measured)
                for prim, text in events.breakages(measured.scalars):
                    writer.log(self.time, "INFO", text, prim)
                if pictures and not problems:
                    pictures.keep(self.time, self.state)
                progress("simulating", frame, frames)
                for prim, text in events.departures(self.state):
                    writer.log(self.time, "WARN", text, prim)
                for problem in problems:
                    writer.log(self.time, "ERROR", problem)
                if problems:
                    break
            if self.sensors and not problems:
                self.sensors.ask(self.step_count, self)  # whose turn is at the end
            if self.fluid:
                writer.solids(solids_of(self.built, self.fluid, 0))
            motion = moved.motion()
            pictures.draw(motion) if pictures else write_views(writer, self.world, motion, named)
            if problems:
                writer.close(complete=False, error="; ".join(problems))
        return SimulationResult(
            problems=problems,
            frames=frame + 1,
            steps=self.step_count,
            dt=self.dt,
            wall_seconds=time.perf_counter() - started,
            particles=self.model.particle_count,
            boundary_particles=self.fluid.boundary_count if self.fluid else 0,
            device=str(self.device),
            stills=pictures.stills if pictures else [],
            seconds=phases.rounded(),
            compiled=self.compiled,
        )

    def facts(self) -> dict[str, Any]:
        """Numbers of the run that the recording keeps."""
        return {
            "device": str(self.device),
            "world_count": max(1, self.model.world_count),
            "time_step": self.dt,
            "loose_order": 2,  # of the steps of bodies that gravity and contacts alone move
            "time_step_reason": self.built.time_step.reason,
            "particles": self.model.particle_count,
            "controlled": self.controlled,
            "steered": self._steered,  # by the program's own control
            "speed_of_sound": self.built.sph.speed_of_sound if self.built.sph else None,
            "sph": method_of(self.built, self.fluid, 0) if self.fluid else None,
            "versions": {name: version(name) for name in ("newton", "warp-lang", "mujoco", "usd-core")},
        }

    def _summary(self) -> str:
        counts = f"{len(self.world.bodies)} bodies, {self.model.particle_count} fluid particles"
        steps = f"{self.substeps} steps of {self.dt * 1e3:.3f} ms a frame (limited by {self.built.time_step.reason})"
        return f"{counts}, {steps}, on {self.device}"
