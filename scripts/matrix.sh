#!/usr/bin/env bash
# Runs what README.md says in a bare Debian of another release, with either compiler: installs, builds, and renders
# data/gcode/hull.gcode; with `tests` also builds and runs the tests, but those of programs that the release lacks.
#   scripts/matrix.sh 12|13|14 [clang|gcc] [demo|rooms|tests]
# demo (the default) is README's first command, tests its second, rooms the tests of the libraries alone. The release is
# unpacked once, into build/matrix, with a build folder for each compiler; what is tested is the last commit. Needs root
# and mmdebstrap.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

declare -A names=([12]=bookworm [13]=trixie [14]=forky)
release=${1:-}
compiler=${2:-clang}
what=${3:-demo}
if [[ -z "${names[$release]:-}" || ! $compiler =~ ^(clang|gcc)$ || ! $what =~ ^(demo|rooms|tests)$ ]]; then
    sed -n '2,7s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
[[ $(id -u) -eq 0 ]] || { echo "matrix.sh: run this as root: a release is unpacked and entered with chroot" >&2; exit 2; }
install_packages mmdebstrap git

root=$PWD/build/matrix/debian-$release
if [[ ! -e $root.complete ]]; then
    rm -rf "$root"
    mkdir -p "$(dirname "$root")"
    mmdebstrap --variant=minbase --include=ca-certificates,git,python3 "${names[$release]}" "$root" \
        "${STRATUM_MIRROR:-http://deb.debian.org/debian}"
    touch "$root.complete"
fi
if [[ ! -d $root/stratum/.git ]]; then git clone -q --no-hardlinks . "$root/stratum"; fi
git -C "$root/stratum" fetch -q "$PWD" HEAD
git -C "$root/stratum" checkout -q --detach FETCH_HEAD

commands="bash scripts/demo.sh"
[[ $what == rooms ]] && commands="bash scripts/test.sh -LE 'client|slow|study|python'"
[[ $what == tests ]] && commands="bash scripts/demo.sh && bash scripts/test.sh"
cxx=clang++
[[ $compiler == gcc ]] && cxx=g++
# CMake forgets a cache's other variables where the compiler changes.
export builds=$PWD/build/matrix/builds-$release-$compiler
mkdir -p "$builds" "$root/stratum/build"
export root commands cxx corpus=$PWD/${STRATUM_CORPUS:-../shared/corpus}
[[ ${STRATUM_CORPUS:-} == /* ]] && corpus=$STRATUM_CORPUS
# Mounts of its own, which end with the shell.
unshare --mount --propagation private bash -euc '
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    mount --bind "$builds" "$root/stratum/build"
    if [[ -d $corpus ]]; then mkdir -p "$root/corpus"; mount --bind "$corpus" "$root/corpus"; fi
    exec chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 STRATUM_CXX="$cxx" \
        STRATUM_CORPUS=/corpus bash -euc "cd /stratum && git config --global --add safe.directory /stratum && $commands"'
echo "Debian $release, $compiler: $what passed at $(git -C "$root/stratum" rev-parse --short HEAD)"
