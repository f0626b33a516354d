"""Surroundings that a tool does not expect: limits, locales, names, streams that are closed, folders that vanish."""

from __future__ import annotations

import os
import resource
import shutil
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

from commands import COMMANDS, OLD, Attack, Command, Outcome, named

RENDER, CACHED = named("render"), named("render cached")
Finding = tuple[str, list[str]]  # what was tried, what was wrong


def tried(attack: Attack, what: str, command: Command, *, exits: set[int] | None = None, speaks: bool = True,
          change: Callable[[Path], None] = lambda folder: None, **how) -> Finding:
    """Runs `command` where `change` has been at its folder; `exits`: the exit codes that are right (all of the interface)."""
    folder = attack.folder(command)
    change(folder)
    outcome = attack.run(command, folder, **how)
    wrong = attack.judge(command, folder, outcome, speaks=speaks)
    if exits and outcome.exit not in exits:
        wrong.append(f"exit code {outcome.exit}, expected one of {sorted(exits)}")
    return f"{what}, {command.name}", [f"{what}, {command.name}: {w} [{outcome.message}]" for w in wrong]


def limited(kind: int, value: int) -> Callable[[], None]:
    return lambda: resource.setrlimit(kind, (value, value))


def limits(attack: Attack) -> Iterator[Finding]:
    for command in COMMANDS:
        for megabytes in (40, 80, 120, 160, 200, 300, 500, 1000):
            yield tried(attack, f"{megabytes} MB of address space", command, exits={0, 1, 127},
                        preexec_fn=limited(resource.RLIMIT_AS, megabytes << 20))
        for kilobytes in (0, 1, 4, 16):
            yield tried(attack, f"files of {kilobytes} kB", command, exits={0, 1},
                        preexec_fn=limited(resource.RLIMIT_FSIZE, kilobytes << 10))
        for files in (6, 10, 16):
            yield tried(attack, f"{files} open files", command, exits={0, 1, 3},
                        preexec_fn=limited(resource.RLIMIT_NOFILE, files))


def threads(attack: Attack) -> Iterator[Finding]:
    for command in COMMANDS:
        if command.tool == "lacuna-study":
            continue
        for number in ("1", "64"):
            options = [number if before == "--threads" else option
                       for before, option in zip(["", *command.arguments], command.arguments)]
            yield tried(attack, f"{number} threads", replace(command, arguments=options), exits={0})


def locales(attack: Attack) -> Iterator[Finding]:
    folder = attack.home / "locales"
    folder.mkdir()
    made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", folder / "de_DE.UTF-8"], capture_output=True)
    if made.returncode != 0 and not (folder / "de_DE.UTF-8").exists():
        print("locales: skipped, localedef cannot make de_DE.UTF-8 here")
        return
    for command in COMMANDS:
        yield tried(attack, "decimal commas", command, exits={0}, env={"LOCPATH": str(folder), "LC_ALL": "de_DE.UTF-8"})
    yield tried(attack, "a locale that is not there", RENDER, exits={0}, env={"LC_ALL": "xx_XX"})


def streams(attack: Attack) -> Iterator[Finding]:
    for command in COMMANDS:
        for closed in (0, 1, 2):
            yield tried(attack, f"stream {closed} closed", command, exits={0, 1}, speaks=closed != 2,
                        preexec_fn=lambda closed=closed: os.close(closed))
        with open("/dev/full", "w") as full:
            yield tried(attack, "stdout full", command, exits={0, 1}, stdout=full)
            yield tried(attack, "stderr full", command, exits={0}, stderr=full)


def names(attack: Attack) -> Iterator[Finding]:
    for name in ("with space", "ünï✓", "-dash", "new\nline", "a" * 240, "'quote\"", "%s%n", "../work/x"):
        for ending in (".exr", ".png"):
            output = name + ending
            options = list(CACHED.arguments)
            options[options.index("-o") + 1] = "./" + output
            command = replace(CACHED, arguments=options, outputs=[output, "out.json"])
            yield tried(attack, f"named {name[:12]!r}", command, exits={0})
    long = "/".join(["d" * 200] * 25) + "/x.exr"
    options = list(CACHED.arguments)
    options[options.index("-o") + 1] = long
    yield tried(attack, "a name of 5 kB", replace(CACHED, arguments=options, outputs=[]), exits={1})


def as_nobody(attack: Attack) -> Iterator[Finding]:
    """Without root's rights, which no permission holds up."""
    if os.geteuid() != 0:
        return
    attack.home.chmod(0o755)

    def locked(folder: Path) -> None:
        for path in (folder, *folder.rglob("*")):
            os.chown(path, 65534, 65534)
        folder.parent.chmod(0o755)
        os.chown(folder, 65534, 65534)
        for path in folder.rglob("*"):
            path.chmod(0o555 if path.is_dir() else 0o444)
        folder.chmod(0o555)

    for command in COMMANDS:
        yield tried(attack, "a folder that is read-only", command, exits={1, 3}, change=locked, user=65534, group=65534,
                    extra_groups=[])


def meanwhile(attack: Attack, what: str, command: Command, act: Callable[[Path], None], after: float) -> Finding:
    """Something happens to the folder while the tool is at work."""
    folder = attack.folder(command)
    begin = time.monotonic()
    process = attack.start(command, folder)
    timer = threading.Timer(after, act, [folder])
    timer.start()
    outcome: Outcome = attack.outcome(process, begin)
    timer.join()
    gone = not (folder / "scene.glb").exists() and not any((folder / n).exists() for n in command.outputs)
    wrong = attack.judge(command, folder, outcome) if not gone else []
    if gone and outcome.exit not in (0, 1, 3):
        wrong.append(f"exit code {outcome.exit}")
    return f"{what}, {command.name}", [f"{what} after {after:.2f} s, {command.name}: {w} [{outcome.message}]" for w in wrong]


def changes(attack: Attack) -> Iterator[Finding]:
    def vanish(folder: Path) -> None:
        shutil.rmtree(folder, ignore_errors=True)

    def replace_scene(folder: Path) -> None:
        (folder / "scene.glb").write_bytes(OLD)

    def cut_scene(folder: Path) -> None:
        os.truncate(folder / "scene.glb", 100)

    def delete_caches(folder: Path) -> None:
        shutil.rmtree(folder / "scene.cache", ignore_errors=True)

    def change_caches(folder: Path) -> None:
        for path in folder.glob("scene.cache/*"):
            path.write_bytes(path.read_bytes()[::-1])

    acts = {"the folder vanishes": vanish, "the scene is replaced": replace_scene, "the scene is cut off": cut_scene,
            "caches are deleted": delete_caches, "caches are changed": change_caches}
    for command in (RENDER, CACHED, named("render checkpoints"), named("compare")):
        for what, act in acts.items():
            for after in (0.01, 0.05, 0.1, 0.2, 0.3):
                yield meanwhile(attack, what, command, act, after)


def run(attack: Attack) -> tuple[dict[str, int], list[str]]:
    """Number of cases by kind, and what was wrong."""
    counts: dict[str, int] = {}
    wrong: list[str] = []
    for kind in (limits, threads, locales, streams, names, as_nobody, changes):
        counts[kind.__name__.replace("_", " ")] = 0
        for _, found in kind(attack):
            counts[kind.__name__.replace("_", " ")] += 1
            wrong += found
    return counts, wrong
