"""The house: no two files import each other, and a file imports at its top, or says why not."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import grimp

ROOT = Path(__file__).parents[1]


def circle(imports: dict[str, set[str]]) -> list[str]:
    """Files that import each other, each the one before it; none if there are none."""
    try:
        TopologicalSorter(imports).prepare()
    except CycleError as error:
        return error.args[1]
    return []


def test_no_files_import_each_other():
    """Imports for types alone count: who reads one file must not have to read the other first."""
    graph = grimp.build_graph("wsim")
    imports = {name: set(graph.find_modules_directly_imported_by(name)) for name in graph.modules}
    del imports["wsim"]  # its `run` opens the command line's door, when a program calls it
    assert len(imports) > 300
    assert circle(imports) == []


def test_a_circle_is_found():
    assert circle({"a": {"b"}, "b": {"c"}, "c": set()}) == []
    assert set(circle({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}})) == {"a", "b", "c"}


def unexplained(text: str) -> list[int]:
    """Lines of imports inside functions that have no comment on them, nor on the imports right above them."""
    lines = text.splitlines()
    found = []
    functions = [n for n in ast.walk(ast.parse(text)) if isinstance(n, ast.FunctionDef | ast.AsyncFunctionDef)]
    for node in {each for function in functions for each in ast.walk(function)}:
        if not isinstance(node, ast.Import | ast.ImportFrom):
            continue
        first = node.lineno - 1
        while first > 0 and (lines[first - 1].strip() or "#").startswith(("import ", "from ", "#")):
            first -= 1
        if not any("# " in line for line in lines[first : node.end_lineno]):
            found.append(node.lineno)
    return sorted(found)


def test_an_import_inside_a_function_says_why():
    found = {
        str(path.relative_to(ROOT)): lines
        for path in sorted((ROOT / "src").rglob("*.py"))
        if (lines := unexplained(path.read_text(encoding="utf-8")))
    }
    assert found == {}


def test_an_import_without_a_reason_is_found():
    assert unexplained("def f():\n    import os\n    return os\n") == [2]
    assert unexplained("def f():\n    import os  # slow\n    import re\n    return os, re\n") == []
    assert unexplained("import os\n\n\ndef f():\n    return os\n") == []
