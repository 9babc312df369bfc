"""`wsim assets`: the catalogue, and a user's own models in it."""

from __future__ import annotations

import json as as_json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.table import Table
from rich.text import Text

from wsim.assets import Asset, get, is_own, load_catalogue, unreadable, user_folder
from wsim.assets import search as find
from wsim.assets.catalogue import THUMBNAIL
from wsim.assets.robots import robots
from wsim.assets.sources import sources
from wsim.cli.show import ConsoleProgress, console
from wsim.intake import removal

if TYPE_CHECKING:
    from wsim.intake.robots import TakenIn

Json = Annotated[bool, typer.Option("--json", help="Print it as JSON.")]
Id = Annotated[str, typer.Argument(metavar="ID", help="The asset's id; `wsim assets list` has them.")]

assets = typer.Typer(add_completion=False, pretty_exceptions_enable=False, no_args_is_help=True)


@assets.callback()
def about() -> None:
    """List, find and show the assets that worlds are furnished with, and add your own models.

    Your own lie in $WSIM_ASSETS, else in $XDG_DATA_HOME/wsim/assets. Planners and programs know them at once.
    """


@assets.command("add")
def add_(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="GLB, glTF, OBJ, STL, PLY, USD, URDF or MJCF.")],
    name: Annotated[str, typer.Option("--name", help="What people call it; its id is made of this.")],
    height: Annotated[float | None, typer.Option("--height", help="How high it is to be [m].")] = None,
    unit: Annotated[str | None, typer.Option("--unit", help="Length unit of the file: m, cm, mm, in, ft.")] = None,
    up: Annotated[str | None, typer.Option("--up", help="Axis of the file that points up: y, z, -z, …")] = None,
    forward: Annotated[
        str | None, typer.Option("--forward", help="Axis of the file that its front faces: +x, -y, …")
    ] = None,
    density: Annotated[float | None, typer.Option("--density", help="[kg/m^3]; 700 if nothing is said.")] = None,
    mass: Annotated[float | None, typer.Option("--mass", help="[kg], in place of a density.")] = None,
    friction: Annotated[float, typer.Option("--friction", help="Coefficient of friction.")] = 0.5,
    category: Annotated[str | None, typer.Option("--category", help="Such as furniture/chair.")] = None,
    synonyms: Annotated[str, typer.Option("--synonyms", help="Other names, with commas between.")] = "",
    description: Annotated[str | None, typer.Option("--description", help="A sentence for people.")] = None,
    license: Annotated[str, typer.Option("--license", help="SPDX identifier of its licence.")] = "NOASSERTION",
    threshold: Annotated[
        float | None,
        typer.Option("--threshold", help="How far convex parts may differ from it [m]; smaller: more parts. 0.01."),
    ] = None,
    replace: Annotated[bool, typer.Option("--replace", help="Take the place of your own of that name.")] = False,
    json: Json = False,
) -> None:
    """Make a file of yours an asset: turned, scaled, mended, weighed, with colliders that keep hollows open."""
    from wsim.intake import Placing, Wanted, add  # with readers, the camera and Newton: seconds

    wanted = Wanted(
        name=name, placing=Placing(up, forward, height, unit), density=density, mass=mass, category=category,
        synonyms=[each.strip() for each in synonyms.split(",") if each.strip()], description=description,
        license=license, friction=friction, threshold=threshold, replace=replace,
    )  # fmt: skip
    if json:
        _print(_row(add(file, wanted)))
        return
    with ConsoleProgress() as progress:
        asset = add(file, wanted, progress)
    _show(asset)
    first = next(iter(find(asset.names[0], limit=1)), None)
    if first is not None and first.asset.id != asset.id:
        console.print(
            f"note: {asset.names[0]!r} is found as {first.asset.id} first; name it more exactly, or by its id"
        )


