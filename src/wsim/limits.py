"""What a world may hold: beyond these a number is a mistake. One table for plans, calls and the check of a stage."""

from __future__ import annotations

MAX_POSITION = 1e4  # [m]
MIN_SIZE = 1e-4  # [m]
MAX_SIZE = 1e3  # [m]
MIN_MASS = 1e-12  # [kg]; MuJoCo takes nothing below 1e-15
MAX_MASS = 1e5  # [kg]
MIN_FORCE = 1e-12  # [N] that a joint breaks at: a tenth of what the least mass weighs
MIN_TORQUE = 1e-16  # [N m]: of that force at the least size
MIN_DENSITY = 1e-3  # [kg/m^3]; hydrogen has 0.09
MAX_DENSITY = 1e5  # [kg/m^3]
MAX_YIELD_STRESS = 1e6  # [Pa], of a fluid; stiff clay has 1e5
MIN_FLOW_INDEX, MAX_FLOW_INDEX = 0.1, 2.0  # n of Herschel and Bulkley: what thins most and thickens most
MAX_FRICTION = 10.0
MAX_SPEED = 1e4  # [m/s]
MAX_SPIN = 1e6  # [deg/s]
MAX_DRIVE_SPEED = 100.0  # [m/s], of a vehicle
MAX_WAY = 1e4  # [m], that a driver follows
MIN_BRAKING = 0.01  # of the brakes' torque: rolling takes about as much
MAX_PATH_SPEED = 100.0  # [m/s], of a kinematic body on its path; faster is a jump
MAX_PATH_SPIN = 100.0  # [rad/s]
MAX_STIFFNESS = 1e9  # [N/m], of a spring
MAX_DAMPING = 1e9  # [N s/m]
FARTHEST = 100.0  # [m] between a spring's ends
MOST_STRETCH = 10.0  # a spring's length, of its rest: rubber bears less, and steel far less
TAUT = 1e-4  # [m]: a rope may be that much shorter than its way, by the rounding of what states it
MAX_KEYS = 10_000  # of a path
MAX_COUNT = 20_000_000  # fluid particles
LEAST_ACROSS = 4  # particles of a fluid across a tank
MAX_DURATION = 3600.0  # [s]
MAX_FRAME_RATE = 1000.0  # [1/s]
MIN_RATE, MAX_RATE = 1e-3, 1e4  # [Hz], of a sensor
MAX_RAYS = 100_000  # of a sensor, in a sample
MAX_PIXELS = 640 * 480  # of a camera that is a sensor
SHORTEST_WAY = 1e-6  # [m] or [deg] between a joint's stops
MIN_TIME_STEP = 1e-5  # [s], of a step that is asked for, or that a spring needs
MAX_TIME_STEP = 1.0  # [s]
MAX_PRIMS = 20_000
MAX_BYTES = 100_000_000
MAX_POINTS = 5_000_000  # vertices of all meshes together
MAX_CORNERS = 10_000  # of one face

NO_BOUND = "needs a max_force: that is where a drive saturates"


def bad_stops(low: float, high: float, unit: str) -> str:
    """What is wrong with the stops of a joint, which starts at 0, said after the field's name; empty if nothing is."""
    if low > high:
        return f"({low:g}, {high:g}) {unit}: the low limit must not lie above the high one; swap them"
    if not low <= 0.0 <= high:
        return f"({low:g}, {high:g}) {unit} must hold 0, where the joint starts"
    if high - low < SHORTEST_WAY:
        return f"({low:g}, {high:g}) {unit} leave it no way to go; use a fixed joint"
    return ""


def bad_time_step(step: float) -> str:
    """What is wrong with an upper bound of the time step [s], said after the field's name."""
    if 0.0 < step < MIN_TIME_STEP:
        return f"{step:g} must be >= {MIN_TIME_STEP:g} s, or 0 for the simulator's choice"
    return "" if step <= MAX_TIME_STEP else f"{step:g} must be <= {MAX_TIME_STEP:g} s"
