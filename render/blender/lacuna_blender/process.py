"""lacuna-render as a child process. Independent of Blender."""

import os
import shutil
import signal
import subprocess
import threading

NAME = "lacuna-render.exe" if os.name == "nt" else "lacuna-render"


class NotFound(Exception):
    """Tells where lacuna-render was searched for."""


def find(preferred):
    """The path of the program: the preferred one, else that in the PATH, else one beside this add-on or in its place of
    installation."""
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
    """A command that ends when Blender ends, however that happens. Without util-linux it renders until its limit."""
    keeper = shutil.which("setpriv")
    return [keeper, "--pdeathsig", "INT", *command] if keeper else command


class Child:
    """A running render. Its messages are stored and passed to `said` line by line, in another thread."""

    def __init__(self, command, said=print):
        self.lines = []
        self._said = said
        # It has its own process group: Ctrl-C in Blender's terminal reaches it only once, through
        # stop().
        self._process = subprocess.Popen(mortal(command), stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                         stderr=subprocess.PIPE, start_new_session=True)
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def wait(self, seconds):
        """The exit code, or None if it still runs after `seconds`."""
        try:
            code = self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            return None
        self._reader.join(2)
        return code

    def stop(self, grace=5.0):
        """Stops it like Ctrl-C; after `grace` seconds by force."""
        self._process.send_signal(signal.SIGINT)
        if self.wait(grace) is None:
            self._process.kill()
            self._process.wait()

    def warnings(self):
        return [line for line in self.lines if "warning" in line]

    def error(self):
        """Its last message."""
        return self.lines[-1] if self.lines else "lacuna-render ended without a word"

    def _read(self):
        for raw in self._process.stderr:
            line = raw.decode(errors="replace").strip()
            if line:
                self.lines.append(line)
                self._said(line)
        self._process.stderr.close()
