#!/usr/bin/env bash
# A night of attacks, which ends in one page: bash tests/nightly.sh [OPTIONS]; --help lists them.
# Debian's Python, not another one in the PATH: Blender would take the files beside that for its own.
exec /usr/bin/python3 -B "$(dirname "${BASH_SOURCE[0]}")/nightly/run.py" "$@"
