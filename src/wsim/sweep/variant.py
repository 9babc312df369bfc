"""The programs of a sweep: those that are named, and each of them with each patch applied."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from wsim.errors import UserError
from wsim.program.patch import Edit, PatchError, apply
from wsim.program.unified import edits_of


@contextmanager
def variants(programs: Mapping[str, Path], patches: Sequence[Path]) -> Iterator[dict[Path, str]]:
    """Every program, followed by its patched ones, as files that are there within; each with what it is a patch of.

    A program's file is named as it is to be called in the sweep's folder, a patched one after both:
    `crate+lighter.py` is `crate.py` with `lighter.patch`.

    Args:
        programs: By what they are called, which ends in .py.
        patches: Files, of search/replace blocks or a unified diff; one file makes one program.

    Raises:
        UserError: If a file cannot be read, or a patch does not apply to one of the programs: names file and edit.
    """
    edits = {patch: _edits(patch) for patch in patches}
    with TemporaryDirectory(prefix="wsim-variants-") as scratch:
        found: dict[Path, str] = {}
        for name, program in programs.items():
            own = _free(Path(scratch), name)
            shutil.copyfile(program, own)
            found[own] = ""
            for patch, made in edits.items():
                patched = _free(Path(scratch), f"{own.stem}+{patch.stem}.py")
                patched.write_text(_patched(own, patch, made), encoding="utf-8", newline="")
                found[patched] = own.name
        yield found


def _edits(patch: Path) -> list[Edit]:
    try:
        return edits_of(_read(patch))
    except PatchError as error:
        raise UserError(f"--patch {patch}: {error}") from error


def _patched(program: Path, patch: Path, edits: Sequence[Edit]) -> str:
    text = _read(program)
    try:
        patched = apply(text, edits)
    except PatchError as error:
        raise UserError(f"--patch {patch} does not apply to {program.name}: {error}") from error
    if patched == apply(text, []):
        raise UserError(f"--patch {patch} changes nothing in {program.name}; leave it out")
    return patched


def called(programs: Sequence[tuple[Path, Path]]) -> dict[str, Path]:
    """What each program is called in the sweep's folder: as its file or, where others are called so too, as what was
    named, which may be the folder of a run; where that does not tell them apart either, by number.

    Args:
        programs: What was named, and the program that it means.

    Raises:
        UserError: If a program is named twice.
    """
    files = [program.resolve() for _, program in programs]
    if twice := [program for (_, program), file in zip(programs, files, strict=True) if files.count(file) > 1]:
        raise UserError(f"{twice[0]} is named twice; name it once (--repeats runs each candidate several times)")
    names = [program.name for _, program in programs]
    longer = [
        name if names.count(name) == 1 else f"{target.resolve().name}.py" if target.is_dir() else f"{k:02d}-{name}"
        for k, (name, (target, _)) in enumerate(zip(names, programs, strict=True), start=1)
    ]
    unique = len(set(longer)) == len(longer)
    last = longer if unique else [f"{k:02d}-{name}" for k, name in enumerate(longer, start=1)]
    return {name: program for name, (_, program) in zip(last, programs, strict=True)}


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise UserError(f"{path} cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise UserError(f"{path} is no text in UTF-8 ({error.reason} at byte {error.start})") from error


def _free(folder: Path, name: str) -> Path:
    """A file that is not there yet: patches in two folders may have one name."""
    path, k = folder / name, 2
    while path.exists():
        path, k = folder / f"{Path(name).stem}-{k}.py", k + 1
    return path
