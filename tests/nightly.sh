#!/usr/bin/env bash
# A night of attacks, which ends in one page: bash tests/nightly.sh [OPTIONS]; --help lists them.
exec python3 -B "$(dirname "${BASH_SOURCE[0]}")/nightly/run.py" "$@"
