"""The numbers by which the law of contact is applied."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ContactConfig:
    """How the law is applied."""

    impedance: float = 0.9999
    """Share of what is asked for that a contact alone reaches; MuJoCo's largest."""
    solver_tolerance: float = 1e-10
    """MuJoCo's tolerance. Contacts are so hard that their forces are known far worse than the accelerations: at 1e-7
    what they turn a box by that begins to slip is 3.5 % of m g R off, at 1e-9 0.2 %; 1e-10 takes no more time."""
    chain_tolerance: float = 1e-14
    """The same where bodies hang together on joints: of what is left the arms of a chain make torques. Of 37 links over
    three posts, which pull with 4 N, joints passed on 2.7e-4 N m that nothing gives at 1e-10, and 4e-6 at 1e-14, in no
    more time."""
    solver_tolerance_warp: float = 1e-4
    """The same where worlds are batched. What is left of the cost is below this times the trace of M, of some three
    masses for a body: an error of 0.025 m/s^2 at most, and of less than 1e-3 m/s^2 where it was measured; at 1e-3 a log
    in a groove rubbed 1 % too much. At 1e-6 single precision does not end its search."""
    unbalanced: float = 0.02
    """Acceleration of a body that the forces of a step's last solution may leave without a cause, where worlds are
    batched, 0.2 % of g [m/s^2]. Rounding alone leaves 0.1 to 0.4 in a heap of boxes; but MuJoCo Warp ends where one
    turn gains little, also where its search along a line gets stuck: at 0.4 a stack that a ball hits was left with 3.5
    to 5 m/s^2 in every third step, after one turn of two that are needed."""
    unbalanced_in_c: float = 1e-3
    """The same in C, of every solution [m/s^2]: at 1e-10 balls of 1.6 to 6 kg beside a table of 330 kg on a motor were
    pressed by up to 1 % of g less than they weigh, in one step of six."""
    most_factored: int = 3000
    """Degrees of freedom of a world that Newton's method takes where worlds are batched; beyond, conjugate gradients.
    MuJoCo Warp keeps a world's Hessian and its factor whole, 72 MB here, and factors it with one block of threads. But
    contacts are hard: 27 boxes in a heap take Newton's method up to 10 turns and conjugate gradients up to 900, 64
    boxes up to 30 and beyond 3000. On a core of a CPU one of Newton's turns took 17 ms at 384 degrees of freedom and
    0.8 s at 1536, one of the other's 3 ms at 384."""
    most_conjugate: int = 3000
    """Turns of conjugate gradients there at most. MuJoCo's 100 leave 13 to 34 m/s^2 in those 27 boxes, a fall's and
    more; these leave 0.01 in them, and 0.04 in 64."""
    last_turns: int = 25
    """Newton's iterations in the last solution at most. Where boxes tumble over each other Newton's method in double
    precision needs up to 18 from the solution before; ten left 12 to 23 m/s^2 in some steps."""
    reach: float = 0.01
    """Gap at which a contact becomes a row [m]."""
    limit_reach: float = 0.1
    """The same of a joint's stop [rad or m]."""
    settle_time: float = 0.02
    """Time in which overlap fades [s]."""
    settle_speed: float = 0.5
    """Speed at which it fades at most [m/s]."""
    threshold: float = 2 * 9.81
    """A slower approach than this times the step is no blow [m/s^2]: gravity alone makes such speeds in a step."""
    most_blows: int = 100
    """Rounds of blows in a step at most; what still hits then comes to rest on what it hits."""
    blows_unrolled: int = 2
    """The same, always, where CUDA graphs know no loops: see `solutions_unrolled`."""
    solutions: int = 3
    """Solutions of a step after which the slip need only be known roughly."""
    most_solutions: int = 20
    """Solutions of a step at most."""
    solutions_unrolled: int = 6
    """The same, always, where CUDA graphs know no loops: drivers before 12.4."""
    tolerance: float = 3e-4
    """Change of the slip, times friction, below which it stays [m/s]."""
    rough: float = 3e-3
    """The same after `solutions` [m/s]: what is hit would hop by 0.5 um."""
    lasting: float = 1e-6
    """The same of what lasts all the step, in C [m/s]. Where a crate slides on the floor and friction holds its side to
    a ram, an error asks for a lift that the side's friction resists with all that it has, and rows as hard as these
    turn 1e-6 m/s into a hundredth of the crate's weight: at 3e-4 a ram shoved it off at 1 m/s^2 instead of 2."""
    steady: float = 0.5
    """Change of a contact's speed over the step's time that is left to the step, and is no jolt at its start [m/s^2]:
    what it puts a gap off by, in steps of 1.25 ms, is 0.4 um."""
    blow_time: float = 1.25e-3
    """Time that a blow lasts for what may break [s]: that of a rigid world has none. It is the longest step's."""
    smallest_friction: float = 1e-5
    """MuJoCo's least, and ours for none; of rolling and spinning, of a metre, or of the radius where that is less."""
