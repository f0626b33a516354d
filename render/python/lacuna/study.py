"""Studies of error against time, over methods, scenes and seeds, by the program lacuna-study."""

from __future__ import annotations

import csv
import json
import os
import shutil
import signal
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._lacuna import Error, InputError, Interrupted, RunError, UsageError

Array = NDArray[np.float64]

_ERRORS: dict[int, type[Error]] = {1: RunError, 2: UsageError, 3: InputError, 130: Interrupted}
_SHARED = "$LACUNA_SHARED_SCENES/"


def find_program(name: str) -> str:
    """The path of a program of Lacuna: the one built or installed with this package, else the one
    in the PATH. Raises RunError if there is none.
    """
    package = Path(__file__).absolute().parent
    # The package is BUILD/python/lacuna, or PREFIX/lib/python3/dist-packages/lacuna.
    places = [package.parents[1] / "render" / name]
    places += [p.parent / "bin" / name for p in package.parents if p.name in ("lib", "lib64")]
    for place in places:
        if place.is_file() and os.access(place, os.X_OK):
            return str(place)
    found = shutil.which(name)
    if found is None:
        raise RunError(f"{name}: expected it beside the package or in the PATH, found none; build it")
    return found


def _absolute(path: Any) -> Any:
    if not isinstance(path, (str, os.PathLike)) or os.fspath(path).startswith(_SHARED):
        return path
    return os.path.abspath(path)


def _from_here(value: Any, key: str = "") -> Any:
    """The study with absolute paths, so that its file may lie anywhere."""
    if isinstance(value, Mapping):
        return {k: _from_here(v, k) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [_from_here(v) for v in value]
    if key in ("file", "reference", "env"):
        return _absolute(value)
    if isinstance(value, np.generic):
        return value.item()
    return value


def _run(command: list[str], on_message: Callable[[str], None] | None) -> None:
    """Runs the program in its own session: an interrupt reaches only this process, which passes it
    on once."""
    said: list[str] = []
    stopped: BaseException | None = None
    # A file name in a message may contain any bytes.
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.PIPE, text=True, errors="replace",
                               start_new_session=True)
    with process:
        assert process.stderr is not None
        while True:
            try:
                for line in process.stderr:
                    said.append(line.rstrip("\n"))
                    if on_message is not None and stopped is None:
                        on_message(said[-1])
                code = process.wait()
                break
            except BaseException as why:  # Ctrl-C, or an exception of the callback
                stopped = stopped or why
                process.send_signal(signal.SIGINT)
    if stopped is not None:
        raise stopped
    if code != 0:
        last = said[-1] if said else f"lacuna-study: expected exit code 0, found {code}"
        raise _ERRORS.get(code, RunError)(last)


def _numbers(texts: list[str]) -> Array:
    return np.array([float(text) if text else np.nan for text in texts])


def _phases(texts: list[str]) -> dict[str, Array]:
    """Parses `eye paths=0.52;light paths=0.11` of each row into arrays by name."""
    rows = [dict(part.rsplit("=", 1) for part in text.split(";") if part) for text in texts]
    names = dict.fromkeys(name for row in rows for name in row)
    return {name: np.array([float(row.get(name, 0)) for row in rows]) for name in names}


def _curves(path: Path) -> dict[tuple[str, str, int], dict[str, Any]]:
    """Curves by scene, name and seed, each a dict of columns."""
    rows: dict[tuple[str, str, int], list[dict[str, str]]] = {}
    with path.open(newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            rows.setdefault((row["scene"], row["name"], int(row["seed"])), []).append(row)
    curves = {}
    for key, points in rows.items():
        names = [n for n in points[0] if n not in ("scene", "name", "method", "seed", "run")]
        columns = {name: [point[name] for point in points] for name in names}
        curves[key] = {
            name: _phases(texts) if name == "phases" else _numbers(texts)
            for name, texts in columns.items()
        }
    return curves


def _by_name(results: dict[str, Any], key: str) -> dict[str, dict[str, Any]]:
    """Results in arrays by scene and method, as dicts by their names."""
    return {
        scene["name"]: {m["name"]: value for m, value in zip(results["methods"], row)}
        for scene, row in zip(results["scenes"], results[key])
    }


def _read(output: Path, file: Path) -> dict[str, Any]:
    results: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    curves = _curves(output / "raw.csv")
    for run in results["runs"]:
        run["scene"] = results["scenes"][run["scene"]]["name"]
        method = results["methods"][run["method"]]
        run["name"], run["method"] = method["name"], method["method"]
        run["curve"] = curves[run["scene"], run["name"], run["seed"]]
        run["image"] = str(output / "runs" / run["id"] / "image.exr")
    bands = _by_name(results, "bands")
    for methods in bands.values():
        for measures in methods.values():
            for axes in measures.values():
                for axis, points in axes.items():
                    axes[axis] = np.array(points, dtype=float).reshape(-1, 4)
    results["bands"] = bands
    results["costs"] = _by_name(results, "costs")
    names = [scene["name"] for scene in results["scenes"]]
    results["knobs"] = dict(zip(names, results["knobs"]))
    del results["error_map"]  # only for the page
    return results


def study(
    file_or_dict: str | os.PathLike[str] | Mapping[str, Any],
    output: str | os.PathLike[str],
    *,
    quick: bool = False,
    threads: int | None = None,
    on_message: Callable[[str], None] | None = None,
) -> dict[str, Any]:
    """Runs a study, or the rest that an earlier call left, and returns its results.

    `file_or_dict`: the path of a study's file, or its content (render/README.md, "lacuna-study");
    paths in a dict are relative to the working directory. `output`: the folder for the page
    index.html, tables and pictures. Existing runs are not repeated. `quick` and `threads` are the
    options of the program. `on_message` is called with each line that the program prints, at least
    one every ten seconds.

    The result is a dict:

    runs: a list with a dict per run: scene, name (of the method in the study), method, seed,
    iterations, seconds, setup_seconds, error, .., image (path) and curve, a dict of arrays with a
    value per checkpoint: iteration, seconds, setup_seconds, mae, rmse, mape, relmse, rays, ..; its
    phases is a dict of arrays as well.
    bands[scene][name][measure][axis]: an array (n, 4) of x, median, lowest and highest error over
    seeds; axis is seconds, seconds_with_setup or iterations.
    costs[scene][name]: phases (seconds), rays, peak_bytes: means over seeds.
    tables: a list of dicts: id, title, columns, rows (texts), notes.
    scenes, methods, measures, seeds, baseline, knobs, title, ..: how it was made.

    Raises UsageError, InputError or RunError, by the program's exit code. Ctrl-C ends the program
    in an orderly way, then KeyboardInterrupt is raised; the same call continues from there.
    """
    program = find_program("lacuna-study")
    folder = Path(os.path.abspath(output))
    if isinstance(file_or_dict, Mapping):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            file = folder / "study.json"
            file.write_text(json.dumps(_from_here(file_or_dict), indent=2), encoding="utf-8")
        except OSError as e:
            raise RunError(f"{folder}: expected to write there, found: {e.strerror}") from e
    else:
        file = Path(os.path.abspath(file_or_dict))
    results = folder / "results.json"
    command = [program, str(file), "-o", str(folder), "--json", str(results)]
    if quick:
        command.append("--quick")
    if threads is not None:
        command += ["--threads", str(threads)]
    _run(command, on_message)
    return _read(folder, results)
