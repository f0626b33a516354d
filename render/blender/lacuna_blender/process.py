"""lacuna-render as a child process. Knows nothing of Blender."""

import os
import shutil
import signal
import subprocess
import threading

NAME = "lacuna-render.exe" if os.name == "nt" else "lacuna-render"


class NotFound(Exception):
    """Says where lacuna-render was looked for."""


def find(preferred):
    """The program: the one that is preferred, else in the PATH, else beside this add-on or where installs put it."""
    if preferred:
        if os.path.isfile(preferred) and os.access(preferred, os.X_OK):
            return preferred
        raise NotFound(f"{preferred}: expected lacuna-render, found no program; correct the add-on's preferences")
    here = os.path.dirname(os.path.abspath(__file__))
    places = [os.path.join(folder, NAME) for folder in (here, os.path.dirname(here), "/usr/local/bin", "/usr/bin")]
    found = shutil.which(NAME) or next((p for p in places if os.access(p, os.X_OK)), None)
    if not found:
        raise NotFound("lacuna-render: expected in the PATH, found nowhere; name it in Edit > Preferences > Add-ons > Lacuna")
    return found


def mortal(command):
    """Ends when Blender does, however that ends; where util-linux is not there, it renders on to its limit."""
    keeper = shutil.which("setpriv")
    return [keeper, "--pdeathsig", "INT", *command] if keeper else command


class Child:
    """A running render. What it says is kept, and passed on to `said` line by line, in another thread."""

    def __init__(self, command, said=print):
        self.lines = []
        self._said = said
        # A group of its own: Ctrl-C in Blender's terminal ends it through stop(), once.
        self._process = subprocess.Popen(mortal(command), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                         stderr=subprocess.PIPE, start_new_session=True)
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def wait(self, seconds):
        """The exit code, or None where it still runs after so many seconds."""
        try:
            code = self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            return None
        self._reader.join(2)
        return code

    def stop(self, grace=5.0):
        """As Ctrl-C does; after `grace` seconds by force."""
        self._process.send_signal(signal.SIGINT)
        if self.wait(grace) is None:
            self._process.kill()
            self._process.wait()

    def warnings(self):
        return [line for line in self.lines if "warning" in line]

    def error(self):
        """The last thing that it said."""
        return self.lines[-1] if self.lines else "lacuna-render ended without a word"

    def _read(self):
        for raw in self._process.stderr:
            line = raw.decode(errors="replace").strip()
            if line:
                self.lines.append(line)
                self._said(line)
        self._process.stderr.close()
