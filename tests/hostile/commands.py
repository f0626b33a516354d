"""The commands that are attacked, and what must hold for each, whatever happens."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
OLD = b"what was there before"
LONGEST = 10.0  # seconds that a tool may take, on a machine that does nothing else
EXITS = {0, 1, 2, 3, 130}

SIZE = ["--width", "24", "--threads", "2"]
SHORT = [*SIZE, "--iterations", "6"]
TRAINING = [v for s in ("paths=2000", "light_paths=2000", "subspaces=20") for v in ("--set", f"train.{s}")]
SPCBPT = ["--method", "spcbpt", "--set", "light_paths=200", "--set", "candidates=100", *TRAINING]
SKELBPT = ["--method", "skelbpt", "--set", "voxels.resolution=16", "--set", "light_paths=200", "--set", "candidates=64"]
STUDY = {
    "title": "A small one",
    "about": "Nothing stands for anything.",
    "seeds": [1],
    "iterations": 4,
    "threads": 2,
    "baseline": "pt",
    "measures": ["mape"],
    "bounds": {"mape": [0.5]},
    "scenes": [{"name": "box", "file": "scene.glb", "options": {"width": 24}, "reference": "reference.exr"}],
    "methods": [{"method": "pt"}, {"method": "bpt"}],
}


@dataclass(frozen=True)
class Command:
    """A command line of one of the tools, run in a folder of its own."""

    name: str
    tool: str
    arguments: list[str]
    outputs: list[str]  # files; each is there before, with other content
    caches: bool = False  # whether those that it needs are there


COMMANDS = [
    Command("render", "lacuna-render",
            ["scene.glb", *SPCBPT, *SHORT, "--prepare", "-o", "out.exr", "--json", "out.json", "--log", "curve.csv",
             "--reference", "reference.exr", "--sheet", "sheet.png"],
            ["out.exr", "out.json", "curve.csv", "sheet.png"]),
    Command("render cached", "lacuna-render",
            ["scene.glb", *SKELBPT, *SHORT, "-o", "out.png", "--json", "out.json"], ["out.png", "out.json"], caches=True),
    Command("render checkpoints", "lacuna-render",
            ["scene.glb", "--method", "bpt", *SHORT, "--block-iterations", "2", "--checkpoint", "saved",
             "--checkpoint-every", "0.001s", "--write-every", "0.001s", "-o", "out.exr"], ["out.exr"]),
    Command("render auto", "lacuna-render", ["scene.glb", *SHORT, "-o", "out.pfm"], ["out.pfm"]),
    Command("render part", "lacuna-render",
            ["scene.glb", "--method", "bpt", *SHORT, "--block-iterations", "2", "--blocks", "1,3", "-o", "out.exr"], ["out.exr"]),
    Command("merge", "lacuna-merge", ["part0.exr", "part1.exr", "-o", "out.exr", "--json", "out.json"], ["out.exr", "out.json"]),
    Command("relight", "lacuna-relight",
            ["groups.exr", "-o", "out.exr", "--light", "environment=2", "--json", "out.json"], ["out.exr", "out.json"]),
    Command("compare", "lacuna-compare",
            ["reference.exr", "part0.exr", "--error-map", "map.png", "--json", "out.json"], ["map.png", "out.json"]),
    Command("voxelize", "lacuna-voxelize", ["scene.glb", "--resolution", "16", "-o", "out.vdb", "--json", "out.json"],
            ["out.vdb", "out.json"]),
    Command("skeletonize", "lacuna-skeletonize", ["scene.glb", "--resolution", "16", "--graph", "graph.glb", "--json", "out.json"],
            ["graph.glb", "out.json"], caches=True),
    Command("train", "lacuna-train",
            ["scene.glb", "--paths", "2000", "--light-paths", "2000", "--subspaces", "20", "--json", "out.json"], ["out.json"]),
    Command("study", "lacuna-study", ["study.json", "-o", "study"], []),
]


def named(name: str) -> Command:
    return next(command for command in COMMANDS if command.name == name)


@dataclass
class Outcome:
    exit: int
    seconds: float
    message: str  # on stderr


class Attack:
    """Folders with everything the commands need, and a judge of what is left in them."""

    def __init__(self, build: Path, shim: Path):
        """`shim`: faults.c, compiled."""
        self.build, self.shim = build.resolve(), shim.resolve()
        self.home = Path(tempfile.mkdtemp(prefix="hostile-"))
        self.template = self.home / "template"
        self.template.mkdir()
        self._fill()

    def close(self) -> None:
        shutil.rmtree(self.home, ignore_errors=True)

    def program(self, tool: str) -> str:
        """The path of a tool, or of a script beside this file."""
        for folder in (self.build / "render", self.build / "preprocess", HERE):
            if (folder / tool).exists():
                return str(folder / tool)
        raise SystemExit(f"{self.build}: expected {tool} to be built, found none; build it first")

    def _fill(self) -> None:
        shutil.copy(ROOT / "scenes" / "cornell-box.glb", self.template / "scene.glb")
        (self.template / "study.json").write_text(json.dumps(STUDY))

        def make(*arguments: str) -> None:
            subprocess.run([self.program("lacuna-render"), "scene.glb", "--quiet", *arguments], cwd=self.template, check=True)

        make("--method", "bpt", "--width", "24", "--iterations", "64", "-o", "reference.exr")
        for i in range(2):
            make("--method", "bpt", "--width", "24", "--iterations", "4", "--block-iterations", "2", "--blocks", f"{i},{i + 1}",
                 "-o", f"part{i}.exr")
        make("--method", "bpt", "--width", "24", "--iterations", "4", "--env-colour", "1,1,1", "--light-noise", "-o", "groups.exr")
        make(*SKELBPT, *SHORT, "--prepare", "-o", "thrown-away.exr")
        (self.template / "thrown-away.exr").unlink()
        (self.template / "scene.cache").rename(self.template / "caches")

    def folder(self, command: Command) -> Path:
        """A fresh one, in which `command` can run."""
        folder = Path(tempfile.mkdtemp(dir=self.home)) / "work"
        shutil.copytree(self.template, folder)
        if command.caches:
            (folder / "caches").rename(folder / "scene.cache")
        for name in command.outputs:
            (folder / name).write_bytes(OLD)
        return folder

    def faults(self, **variables: str) -> dict[str, str]:
        """The environment in which faults.c does what these variables ask for."""
        return {"LD_PRELOAD": str(self.shim), **variables}

    def start(self, command: Command, folder: Path, *, more: list[str] = [], quiet: bool = True, **how) -> subprocess.Popen:
        how.setdefault("stdin", subprocess.DEVNULL)
        how.setdefault("stdout", subprocess.DEVNULL)
        how.setdefault("stderr", subprocess.PIPE)
        how["env"] = os.environ | how.get("env", {})
        words = [self.program(command.tool), *command.arguments, *(["--quiet"] if quiet else []), *more]
        return subprocess.Popen(words, cwd=folder, **how)

    def run(self, command: Command, folder: Path, **how) -> Outcome:
        begin = time.monotonic()
        return self.outcome(self.start(command, folder, **how), begin)

    @staticmethod
    def outcome(process: subprocess.Popen, begin: float) -> Outcome:
        try:
            _, text = process.communicate(timeout=6 * LONGEST)
        except subprocess.TimeoutExpired:
            process.kill()
            _, text = process.communicate()
        return Outcome(process.returncode, time.monotonic() - begin, (text or b"").decode(errors="replace").strip())

    def judge(self, command: Command, folder: Path, outcome: Outcome, *, speaks: bool = True) -> list[str]:
        """What is wrong with how it ended, in words; empty if nothing is. `speaks`: it could write to stderr."""
        wrong = []
        lines = outcome.message.splitlines()
        if outcome.exit < 0:
            wrong.append(f"died of {signal.Signals(-outcome.exit).name}")
        elif outcome.exit not in EXITS:
            wrong.append(f"exit code {outcome.exit}")
        if outcome.seconds > LONGEST:
            wrong.append(f"took {outcome.seconds:.0f} s")
        if outcome.exit > 0 and speaks and not lines:
            wrong.append("failed without a word")
        if len(lines) > 3:
            wrong.append(f"{len(lines)} lines of messages")
        for word in ("internal error", "terminate", "Assertion", "Sanitizer", "what():", "std::"):
            if word in outcome.message:
                wrong.append(f"said '{word}'")
        wrong += self._files(command, folder, outcome.exit)
        return wrong

    def _files(self, command: Command, folder: Path, code: int) -> list[str]:
        wrong = []
        for name in command.outputs:
            path = folder / name
            if not path.exists():
                wrong.append(f"{name} is gone")
            elif path.read_bytes() == OLD:
                if code == 0:
                    wrong.append(f"{name} was not written")
            elif not self._is_whole(path):
                wrong.append(f"{name} is not whole")
        left = [p.name for p in folder.rglob(".lacuna-*")]
        if left:
            wrong.append(f"left {', '.join(left)}")
        return wrong

    def _is_whole(self, path: Path) -> bool:
        data = path.read_bytes()
        match path.suffix:
            case ".json":
                try:
                    json.loads(data)
                except ValueError:
                    return False
            case ".csv":
                return data.endswith(b"\n")
            case ".png":
                return data.endswith(b"IEND\xaeB`\x82")
            case ".exr" | ".pfm":
                return subprocess.run([self.program("lacuna-compare"), path, path], capture_output=True).returncode == 0
            case ".vdb":
                return path.with_name(path.name + ".xxh3").exists()
            case ".glb":
                return len(data) >= 12 and int.from_bytes(data[8:12], "little") == len(data)
        return True

    def again(self, command: Command, folder: Path) -> list[str]:
        """What is wrong when the command runs again with nothing in its way: what was left behind must not be."""
        more = ["--prepare"] if command.caches and command.tool == "lacuna-render" else []
        outcome = self.run(command, folder, more=more)
        return [f"afterwards: {wrong}" for wrong in self.judge(command, folder, outcome)] + (
            [f"afterwards: exit code {outcome.exit}: {outcome.message}"] if outcome.exit else [])
