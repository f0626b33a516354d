"""A long render: whether its memory keeps growing, and whether its error keeps falling."""

import math
import os
import re
import shutil
import statistics
import subprocess
import time

SAMPLE_SECONDS = 2
MOST_GROWTH = 1.01  # of memory, from the first half of the time to the second
LEAST_SLOPE = -0.45  # of log mape over log iterations; independent iterations have -0.5
BEGIN_OF_SLOPE = 1 / 16  # of all iterations: after a few, most pixels have met none of the rare bright samples


def resident(process):
    """Bytes of memory; None once the process has ended."""
    try:
        with open(f"/proc/{process}/statm") as pages:
            return int(pages.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, IndexError):
        return None


def iterations_of(head):
    """The attribute `iterations` of an .exr, from its first bytes."""
    found = re.search(rb"iterations\0int\0\x04\0\0\0(.{4})|iterations\0string\0(.{4})(\d+)", head, re.S)
    if not found:
        return 0
    return int.from_bytes(found[1], "little") if found[1] else int(found[3][:int.from_bytes(found[2], "little")])


def end_of(log):
    """The last bytes of a file that grows for a day."""
    with open(log, "rb") as content:
        content.seek(max(0, os.fstat(content.fileno()).st_size - 4096))
        return content.read().decode(errors="replace")


def iterations_in(lines):
    """The iteration in the last line of progress; 0 before the first one."""
    found = re.findall(r"\biteration (\d+)", lines)
    return int(found[-1]) if found else 0


def growth(samples):
    """Memory late in the run over memory early in it. `samples`: (iterations, bytes), by time. A film holds one sum for
    each set bit of its number of iterations, so only equal numbers of sums are compared."""
    half, by_sums = len(samples) // 2, {}
    for late, part in enumerate((samples[:half], samples[half:])):
        for iterations, memory in part:
            by_sums.setdefault(iterations.bit_count(), ([], []))[late].append(memory)
    ratios = [statistics.median(late) / statistics.median(early) for early, late in by_sums.values() if early and late]
    return statistics.median(ratios) if ratios else math.nan


def slope(errors, last):
    """The slope of log mape over log iterations, by least squares. `errors`: (iterations, mape against the picture of
    `last` iterations). That picture contains the one measured, so the measured error is sigma sqrt(1/n - 1/N)."""
    points = [(math.log(n), math.log(mape / math.sqrt(1 - n / last)))
              for n, mape in errors if BEGIN_OF_SLOPE * last <= n < last and mape > 0]
    if len(points) < 2:
        return math.nan
    x, y = (statistics.mean(values) for values in zip(*points))
    return sum((a - x) * (b - y) for a, b in points) / sum((a - x) ** 2 for a, _ in points)


def mape(compare, picture, reference):
    output = subprocess.run([compare, picture, reference], capture_output=True, text=True, check=True).stdout
    return float(re.search(r"^mape (\S+)$", output, re.M)[1])


def watch(process, picture, log, folder, seconds):
    """Samples of iterations and memory, and copies of `picture` at times that double."""
    memory, copies, begin, at = [], [], time.monotonic(), seconds / 64
    while process.poll() is None:
        time.sleep(SAMPLE_SECONDS)
        memory.append((iterations_in(end_of(log)), resident(process.pid)))
        if time.monotonic() - begin > at and picture.exists():
            copies.append(folder / f"{len(copies)}.exr")
            shutil.copyfile(picture, copies[-1])  # it is replaced as a whole, never written into
            at *= 2
    return [(iterations, bytes_) for iterations, bytes_ in memory if iterations and bytes_], copies


def measure(programs, scene, seconds, folder):
    """Runs a render of `scene` by `auto` for so many seconds at 1920 x 1080: rows of a table, and findings."""
    folder.mkdir(parents=True, exist_ok=True)
    picture = folder / "picture.exr"
    for old in folder.glob("*.exr"):
        old.unlink()
    (folder / "checkpoint").unlink(missing_ok=True)
    log = folder / "render.log"
    with open(log, "w") as output:
        process = subprocess.Popen(
            [programs / "lacuna-render", scene, "-o", picture, "--width", "1920", "--height", "1080", "--time", f"{seconds}s",
             "--write-every", f"{max(1, seconds // 128)}s", "--checkpoint", folder / "checkpoint", "--cache",
             folder / "cache"], stdout=output, stderr=subprocess.STDOUT)
        memory, copies = watch(process, picture, log, folder, seconds)
    if process.returncode != 0:
        return [], [f"ended with {process.returncode}: {log}"]

    def iterations(file):
        with open(file, "rb") as content:
            return iterations_of(content.read(1 << 16))

    last, errors = iterations(picture), {}
    for copy in copies:
        n = iterations(copy)
        if 0 < n < 0.9 * last:
            errors[n] = mape(programs / "lacuna-compare", copy, picture)
    grown, falls = growth(memory), slope(errors.items(), last)
    rows = [["iterations", "mape against the last picture"], *([n, f"{error:.4f}"] for n, error in errors.items()),
            [last, "0"], ["memory, most", f"{max(bytes_ for _, bytes_ in memory) / 2**20:.0f} MB"],
            ["memory, second half over first, where the film holds as many sums", f"{grown:.4f}"],
            ["slope of log mape from a sixteenth of the iterations on", f"{falls:.3f}"]]
    findings = []
    if not grown <= MOST_GROWTH:
        findings.append(f"memory grows: {grown:.4f}")
    if not falls <= LEAST_SLOPE:
        findings.append(f"the error does not fall as it should: slope {falls:.3f}")
    return rows, findings
