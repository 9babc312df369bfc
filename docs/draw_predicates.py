"""Draw the pictures of predicates.md, every row as the layout solves it, and write its tables of rows.

    pip install 'wsim[plots]'
    python docs/draw_predicates.py

One sheet a group, into docs/images/predicates; the tables from `wsim.plan.schema.predicates`. The reference is grey,
the object that has the row is orange; an arrow is an object's +X. Top views look down with +X up and +Y to the left;
side views look along +Y or -X.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.patches import FancyArrow, Polygon

from wsim.plan.layout import layout
from wsim.plan.layout.bodies import convex, local_size, solids
from wsim.plan.layout.boxes import turned, union
from wsim.plan.schema import PREDICATES, CameraPlan, External, Material, Plan, PlanObject, Pose, Proxy, Region, Relation

PAGE = Path(__file__).parent / "predicates.md"
INTO = Path(__file__).parent / "images" / "predicates"
SECTIONS = {
    "Position": ("side", "alignment", "support", "size"), "Orientation": ("orientation", "posture"),
    "Fluid": ("fluid",), "Grouping": ("group",), "Templates": ("template",),
}  # fmt: skip
TESTED = "[test_a_layout_keeps_it](../tests/plan/test_predicate_table.py)"  # of each row that has no test of its own
WOOD = Material(name="wood", density=600.0)
REF, OWN, REST, FLUID = "#b8bcc4", "#f0913a", "#d9dce1", "#a7d3f0"


@dataclass
class Example:
    """A plan that shows one row, and from where it is looked at."""

    name: str
    objects: list[PlanObject]
    view: str = "top"  # or "side", along +Y, or "end", along -X
    note: str = ""
    camera: str | None = None


def row(predicate: str, ref: str | None = None, **arguments: object) -> Relation:
    """A row."""
    return Relation(predicate=predicate, ref=ref, **arguments)


def box(name: str, *rows: Relation, size: tuple[float, ...] = (0.3, 0.2, 0.2), at: tuple | None = None, yaw=0.0):
    """A box, with a pose where `at` is given."""
    pose = Pose(position=at, rotation_deg=(0.0, 0.0, yaw)) if at is not None else None
    return PlanObject.proxy(
        name=name, role="rigid_body", primitive="box", size=size, material=WOOD, relations=list(rows), pose=pose
    )


A = box("ref", size=(0.4, 0.6, 0.3), at=(0.0, 0.0, 0.15))
TABLE = box("ref", size=(0.8, 0.6, 0.4), at=(0.0, 0.0, 0.2))
TANK = PlanObject.proxy(
    name="tank", role="container", primitive="tank", size=(1.0, 0.6, 0.5), state="static", relations=[]
)


def water(*rows: Relation) -> PlanObject:
    """Water, 0.3 m deep unless rows say else."""
    given = list(rows) or [row("PLACE-IN", "tank"), row("FREE-SURFACE-AT", value=0.3)]
    return PlanObject.proxy(name="water", role="fluid", primitive="fluid", state="fluid", relations=given)


def position() -> list[Example]:
    """Sides, alignments, supports, height."""
    found = [Example(name, [A, box("b", row(name, "ref", gap=0.15))], note="gap 0.15 m")
             for name in ("LEFT-OF", "RIGHT-OF", "FRONT-OF", "BACK-OF")]  # fmt: skip
    for name in ("ALIGN-LEFT", "ALIGN-RIGHT", "ALIGN-CENTER-LR"):
        found.append(
            Example(name, [A, box("b", row(name, "ref"), row("FRONT-OF", "ref", gap=0.15))], note="and FRONT-OF")
        )
    for name in ("ALIGN-FRONT", "ALIGN-BACK", "ALIGN-CENTER-FB"):
        small = box("b", row(name, "ref"), row("LEFT-OF", "ref", gap=0.15), size=(0.2, 0.3, 0.2))
        found.append(Example(name, [A, small], note="and LEFT-OF"))
    pole = PlanObject.proxy(name="b", role="rigid_body", primitive="cylinder", size=(0.1, 0.2), material=WOOD)
    tall = External(candidate="a lamp post", stand_in=Proxy(primitive="cylinder", size=(0.1, 0.2)))
    region = Region(low=(-0.5, -0.4), high=(0.5, 0.4))
    chair = PlanObject.model_validate(
        {"name": "ref", "role": "rigid_body", "construction": {"kind": "asset", "asset": "shelf"}}
    )
    return [
        *found,
        Example("PLACE-ON-BASE", [box("b", row("PLACE-ON-BASE"))], "side"),
        Example("PLACE-ON", [TABLE, box("b", row("PLACE-ON", "ref"))], "side"),
        Example("PLACE-ON", [chair, box("b", row("PLACE-ON", "ref", anchor="shelf_3"), size=(0.2, 0.3, 0.25))], "end",
                "anchor shelf_3"),
        Example("PLACE-IN", [TANK, box("b", row("PLACE-IN", "tank"))], "side"),
        Example("PLACE-ANYWHERE", [box(f"b{k}", row("PLACE-ANYWHERE", region=region)) for k in range(5)], "top",
                "region 1 x 0.8 m"),
        Example("SPAWNED-ABOVE", [TABLE, box("b", row("SPAWNED-ABOVE", "ref", value=0.25))], "side", "value 0.25 m"),
        Example("HEIGHT", [pole.model_copy(update={"name": "ref"}),
                           pole.model_copy(update={"construction": tall}).related(
                               [row("HEIGHT", value=0.6), row("FRONT-OF", "ref", gap=0.2)])], "side", "value 0.6 m"),
    ]  # fmt: skip


def orientation() -> list[Example]:
    """Headings."""
    long = (0.4, 0.2, 0.2)
    found = [Example(name, [box("b", row(name), size=long)])
             for name in ("FACING-FRONT", "FACING-BACK", "FACING-LEFT", "FACING-RIGHT")]  # fmt: skip
    aside = [row("FRONT-OF", "ref", gap=0.2), row("LEFT-OF", "ref", gap=0.1)]
    for name in ("FACING-TO", "FACING-OPPOSITE-TO"):
        found.append(Example(name, [A, box("b", row(name, "ref"), *aside, size=long)]))
    askew = box("ref", size=(0.5, 0.3, 0.2), at=(0.0, 0.0, 0.1), yaw=30.0)
    found.append(
        Example("FACING-SAME-AS", [askew, box("b", row("FACING-SAME-AS", "ref"), row("LEFT-OF", "ref", gap=0.1))])
    )
    found.append(Example("RANDOM-ROT", [box(f"b{k}", row("RANDOM-ROT", range=(-40.0, 40.0)),
                                            *([row("LEFT-OF", f"b{k - 1}", gap=0.1)] if k else [])) for k in range(4)],
                         note="range -40 to 40 deg"))  # fmt: skip
    chairs = [box(f"b{k}", row(side, "ref", gap=0.1), row("ORIENT-BY-RELATIVE-SIDE", "ref"), size=(0.25, 0.2, 0.3))
              for k, side in enumerate(("FRONT-OF", "BACK-OF", "LEFT-OF", "RIGHT-OF"))]  # fmt: skip
    found.append(Example("ORIENT-BY-RELATIVE-SIDE", [A, *chairs]))
    for name in ("LIES-ALONG-X", "LIES-ALONG-Y"):
        log = PlanObject.proxy(name="b", role="rigid_body", primitive="cylinder", size=(0.08, 0.6), material=WOOD,
                               relations=[row(name)])  # fmt: skip
        found.append(Example(name, [log]))
    return found


def fluid() -> list[Example]:
    """Surfaces and what is at them."""
    block = (0.3, 0.2, 0.14)
    return [
        Example("FREE-SURFACE-AT", [TANK, water()], "side", "value 0.3 m"),
        Example("FLOATS-AT-SURFACE", [TANK, water(), box("b", row("FLOATS-AT-SURFACE", "water"), size=block)], "side"),
        Example("SUBMERGED", [TANK, water(), box("b", row("SUBMERGED", "water", value=0.1), size=block)], "side",
                "value 0.1 m, by top"),
        Example("SUBMERGED", [TANK, water(), box("b", row("SUBMERGED", "water", value=0.1, by="center"), size=block)],
                "side", "value 0.1 m, by center"),
        Example("CONTAINS-FLUID", [water(), TANK.related([row("CONTAINS-FLUID", "water")])], "side"),
    ]  # fmt: skip


def grouping() -> list[Example]:
    """Mirrors, groups and copies."""
    member = {"size": (0.2, 0.2, 0.2)}
    group = [box("ref", row("GROUP", group="g", members=["m"]), size=(0.3, 0.5, 0.3)),
             box("m", row("BACK-OF", "ref", gap=0.05), **member)]  # fmt: skip
    mirror = box("axis", size=(0.8, 0.1, 0.2), at=(0.0, 0.0, 0.1), yaw=20.0)
    source = box("ref", size=(0.3, 0.15, 0.2), at=(0.1, 0.4, 0.1), yaw=50.0)
    copy = [box("b", row("COPY-GROUP", group="g", members=["n"]), row("FACING-LEFT"), row("LEFT-OF", "g", gap=0.2),
                size=(0.3, 0.5, 0.3)), box("n", **member)]  # fmt: skip
    return [
        Example(
            "SYMMETRY-ALONG",
            [source, mirror, box("b", row("SYMMETRY-ALONG", "ref", axis="axis"), size=(0.3, 0.15, 0.2))],
        ),
        Example("GROUP", [*group, box("b", row("FRONT-OF", "g", gap=0.15))], note="FRONT-OF the group"),
        Example("COPY-GROUP", [*group, *copy], note="LEFT-OF the group, FACING-LEFT"),
    ]


def composites() -> list[Example]:
    """Templates."""
    small = {"size": (0.2, 0.2, 0.12)}
    tank_low = (0.3, 0.2, 0.14)
    found = [Example(name, [TABLE, box("b", row(name, "ref"), **small)], "side")
             for name in ("spawned_on_top", "placed_on_top", "centered_on_ref")]  # fmt: skip
    for side in ("plus_x", "minus_x", "plus_y", "minus_y"):
        for level in ("top_flush", "bottom_flush", "centers"):
            name = f"adjacent_{side}_{level}"
            found.append(
                Example(name, [A, box("b", row(name, "ref"), **small)], "side" if side.endswith("x") else "end")
            )
    for name in (
        "bottom_flush_water_surface",
        "center_at_water_surface",
        "top_flush_water_surface",
        "floats_at_surface",
    ):
        found.append(Example(name, [TANK, water(), box("b", row(name, "water"), size=tank_low)], "side"))
    for name in ("fills_container_to_top", "fills_container_lower_half"):
        found.append(Example(name, [TANK, water(row(name, "tank"))], "side"))
    piers = [
        box("ref", size=(0.2, 0.4, 0.4), at=(-0.4, 0.0, 0.2)),
        box("other", size=(0.2, 0.4, 0.4), at=(0.4, 0.0, 0.2)),
    ]
    deck = box("b", row("bridge_between_a_and_b", "ref", other="other"), size=(0.1, 0.3, 0.06))
    found.append(Example("bridge_between_a_and_b", [*piers, deck], "side"))
    step = box("b", row("flush_with_platform_top", "ref"), row("FRONT-OF", "ref", gap=0.05), **small)
    found.append(Example("flush_with_platform_top", [A, step], "side", "and FRONT-OF"))
    return found


def cameras() -> list[Example]:
    """Views of a scene, and of a room."""
    things = [box("ref", size=(0.8, 0.5, 0.4), at=(0.0, 0.0, 0.2)), box("b", row("PLACE-ON", "ref"))]
    places = [
        (2.0, 0.0, (0.1, 4.1, 1.6)),
        (-2.0, 0.0, (0.1, 4.1, 1.6)),
        (0.0, 2.0, (4.1, 0.1, 1.6)),
        (0.0, -2.0, (4.1, 0.1, 1.6)),
    ]
    walls = [PlanObject.proxy(name=f"wall_{k}", role="background", primitive="box", size=size, state="static",
                              pose=Pose(position=(x, y, 0.8))) for k, (x, y, size) in enumerate(places)]  # fmt: skip
    found = []
    for suffix in ("", "_room"):
        for view in ("side_plus_x", "side_minus_x", "side_plus_y", "side_minus_y", "top_down"):
            name = view + suffix
            found.append(
                Example(name, things + (walls if suffix else []), "side" if view == "top_down" else "top", "", name)
            )
    return found


GROUPS = {
    "position": position, "orientation": orientation, "fluid": fluid, "grouping": grouping, "templates": composites,
    "cameras": cameras,
}  # fmt: skip


def flat(view: str, x: float, y: float, z: float) -> tuple[float, float]:
    """A point as a picture shows it: across, up."""
    return {"top": (-y, x), "side": (x, z), "end": (-y, z)}[view]


def cut(view: str, solid: object, middle: tuple[float, ...]) -> bool:
    """Whether a picture shows a solid: side views cut through the middle, so that no wall hides what it holds."""
    axis = {"top": 2, "side": 1, "end": 0}[view]
    shown = solid.box()
    return view == "top" or shown.low[axis] <= middle[axis] <= shown.high[axis]


def outline(view: str, solid: object) -> list[tuple[float, float]]:
    """The corners of a solid in a picture."""
    if view == "top" and solid.kind == "box":
        (x, y, _), (dx, dy, _) = solid.center, solid.half
        yaw = math.degrees(math.atan2(solid.axes[1][0], solid.axes[0][0]))
        corners = [turned((a, b), yaw) for a, b in ((dx, dy), (-dx, dy), (-dx, -dy), (dx, -dy))]
        return [flat(view, x + a, y + b, 0.0) for a, b in corners]
    low, high = solid.box().low, solid.box().high
    a, b = flat(view, *low), flat(view, *high)
    return [(a[0], a[1]), (b[0], a[1]), (b[0], b[1]), (a[0], b[1])]


def draw(axes: object, example: Example) -> None:
    """One picture."""
    shots = [CameraPlan(name="camera", view=example.camera)] if example.camera else []
    plan = layout(Plan(title="t", prompt="p", objects=example.objects, cameras=shots))
    boxes = [part for item in plan.objects for part in solids(item)]
    whole = union(boxes)
    ends = [flat(example.view, *whole.low), flat(example.view, *whole.high)]
    for item in plan.objects:
        if item.primitive == "fluid":
            held = plan.object(item.relation("PLACE-IN").ref)
            level, (x, _, z) = item.relation("FREE-SURFACE-AT").value, held.pose.position
            wide = held.size[0] / 2
            axes.add_patch(Polygon([(x - wide, z + 0.02), (x + wide, z + 0.02), (x + wide, z + 0.02 + level),
                                    (x - wide, z + 0.02 + level)], facecolor=FLUID, zorder=1))  # fmt: skip
            continue
        own = any(r.predicate == example.name for r in item.relations) or (example.name == "GROUP" and item.name == "m")
        color = OWN if own else REF if item.role == "rigid_body" or item.role == "container" else REST
        for solid in convex(item):
            if not cut(example.view, solid, whole.center if item.role == "background" else union(solids(item)).center):
                continue
            axes.add_patch(Polygon(outline(example.view, solid), facecolor=color, edgecolor="#444444", linewidth=0.8,
                                   alpha=0.9, zorder=2))  # fmt: skip
        if example.view == "top" and item.role == "rigid_body" and item.primitive == "box":
            arrow(axes, item)
        label(axes, example, item)
    if example.view != "top":
        axes.axhline(0.0, color="#444444", linewidth=0.8, zorder=0)
    if example.name == "PLACE-ANYWHERE":
        axes.add_patch(Polygon([(-0.4, -0.5), (0.4, -0.5), (0.4, 0.5), (-0.4, 0.5)], fill=False, linestyle="--"))
        ends += [(-0.4, -0.5), (0.4, 0.5)]
    if example.camera:
        camera = plan.cameras[0]
        eye, target = flat(example.view, *camera.eye), flat(example.view, *camera.target)
        axes.plot(*zip(eye, target, strict=True), color="#c02020", linewidth=1.0, linestyle="--", zorder=4)
        axes.plot(*eye, marker="o", color="#c02020", zorder=5)
        ends += [eye, target]
    frame(axes, example, ends)


def arrow(axes: object, item: PlanObject) -> None:
    """The object's +X."""
    x, y, _ = item.pose.position
    length = 0.38 * min(local_size(item)[:2])
    dx, dy = turned((length, 0.0), item.pose.rotation_deg[2])
    a, b = flat("top", x, y, 0.0), flat("top", dx, dy, 0.0)
    axes.add_patch(
        FancyArrow(*a, *b, width=0.012, head_width=0.05, length_includes_head=True, color="#222222", zorder=3)
    )


