#!/usr/bin/env bash
# Makes the Debian packages and tries them on a Debian that has nothing else; by hand, as root:
#
#   bash tests/package.sh [FILE.md]
#
# Needs lintian, and mmdebstrap for the clean root. FILE.md gets the results.
set -euo pipefail
project=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
page=${1:-$project/tests/results/package-$(date +%F).md}
packages=$project/build-package/packages
work=$(mktemp -d)
# Files that are still mounted in the root must not be removed.
trap 'umount "$work/root/proc" 2>/dev/null || true; rm -rf --one-file-system "$work"' EXIT
# Keeps a command's output in a file of the step's name, and prints it if the step fails.
step() {
    local name=$1
    shift
    "$@" >"$work/$name" 2>&1 || { echo "tests/package.sh: $name failed:"; cat "$work/$name"; exit 1; } >&2
}
cd "$project"

SECONDS=0
cmake --preset package >/dev/null
cmake --build --preset package >/dev/null
rm -rf "$packages"
cpack --preset package >/dev/null
build_seconds=$SECONDS
lintian --allow-root --no-cfg -i --tag-display-limit 0 "$packages"/*.deb >"$work/lintian" 2>&1 || true

SECONDS=0
step bootstrap mmdebstrap --variant=apt --aptopt='Apt::Install-Recommends "false"' bookworm "$work/root" \
    http://deb.debian.org/debian
mkdir "$work/root/root/packages"
cp "$packages"/*.deb "$work/root/root/packages/"
inside() { chroot "$work/root" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }
# The files in the root, except those that apt itself keeps.
listing() { (cd "$work/root" && find . -xdev \( -path ./proc -o -path ./var -o -path ./root \) -prune -o -print | sort); }
listing >"$work/before"
step update inside apt-get update -qq
step install inside sh -c 'apt-get install -y -qq /root/packages/*.deb'
install_seconds=$SECONDS
[[ -e $work/root/proc/self ]] || mount -t proc proc "$work/root/proc"
step render inside lacuna-render /usr/share/lacuna/scenes/door.glb -o /root/door.png --time 5s --cache /root/cache
step python inside python3 -c '
import lacuna
image = lacuna.render("/usr/share/lacuna/scenes/door.glb", method="bpt", width=64, height=36, iterations=4)
assert image.rgb.mean() > 0.0'
[[ -s $work/root/root/door.png ]]
step purge inside apt-get purge -y -qq --autoremove lacuna liblacuna-dev python3-lacuna
listing >"$work/after"
left=$(comm -13 "$work/before" "$work/after" | grep -i lacuna || true)

{
    echo "# The Debian packages, $(date +%F)"
    echo
    echo "By \`bash tests/package.sh\`, commit $(git describe --always --dirty --exclude='*'), on $(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(nproc) cores."
    echo
    echo "| | |"
    echo "|---|---|"
    for file in "$packages"/*.deb; do
        echo "| $(basename "$file") | $(stat -c %s "$file") bytes, installed $(dpkg-deb -f "$file" Installed-Size) KiB |"
    done
    echo "| build and packages | $build_seconds s |"
    echo "| a clean Debian 12 and \`apt install\` with all it depends on | $install_seconds s |"
    echo "| left after \`apt purge\` | ${left:-nothing} |"
    echo
    echo "Depends: $(dpkg-deb -f "$packages"/lacuna_*.deb Depends)"
    echo
    echo "lintian:"
    echo
    [[ -s $work/lintian ]] && sed 's/^/    /' "$work/lintian" || echo "    nothing"
    echo
    echo "The render in the clean root:"
    echo
    sed 's/^/    /' "$work/render"
} >"$page"
[[ -z $left ]]
