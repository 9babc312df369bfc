"""Where a stage's files lie: every layer and asset it names must be inside the folders it may read.

A layer is read alone, without composing it, so that nothing outside is opened to find out that it is outside.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from pxr import Sdf, Tf, UsdUtils

from wsim.scene.errors import one_line

LAYER_SUFFIXES = (".usd", ".usda", ".usdc")
_MAX_LAYERS = 1000


def check_assets(path: Path, roots: Sequence[Path]) -> list[str]:
    """Problems of the files that the stage at `path` names, directly or through its layers; empty if all is well.

    Args:
        path: The stage.
        roots: Folders that its sublayers, references, payloads and textures may lie in.
    """
    allowed = [root.resolve() for root in roots]
    problems: list[str] = []
    waiting, seen = [path.resolve()], {path.resolve()}
    while waiting:
        layer_path = waiting.pop()
        if len(seen) > _MAX_LAYERS:
            return [*problems, f"{path.name}: more than {_MAX_LAYERS} layers"]
        try:
            layer = Sdf.Layer.OpenAsAnonymous(str(layer_path))  # as it is on disk, whatever is open elsewhere
        except Tf.ErrorException as error:
            return [*problems, f"{layer_path.name}: not a USD layer: {one_line(error)}"]
        if layer is None:
            return [*problems, f"{layer_path.name}: not a USD layer"]
        problems += [f"{layer_path.name}: {problem}" for problem in _forbidden(layer)]
        composed = set(layer.GetCompositionAssetDependencies())
        for asset in sorted(_asset_paths(layer)):
            found = _locate(asset, layer_path)
            if isinstance(found, str):
                problems.append(f"{layer_path.name}: @{asset}@ {found}")
            elif not any(found.is_relative_to(root) for root in allowed):
                problems.append(f"{layer_path.name}: @{asset}@ lies outside the folders that a stage may read")
            elif asset in composed and found.suffix.lower() not in LAYER_SUFFIXES:
                problems.append(f"{layer_path.name}: @{asset}@ must end in one of {', '.join(LAYER_SUFFIXES)}")
            elif not found.is_file():
                problems.append(f"{layer_path.name}: @{asset}@ is not there")
            elif found.suffix.lower() in LAYER_SUFFIXES and found not in seen:
                seen.add(found)
                waiting.append(found)
    return problems


def _asset_paths(layer: Sdf.Layer) -> set[str]:
    """Every asset path in a layer: composition arcs, attributes, metadata, in all variants."""
    found: set[str] = set()

    def note(asset: str) -> str:
        found.add(asset)
        return asset

    UsdUtils.ModifyAssetPaths(layer, note)
    found.update(layer.GetCompositionAssetDependencies())
    found.discard("")
    return found


def _locate(asset: str, layer: Path) -> Path | str:
    """The file that an asset path in a layer means, or what is wrong with it."""
    if "://" in asset or asset.startswith(("//", "\\\\")):
        return "is not a file of this machine; copy it next to the stage"
    if "`" in asset or "${" in asset:
        return "is an expression; write the path itself"
    if "[" in asset or asset.lower().endswith(".usdz"):
        return "is in a package; unpack it next to the stage"
    if ":SDF_FORMAT_ARGS:" in asset:
        return "carries file format arguments; leave them out"
    path = Path(asset.replace("<UDIM>", "1001"))
    return (path if path.is_absolute() else layer.parent / path).resolve()


def _forbidden(layer: Sdf.Layer) -> Iterator[str]:
    """Things that load files in ways that are not followed here."""
    found: list[str] = []

    def visit(path: Sdf.Path) -> None:
        spec = layer.GetObjectAtPath(path)
        if isinstance(spec, Sdf.PrimSpec) and spec.HasInfo("clips"):
            found.append(f"{path}: value clips are not supported; author time samples instead")

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    yield from found
