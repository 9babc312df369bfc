"""What a plan may say and nothing in wsim does yet: said to who wrote it, rather than passed over in silence."""

from __future__ import annotations

from wsim.plan.schema import Plan


def unheeded(plan: Plan) -> list[str]:
    """A line for each thing that the plan asks for and that no run will have."""
    found = [f"sensor {one.name}: nothing measures it; the recording has how all bodies move" for one in plan.sensors]
    if not plan.outputs.video:
        found.append("outputs.video: a video is made unless the run is told --no-pictures")
    if plan.outputs.stills:
        found.append(f"outputs.stills: {', '.join(plan.outputs.stills)}: every camera takes stills")
    if plan.simulation.device != "auto":
        found.append(f"simulation.device: {plan.simulation.device}: the run's --device decides")
    return found
