"""Every system call of some names that a tool makes, refused once: the first, the second and so on to the last."""

from __future__ import annotations

from commands import COMMANDS, Attack, Command

CALLS = ["write", "write+", "fsync", "open", "rename", "read", "mkdir", "memory", "thread", "clock", "clock+"]


def refuse(attack: Attack, command: Command, call: str, n: int) -> tuple[bool, list[str]]:
    """Whether there was an n-th call of that name, and what was wrong then."""
    folder = attack.folder(command)
    fired = folder.parent / "fired"
    name, later = call.rstrip("+"), "+" if call.endswith("+") else ""
    env = attack.faults(LACUNA_FAULT=f"{name}:{n}{later}", LACUNA_FAULT_FIRED=str(fired))
    outcome = attack.run(command, folder, env=env)
    if not fired.exists():
        return False, []
    wrong = attack.judge(command, folder, outcome)
    if name == "clock" and outcome.exit != 0:
        wrong.append(f"exit code {outcome.exit}, expected 0")
    wrong += attack.again(command, folder)
    return True, [f"{command.name}, {call} {n}: {w} [{outcome.message}]" for w in wrong]


def run(attack: Attack, *, quick: bool) -> tuple[dict[str, int], list[str]]:
    """Number of refused calls by command and call, and what was wrong. `quick`: calls 1, 4, 16 .. of few commands."""
    counts: dict[str, int] = {}
    wrong: list[str] = []
    for command in COMMANDS:
        if quick and command.name not in ("render", "merge"):
            continue
        for call in CALLS:
            n, made = 1, 0
            while True:
                there, found = refuse(attack, command, call, n)
                if not there:
                    break
                made += 1
                wrong += found
                n += 3 * n if quick else 1
            counts[f"{command.name}, {call}"] = made
    return counts, wrong
