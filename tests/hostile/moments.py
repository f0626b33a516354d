"""Signals and kills at moments spread over a tool's whole life, and two tools that run at once."""

from __future__ import annotations

import random
import signal
import subprocess
import time
from pathlib import Path

from commands import COMMANDS, Attack, Command

SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL]


def is_handled(process: subprocess.Popen, number: signal.Signals) -> bool:
    """Whether the tool handles the signal by now: while the dynamic linker is at work, no code of ours can."""
    for line in Path(f"/proc/{process.pid}/status").read_text().splitlines():
        if line.startswith("SigCgt:"):
            return bool(int(line.split()[1], 16) >> (number - 1) & 1)
    return False


def strike(attack: Attack, command: Command, number: signal.Signals, moment: float) -> list[str]:
    """Sends the signal `moment` seconds after the start."""
    folder = attack.folder(command)
    process = attack.start(command, folder)
    time.sleep(moment)
    struck = time.monotonic()
    handled = is_handled(process, number)
    process.send_signal(number)
    outcome = attack.outcome(process, struck)
    killed = number == signal.SIGKILL and outcome.exit == -signal.SIGKILL
    if killed:
        outcome.exit, outcome.message = 1, "killed"
    if outcome.exit == -number and not handled:
        outcome.exit, outcome.message = 130, "too early to say anything"
    # --quiet says nothing of what an interrupt saved.
    wrong = attack.judge(command, folder, outcome, speaks=outcome.exit != 130)
    if not killed and outcome.exit not in (0, 130):
        wrong.append(f"exit code {outcome.exit}")
    wrong += attack.again(command, folder)
    return [f"{command.name}, {number.name} after {moment:.3f} s: {w} [{outcome.message}]" for w in wrong]


def race(attack: Attack, command: Command) -> list[str]:
    """Two at once in one folder."""
    folder = attack.folder(command)
    begin = time.monotonic()
    both = [attack.start(command, folder) for _ in range(2)]
    wrong = []
    for process in both:
        outcome = attack.outcome(process, begin)
        if outcome.exit != 0:
            wrong.append(f"exit code {outcome.exit}: {outcome.message}")
        wrong += attack.judge(command, folder, outcome)
    wrong += attack.again(command, folder)
    return [f"two at once, {command.name}: {w}" for w in wrong]


def run(attack: Attack, *, moments: int, races: int) -> tuple[dict[str, int], list[str]]:
    """Number of strikes by command, and what was wrong. `moments`: per command and signal."""
    rng = random.Random(33)
    counts: dict[str, int] = {}
    wrong: list[str] = []
    for command in COMMANDS:
        whole = attack.run(command, attack.folder(command)).seconds
        for number in SIGNALS:
            for _ in range(moments):
                wrong += strike(attack, command, number, rng.uniform(0, whole))
        counts[f"{command.name}, signals"] = moments * len(SIGNALS)
        # Two studies, or two renders with one checkpoint, share what only one may have: refused by name.
        if command.name not in ("study", "render checkpoints"):
            for _ in range(races):
                wrong += race(attack, command)
            counts[f"{command.name}, two at once"] = races
    return counts, wrong