@assets.command("robot")
def robot(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="URDF, MJCF or USD, with its meshes beside it.")],
    name: Annotated[str, typer.Option("--name", help="What programs call it: scene.robot(..., NAME).")],
    replace: Annotated[bool, typer.Option("--replace", help="Take the place of the robot of that name.")] = False,
    json: Json = False,
) -> None:
    """Take a robot in, with its joints, drives, limits, masses and collision masks, for `scene.robot`."""
    from wsim.intake.robots import take_in  # with MuJoCo

    made = take_in(file, name, replace=replace)
    _show_robot(made, json)


@assets.command("pull")
def pull(
    id: Annotated[str | None, typer.Argument(metavar="ID", help="Of the robot; without one they are listed.")] = None,
    replace: Annotated[
        bool, typer.Option("--replace", help="Take the place of what has its and its policies' names.")
    ] = False,
    json: Json = False,
) -> None:
    """Get a robot that wsim does not ship: its files are fetched by pip, held against a hash, and taken in."""
    if id is None:
        if json:
            _print({each: what.model_dump() for each, what in sources().items()})
            return
        for each, what in sources().items():
            here = "here" if each in robots() else f"`wsim assets pull {each}`"
            said = f"{each}: {what.about} ({what.wheel}, {what.license}); {here}"
            console.print(said, markup=False, soft_wrap=True)
        return
    from wsim.intake.pull import pull as pull_  # with MuJoCo

    _show_robot(pull_(id, replace=replace), json)


@assets.command("policy")
def policy(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Its description, JSON: docs/robots.md.")],
    network: Annotated[Path, typer.Option("--network", help="Its network, ONNX.")],
    name: Annotated[str, typer.Option("--name", help="What programs call it: scene.policy(..., NAME).")],
    replace: Annotated[bool, typer.Option("--replace", help="Take the place of the policy of that name.")] = False,
) -> None:
    """Take a policy in, a network that walks a robot, for `scene.policy`."""
    from wsim.intake.policies import take_in_policy  # with readers and NumPy

    id, spec = take_in_policy(file, network, name, replace=replace)
    said = f"{id}: sees {spec.size} numbers, sets {len(spec.joints)} joints at {spec.rate:g} Hz"
    console.print(said, markup=False, soft_wrap=True)


@assets.command("robots")
def robots_(json: Json = False) -> None:
    """List the robots that programs may place: those of wsim, and those that were taken in."""
    if json:
        _print({id: str(path) for id, path in robots().items()})
        return
    for id, path in robots().items():
        console.print(f"{id}: {path}", markup=False, soft_wrap=True)


@assets.command("list")
def list_(
    own: Annotated[bool, typer.Option("--own", help="Your own only.")] = False,
    json: Json = False,
) -> None:
    """List all assets, and which are your own."""
    chosen = [asset for asset in load_catalogue().values() if not own or is_own(asset)]
    if json:
        _print([_row(asset) for asset in chosen])
        return
    table = Table(show_edge=False, pad_edge=False)
    for column in ("id", "whose", "category", "size [m]", "kg", "hollow"):
        table.add_column(column, overflow="fold")
    for asset in chosen:
        size = " × ".join(f"{v:.3g}" for v in asset.size)
        whose = "own" if is_own(asset) else "wsim"
        cells = (asset.id, whose, asset.category, size, f"{asset.mass:.3g}", "yes" if asset.hollow else "")
        table.add_row(*(Text(cell) for cell in cells))
    console.print(table)
    for name, why in unreadable().items():
        console.print(Text(f"{name}: cannot be read: {why}", style="red"))
    if own and not chosen:
        console.print(f"none of your own in {user_folder()}; `wsim assets add FILE --name NAME` adds one", markup=False)


@assets.command("show")
def show(id: Id, json: Json = False) -> None:
    """Show an asset: size, mass, hollow, and how well what collides stands for what is seen."""
    asset = get(id)
    if json:
        _print(_row(asset))
        return
    _show(asset)


