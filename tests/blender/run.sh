#!/bin/sh
# Compares the add-on's pictures with those of Cycles: sh tests/blender/run.sh BUILD [options of render_scenes.py]
# Exits with 77 if Blender or a built file is missing.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd)
shift
if ! command -v blender >/dev/null; then
    echo "skipped: blender is not installed"
    exit 77
fi
zip=$build/render/blender/lacuna-blender.zip
for file in "$zip" "$build/render/lacuna-render"; do
    if [ ! -e "$file" ]; then
        echo "skipped: $file is not built"
        exit 77
    fi
done
blender -b --factory-startup --python-exit-code 1 -P "$here/engine_in_blender.py" -- "$build/render/lacuna-render"
exec blender -b --factory-startup --python-exit-code 1 -P "$here/render_scenes.py" -- \
    "$zip" "$build/render/lacuna-render" "$build/tests/blender" "$@"