def label(axes: object, example: Example, item: PlanObject) -> None:
    """The name of what is referred to."""
    if item.name in ("ref", "other", "axis", "tank"):
        parts = [corner for solid in convex(item) for corner in outline(example.view, solid)]
        low, high = min(x for x, _ in parts), max(x for x, _ in parts)
        under = min(y for _, y in parts)
        askew = example.view == "top" and item.pose.rotation_deg[2] % 90.0 > 1e-6
        if item.name == "tank":
            place = ((low + high) / 2, under - 0.06)
        elif askew:
            place = ((low + high) / 2, under - 0.05)
        else:
            place = (low + 0.04 + 0.02 * len(item.name), under + 0.05)
        axes.text(*place, item.name, ha="center", va="center", fontsize=7, zorder=6)


def frame(axes: object, example: Example, ends: list[tuple[float, float]]) -> None:
    """Limits, title and axes' names."""
    xs, ys = [e[0] for e in ends], [e[1] for e in ends]
    half = max(max(xs) - min(xs), max(ys) - min(ys), 0.6) / 2 + 0.12
    cx, cy = (max(xs) + min(xs)) / 2, (max(ys) + min(ys)) / 2
    axes.set_xlim(cx - half, cx + half)
    axes.set_ylim(cy - half, cy + half)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_title(example.name, fontsize=8, fontweight="bold")
    how = {"top": "top: +X up, +Y left", "side": "side: +X right, +Z up", "end": "end: +Y left, +Z up"}[example.view]
    axes.set_xlabel(f"{how}\n{example.note}" if example.note else how, fontsize=7)
    for side in axes.spines.values():
        side.set_color("#cccccc")


