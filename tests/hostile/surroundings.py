"""Surroundings that a tool does not expect: limits, locales, names, streams that are closed or whose readers leave, folders that
vanish or are full, a clock that leaps."""

from __future__ import annotations

import json
import os
import resource
import shutil
import signal
import socketserver
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from commands import COMMANDS, LONGEST, OLD, SIZE, Attack, Command, Outcome, named

RENDER, CACHED = named("render"), named("render cached")
LIBRARY = Command("library", "in_memory.py", [], [])
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
        for number in ("1", "64", "256"):
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
            yield tried(attack, "stderr full", command, exits={0}, stderr=full, quiet=False)


@contextmanager
def left_after(size: int) -> Iterator[int]:
    """The writing end of a pipe whose reader leaves after at most `size` bytes."""
    reading, writing = os.pipe()

    def read() -> None:
        os.read(reading, size)
        os.close(reading)

    reader = threading.Thread(target=read)
    reader.start()
    try:
        yield writing
    finally:
        os.close(writing)
        reader.join()


def readers(attack: Attack) -> Iterator[Finding]:
    """The reader of a stream leaves before the tool writes to it, or after the first byte (SIGPIPE)."""
    for command in COMMANDS:
        for size in (0, 1):
            with left_after(size) as stream:
                yield tried(attack, f"stdout left after {size} bytes", command, exits={0, 1} if size else {1},
                            stdout=stream)
            with left_after(size) as stream:
                yield tried(attack, f"stderr left after {size} bytes", command, exits={0}, stderr=stream, quiet=False)
    for tool in sorted({command.tool for command in COMMANDS}):
        with left_after(0) as stream:
            yield tried(attack, "stdout left", Command(f"{tool} --help", tool, ["--help"], []), exits={1}, stdout=stream)


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


def temporary_folders(attack: Attack) -> Iterator[Finding]:
    """TMPDIR lies on a full disk. Only the library writes there: caches of a scene that lies nowhere, where there is no home."""
    env = {"HOME": "", "XDG_CACHE_HOME": "", "PYTHONPATH": str(attack.build / "python")}
    commands = list(COMMANDS)
    if subprocess.run(["/usr/bin/python3", "-c", "import lacuna"], env=env, capture_output=True).returncode == 0:
        commands.append(LIBRARY)
    else:
        print("full temporary folder: library skipped, the Python package is not built")
    for command in commands:
        folder = attack.home / "full"
        folder.mkdir()
        env |= attack.faults(LACUNA_FULL=str(folder.resolve()), TMPDIR=str(folder))
        what, wrong = tried(attack, "full temporary folder", command, exits={1} if command is LIBRARY else {0}, env=env)
        yield what, wrong + [f"{what}: left {path.name}" for path in folder.rglob("*") if path.is_file()]
        shutil.rmtree(folder)


def as_nobody(attack: Attack) -> Iterator[Finding]:
    """Without root's rights, since permissions do not hold root up."""
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


class Viewer(socketserver.BaseRequestHandler):
    """Takes what it is sent, as tev does, and counts the bytes."""

    def handle(self) -> None:
        while data := self.request.recv(1 << 16):
            self.server.taken += len(data)


@contextmanager
def viewer() -> Iterator[socketserver.TCPServer]:
    with socketserver.TCPServer(("127.0.0.1", 0), Viewer) as server:
        server.taken = 0
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()


def clocks(attack: Attack) -> Iterator[Finding]:
    """The time of day leaps back and forth. A render ends by time nevertheless, saves its checkpoint, goes on from it, and is seen."""
    what = "a clock that leaps, render for two seconds"
    env = attack.faults(LACUNA_FAULT="clock:1+")
    with viewer() as server:
        command = Command("", "lacuna-render",
                          ["scene.glb", "--method", "bpt", *SIZE, "--time", "2s", "--checkpoint", "saved",
                           "--checkpoint-every", "0.1s", "--write-every", "0.1s", "-o", "out.exr", "--json", "out.json",
                           "--display-server", "%s:%d" % server.server_address], ["out.exr", "out.json"])
        folder = attack.folder(command)
        begin = time.monotonic()
        process = attack.start(command, folder, env=env)
        while not (folder / "saved").exists() and process.poll() is None:
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        first = attack.outcome(process, begin)
        second = attack.run(command, folder, env=env)
    wrong = attack.judge(command, folder, first, speaks=False) + attack.judge(command, folder, second)
    if (first.exit, second.exit) != (130, 0):
        wrong.append(f"exit codes {first.exit} and {second.exit}, expected 130 and 0")
    else:
        report = json.loads((folder / "out.json").read_text())
        if report["stopped"] != "time" or not 1 < report["seconds"] < LONGEST:
            wrong.append(f"stopped by {report['stopped']} after {report['seconds']} s")
    if server.taken < 24 * 24 * 3 * 4:
        wrong.append(f"sent {server.taken} bytes of pictures")
    yield what, [f"{what}: {w} [{first.message}] [{second.message}]" for w in wrong]


def run(attack: Attack) -> tuple[dict[str, int], list[str]]:
    """Number of cases by kind, and what was wrong."""
    counts: dict[str, int] = {}
    wrong: list[str] = []
    for kind in (limits, threads, locales, streams, readers, names, temporary_folders, as_nobody, changes, clocks):
        counts[kind.__name__.replace("_", " ")] = 0
        for _, found in kind(attack):
            counts[kind.__name__.replace("_", " ")] += 1
            wrong += found
    return counts, wrong
