#!/usr/bin/env python3
"""Checks that no two types of one name can meet in a program: C++ takes them for one, and no compiler says so.

  python3 tests/names.py           looks at the sources of libcore, preprocess and render, and tests itself

Types in headers have unique names, and so have those of source files outside unnamed namespaces.
"""

from __future__ import annotations

import re
import tempfile
import unittest
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ("libcore", "preprocess", "render")

NAMESPACE = re.compile(r"^namespace(?: ([\w:]+))? \{$")
END = re.compile(r"^\}  // namespace(?: ([\w:]+))?$")
TYPE = re.compile(r"^(?:struct|class|enum|enum class)(?: alignas\(\d+\))? (\w+)(?: final)?(?: :[^:].*)? \{")


def types(text: str) -> list[str]:
    """Types with their namespaces, if those of other files may meet them; types inside types are indented."""
    inside: list[str] = []
    found = []
    for line in text.splitlines():
        if m := NAMESPACE.match(line):
            inside.append(m[1] or "")
        elif END.match(line) and inside:
            inside.pop()
        elif (m := TYPE.match(line)) and "" not in inside:
            found.append("::".join([*inside, m[1]]))
    return found


def meetings(root: Path) -> dict[str, list[str]]:
    files = defaultdict(list)
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                for name in types(path.read_text()):
                    files[name].append(str(path.relative_to(root)))
    return {name: where for name, where in files.items() if len(where) > 1}


class Names(unittest.TestCase):
    def test_each_type_has_one(self) -> None:
        self.assertEqual(meetings(ROOT), {})
        self.assertGreater(len(types((ROOT / "libcore/bidir/path.h").read_text())), 0, "none was found")

    def test_two_of_a_name_are_found(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "render").mkdir()
            hidden = "namespace lacuna {\n\nnamespace {\n\nstruct B {\n};\n\n}  // namespace\n\n}  // namespace lacuna\n"
            (root / "render/a.h").write_text("namespace lacuna {\n\nstruct A {\n    struct B {\n    };\n};\n\n}  // namespace lacuna\n")
            (root / "render/b.cpp").write_text("namespace lacuna {\n\nenum class A : int {\n};\n\n}  // namespace lacuna\n")
            (root / "render/c.cpp").write_text(hidden)
            (root / "render/d.cpp").write_text(hidden)
            self.assertEqual(meetings(root), {"lacuna::A": ["render/a.h", "render/b.cpp"]})


if __name__ == "__main__":
    unittest.main()