def tables(page: str) -> str:
    """The page with its tables of rows as the predicates are now; each keeps the test that the page names."""
    tests = dict(re.findall(r"^\| `([^`]+)` \| .* \| (\[test_\w+\]\(\S+\)) \|$", page, re.MULTILINE))
    for title, kinds in SECTIONS.items():
        rows = ""
        for spec in (spec for spec in PREDICATES.values() if spec.kind in kinds):
            arguments = [f"`{name}`" for name in spec.needs] + [f"`{name}`?" for name in spec.takes]
            test = tests.get(spec.name, TESTED)
            rows += f"| `{spec.name}` | {', '.join(arguments) or '–'} | {spec.means} | {test} |\n"
        before, after = page.split(f"\n## {title}\n")
        after = re.sub(r"(\| --- .*\n)(?:\|.*\n)*", lambda head, rows=rows: head[1] + rows, after, count=1)
        page = f"{before}\n## {title}\n{after}"
    return page


def main() -> None:
    """Write the tables and draw all sheets."""
    PAGE.write_text(tables(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    INTO.mkdir(parents=True, exist_ok=True)
    for name, make in GROUPS.items():
        examples = make()
        columns = min(5, len(examples))
        rows = math.ceil(len(examples) / columns)
        figure, grid = plt.subplots(rows, columns, figsize=(2.4 * columns, 3.0 * rows), squeeze=False)
        for k, axes in enumerate(grid.flat):
            if k < len(examples):
                draw(axes, examples[k])
            else:
                axes.set_axis_off()
        figure.tight_layout(h_pad=1.2)
        figure.savefig(INTO / f"{name}.png", dpi=80)
        plt.close(figure)


if __name__ == "__main__":
    main()
