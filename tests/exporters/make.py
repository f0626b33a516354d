#!/usr/bin/env python3
"""Packs scenes with the tools of others: files.json lists the files, their originals and the steps.

    apt-get install gltfpack blender npm
    npm install --prefix out/npm @gltf-transform/cli@4.5.1 gltfpack@1.3.0
    python3 tests/exporters/make.py out/npm            all files that these tools can make, beside this script
    python3 tests/exporters/make.py out/npm NAME ...   these

The files are part of the project, so that tests need none of the tools. If a tool is missing, it is named, and its files stay as
they are. Then tests/render/exporters_test.cpp says whether the new files render as their twins do.

Exit 0: all were made. 77: a tool was missing.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
SCENES = HERE.parents[1] / "scenes"


def program(name: str, npm: Path) -> str | None:
    """The path of a tool: `npm:NAME` is from the folder of npm, anything else from the PATH."""
    if not name.startswith("npm:"):
        return shutil.which(name)
    path = npm / "node_modules" / ".bin" / name.removeprefix("npm:")
    return str(path) if path.exists() else None


def make(file: dict, npm: Path) -> str | None:
    """Runs the file's steps one after the other. Returns the name of a missing tool, or None."""
    with tempfile.TemporaryDirectory() as folder:
        source = SCENES / file["twin"]
        for i, step in enumerate(file["steps"]):
            tool = program(step[0], npm)
            if tool is None:
                return step[0]
            target = Path(folder) / f"{i}.glb"
            names = {"IN": str(source), "OUT": str(target)}
            subprocess.run([tool, *(names.get(word, word.replace("HERE", str(HERE))) for word in step[1:])], check=True, stdout=subprocess.DEVNULL)
            source = target
        shutil.copy(source, HERE / file["name"])
    return None


def main() -> int:
    if len(sys.argv) < 2:
        print(__doc__)
        return 2
    npm, wanted = Path(sys.argv[1]), sys.argv[2:]
    files = json.loads((HERE / "files.json").read_text())
    unknown = set(wanted) - {file["name"] for file in files}
    if unknown:
        sys.exit(f"make.py: expected names of files.json, found {', '.join(sorted(unknown))}")
    missing = set()
    for file in files:
        if wanted and file["name"] not in wanted:
            continue
        tool = make(file, npm)
        if tool:
            missing.add(tool)
        else:
            print(f"{file['name']}: {(HERE / file['name']).stat().st_size} bytes")
    for tool in sorted(missing):
        print(f"{tool}: not there; its files stay as they are")
    return 77 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
