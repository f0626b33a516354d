#!/bin/sh
# Tests Lacuna's layers in Blender's compositor: sh tests/blender/compositor.sh BUILD
# Exits with 77 if Blender is missing.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=$(cd "$1" && pwd)
if ! command -v blender >/dev/null; then
    echo "skipped: blender is not installed"
    exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
render() {
    "$build/render/lacuna-render" "$here/../../scenes/blender-still-life.glb" -o "$folder/$1.exr" --quiet --method pt \
        --iterations 4 --width 192 --env-colour 0.3,0.5,1 --light-groups --cryptomatte object,material $2
}
render plain ""
render parts "--half --multi-part"
for name in plain parts; do
    blender -b --factory-startup --python-exit-code 1 -P "$here/compositor.py" -- \
        "$folder/$name.exr" "$folder/plain.exr" "$folder"
done
