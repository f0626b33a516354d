"""Measures how fast several ranks are, and what would limit more of them: writes a page of tests/results.

    python3 tests/calibration/ranks.py build/render/lacuna-render PAGE

Renders with 1, 2 and 4 ranks of one thread each, in turn, and takes the median of the ratios of
three rounds. The rest of the page is computed from these measurements, and says so.
"""

import datetime
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1]))

import pages  # noqa: E402

SCENES = pathlib.Path(__file__).resolve().parents[2] / "scenes"
RANKS = (1, 2, 4)
ROUNDS = 3
RENDERS = (
    # name, scene, width, height, iterations, method and its options
    ("bpt", "door.glb", 320, 180, 32, ["--method", "bpt"]),
    ("lvcbpt", "door.glb", 320, 180, 32, ["--method", "lvcbpt"]),
    ("risbpt", "door.glb", 320, 180, 32, ["--method", "risbpt", "--block-iterations", "4"]),
)
PIXELS_4K = 3840 * 2160
NETWORK = 1.25e9  # bytes per second: 10 GbE
PIECE = 30.0      # seconds that the pieces of a long render take


def render(program, ranks, scene, width, height, iterations, options, directory):
    report = directory / "report.json"
    command = [program, str(SCENES / scene), "-o", str(directory / "out.exr"), "--json", str(report),
               "--quiet", "--threads", "1", "--width", str(width), "--height", str(height),
               "--iterations", str(iterations), *options]
    if ranks > 1:
        command = ["mpirun", "-q", "--oversubscribe", "--bind-to", "none", "-n", str(ranks),
                   *command]
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, env=environment)
    return json.loads(report.read_text())


def measure(program, directory):
    """The reports of all rounds, by render and ranks."""
    found = {}
    for _ in range(ROUNDS):
        for name, *arguments in RENDERS:
            for ranks in RANKS:
                report = render(program, ranks, *arguments, directory)
                found.setdefault((name, ranks), []).append(report)
                print(f"{name}, {ranks} ranks: {report['seconds']:.1f} s", file=sys.stderr)
    return found


def median(values):
    return statistics.median(values)


def spread(values):
    return f"{median(values):.2f} ({min(values):.2f} to {max(values):.2f})"


def table(found):
    lines = ["| method | ranks | seconds | times as fast | MB received | rank 0 with pieces, s |",
             "|---|---|---|---|---|---|"]
    for name, *_ in RENDERS:
        alone = found[name, 1]
        for ranks in RANKS:
            reports = found[name, ranks]
            ratios = [a["seconds"] / r["seconds"] for a, r in zip(alone, reports)]
            received = median([r.get("received_bytes", 0) for r in reports]) / 1e6
            pieces = median([r["phases"].get("pieces", 0.0) for r in reports])
            lines.append(f"| {name} | {ranks} | {median([r['seconds'] for r in reports]):.1f} | "
                         f"{spread(ratios)} | {received:.0f} | {pieces:.2f} |")
    return lines


def outlook(found):
    """The load that rank 0 can take, from its cost per byte."""
    costs = []
    for name, _, width, height, *_ in RENDERS:
        for ranks in RANKS[1:]:
            for report in found[name, ranks]:
                costs.append(report["phases"]["pieces"] / report["received_bytes"])
    cost = median(costs)
    piece = 24 * PIXELS_4K
    lines = ["| ranks | pieces at rank 0 in 30 s, GB | on the network, s | rank 0 adds them in, s | "
             "of linear speed-up, if training is 1 % of one rank's time |", "|---|---|---|---|---|"]
    for ranks in (4, 64, 1024):
        gigabytes = ranks * piece / 1e9
        network, adding = ranks * piece / NETWORK, ranks * piece * cost
        longest = max(network, adding, PIECE)
        amdahl = 1.0 / (0.01 + 0.99 / ranks) / ranks
        lines.append(f"| {ranks} | {gigabytes:.1f} | {network:.1f} | {adding:.1f} | "
                     f"{amdahl:.2f}, and {PIECE / longest:.2f} of that |")
    return cost, int(PIECE / (piece * cost)), int(PIECE * NETWORK / piece), lines


def page(found, program):
    cost, by_adding, by_network, lines = outlook(found)
    first = found[RENDERS[0][0], 1][0]
    return "\n".join([
        "# Several ranks: how fast, and what would limit more", "",
        f"Date {datetime.date.today()}, commit {pages.commit()}, {pages.machine()}. "
        f"`python3 tests/calibration/ranks.py {program} PAGE`.", "",
        "Door, 320 x 180, 32 iterations, one thread per rank, all ranks on this machine; with more "
        "ranks than processors they share them. Three rounds in turn; medians, lowest and highest. "
        "Setup is apart "
        f"({first['setup_seconds']:.2f} s).", "",
        *table(found), "",
        "## More of them, on paper", "",
        f"Rank 0 reads, checks and adds a piece in {cost * 1e9:.2f} ns for each byte (measured above, "
        f"one thread). A piece of a picture of 3840 x 2160 has 24 bytes per pixel, {24 * PIXELS_4K / 1e6:.0f} "
        f"MB; those of long renders take a rank {PIECE:.0f} s. With a network of 10 Gbit/s at rank 0:", "",
        *lines, "",
        f"So {by_adding} ranks are what rank 0 can add up at that size ({4 * by_adding} at "
        f"1920 x 1080), and {by_network} what its network can carry. Where caches are trained, "
        "rank 0 does that alone: of a share of 1 % more than 100 ranks get nothing. Splats limit "
        "nothing: each rank has its own film, and a piece is as large with them as without.", ""])


def main():
    program, target = sys.argv[1:3]
    with tempfile.TemporaryDirectory() as directory:
        found = measure(program, pathlib.Path(directory))
    pathlib.Path(target).write_text(page(found, program))


if __name__ == "__main__":
    main()