@assets.command("search")
def search(
    words: Annotated[list[str], typer.Argument(metavar="WORDS", help="What people call it.")],
    count: Annotated[int, typer.Option("--count", "-n", min=1, max=50, help="At most so many.")] = 5,
    json: Json = False,
) -> None:
    """Find assets by what people call them, the best first. Exit code 1 if there is none."""
    hits = find(" ".join(words), limit=count)
    if json:
        _print([{"score": hit.score, "matched": hit.matched, **_row(hit.asset)} for hit in hits])
    for hit in hits if not json else ():
        console.print(f"{hit.score:.2f}  {hit.asset.id}  ({hit.matched}): {hit.asset.description}", markup=False)
    if not hits:
        if not json:
            console.print(f"nothing in the catalogue is called {' '.join(words)!r}; add your own, or ask wider")
        raise typer.Exit(1)


@assets.command("remove")
def remove(id: Id) -> None:
    """Remove one of your own assets; those of wsim stay."""
    console.print(f"removed {removal.remove(id)}", soft_wrap=True, markup=False)


def _print(what: Any) -> None:
    print(as_json.dumps(what, indent=2, ensure_ascii=False))


def _show_robot(made: TakenIn, json: bool) -> None:
    """What was read of a robot's file."""
    read = made.robot
    if json:
        _print({
            "id": made.id, "path": str(made.path), "links": [link.name for link in read.links],
            "joints": [joint.name for joint in read.joints], "poses": list(read.poses), "notes": read.notes,
            "mass": sum(link.mass for link in read.links),
        })  # fmt: skip
        return
    driven = [joint.name for joint in read.joints if joint.motor]
    lines = [
        f"{made.id}: {len(read.links)} links, {sum(link.mass for link in read.links):.4g} kg, "
        f"{len(read.joints)} joints, {len(driven)} with a motor",
        f"  joints: {', '.join(joint.name for joint in read.joints) or 'none'}",
        f"  poses: {', '.join(read.poses) or 'its reference pose alone'}",
        *(f"  {note}" for note in read.notes),
        f"  file: {made.path}",
    ]
    for line in lines:
        console.print(line, markup=False, soft_wrap=True)


def _row(asset: Asset) -> dict[str, Any]:
    return {**asset.model_dump(mode="json"), "own": is_own(asset), "path": str(asset.path)}


def _show(asset: Asset) -> None:
    """What a person wants to know of an asset."""
    size = " × ".join(f"{v:.3g}" for v in asset.size)
    lines = [
        f"{asset.id}: {asset.description}",
        f"  size {size} m, mass {asset.mass:.4g} kg, +X is {asset.forward}",
        f"  called {', '.join(asset.names)}; {asset.category}; licence {asset.license}; {asset.source}",
    ]
    if asset.hollow:
        free = " × ".join(f"{v:.3g}" for v in asset.hollow.size)
        lines.append(f"  hollow: {free} m is free inside")
    if asset.collision:
        lines.append(f"  collides as {_collision(asset)}")
    lines += [f"  {note}" for note in asset.notes]
    lines.append(f"  file: {asset.path}")
    picture = asset.path.with_name(THUMBNAIL)
    if picture.is_file():
        lines.append(f"  picture: {picture}")
    for line in lines:
        console.print(line, markup=False, soft_wrap=True)


def _collision(asset: Asset) -> str:
    made = asset.collision
    assert made is not None
    what = {
        "coacd": f"{made.parts} convex parts",
        "hull": "its convex hull",
        "shapes": f"{made.parts} plain and convex shapes",
        "given": f"{made.parts} of its own shapes",
    }
    said = [what.get(made.method, f"a {made.method}")]
    if made.volume_ratio is not None:
        said.append(f"{made.volume_ratio:.3g} of its volume")
    if made.hausdorff is not None:
        said.append(f"surfaces at most {1000 * made.hausdorff:.2g} mm apart")
    if made.hollow_open:
        said.append("open of each hollow: " + ", ".join(f"{100 * each.open:.0f} %" for each in made.hollow_open))
    return ", ".join(said)
