#!/usr/bin/env bash
# Tries what README.md says in a bare Debian of another release, with either compiler. What is tried is the last commit.
#   scripts/matrix.sh 12|13|14 [clang|gcc] [demo|rooms|tests|pip|tarball|container|arm64]
# demo (the default): README's first command: installs, builds, renders data/gcode/hull.gcode; tests: that, and README's second
# command, without the tests of programs that the release lacks; rooms: the tests of the libraries alone; pip: `pip install .`
# in a virtual environment; tarball: what scripts/tarball.sh has made here renders hull.gcode where nothing is installed;
# container: the image of Dockerfile, by buildah on that release, makes a level set on a read-only root without being root;
# arm64: rooms, cross-compiled by this machine's clang with that release's libraries, and run under qemu-user.
# The release is unpacked once, into build/matrix, with a build folder for each compiler. Needs root and mmdebstrap.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/packages.sh

declare -A names=([12]=bookworm [13]=trixie [14]=forky)
release=${1:-}
compiler=${2:-clang}
what=${3:-demo}
if [[ -z "${names[$release]:-}" || ! $compiler =~ ^(clang|gcc)$ || ! $what =~ ^(demo|rooms|tests|pip|tarball|container|arm64)$ ]]; then
    sed -n '2,9s/^# \{0,1\}//p' "$0" >&2
    exit 2
fi
[[ $(id -u) -eq 0 ]] || { echo "matrix.sh: run this as root: a release is unpacked and entered with chroot" >&2; exit 2; }
install_packages mmdebstrap git

# bare FOLDER PACKAGES: the release with little more than apt.
bare() {
    [[ ! -e $1.complete ]] || return 0
    rm -rf "$1"
    mkdir -p "$(dirname "$1")"
    # A mirror's copy of testing may be some weeks old.
    mmdebstrap --variant=minbase --include="$2" --aptopt='Acquire::Check-Valid-Until "false"' "${names[$release]}" "$1" \
        "${STRATUM_MIRROR:-http://deb.debian.org/debian}"
    touch "$1.complete"
}

tried=$(git rev-parse --short HEAD)
if [[ $what == arm64 ]]; then
    install_packages clang lld cmake ninja-build qemu-user-static
    # CMake refuses include folders below the sources.
    sysroot=/var/tmp/stratum-arm64-$release
    if [[ ! -e $sysroot.complete ]]; then
        rm -rf "$sysroot"
        libraries=$(printf '%s\n' "${BUILD_PACKAGES[@]}" | grep -E '^(lib|zlib|nlohmann|pkg-config)' | paste -sd,)
        mmdebstrap --architectures=arm64 --variant=extract --aptopt='Acquire::Check-Valid-Until "false"' \
            --include="$libraries,libgtest-dev,libstdc++-12-dev" "${names[$release]}" "$sysroot" \
            "${STRATUM_MIRROR:-http://deb.debian.org/debian}"
        # The linker would look for what absolute links name on this machine.
        find "$sysroot" -type l -lname '/*' | while read -r link; do
            ln -sfnr "$sysroot$(readlink "$link")" "$link"
        done
        touch "$sysroot.complete"
    fi
    export STRATUM_SYSROOT=$sysroot
    cmake --preset release -B build/arm64 -DCMAKE_TOOLCHAIN_FILE=cmake/arm64.toolchain.cmake -DSTRATUM_PYTHON=OFF
    cmake --build build/arm64
    ctest --test-dir build/arm64 -LE 'client|slow|study|python' -j "$(nproc)" --output-on-failure
    echo "Debian $release, arm64: rooms passed at $tried"
    exit
fi
if [[ $what == container ]]; then
    [[ $release == 13 ]] || { echo "matrix.sh: the Dockerfile is of Debian 13" >&2; exit 2; }
    install_packages buildah
    export STORAGE_DRIVER=vfs BUILDAH_ISOLATION=chroot prints
    empty=$PWD/build/matrix/debian-$release-empty
    bare "$empty" ca-certificates
    sources=$(mktemp -d)
    prints=$(mktemp -d)
    git archive HEAD | tar -x -C "$sources"
    cp data/gcode/hull.gcode "$prints"
    chown -R 1000:1000 "$prints"
    base=$(buildah from scratch)
    tar -C "$empty" --one-file-system --exclude=./stratum --exclude=./corpus -cf "$sources/base.tar" .
    buildah add -q "$base" "$sources/base.tar" / >/dev/null
    rm "$sources/base.tar"
    for tag in 13 13-slim; do buildah commit -q "$base" "docker.io/library/debian:$tag" >/dev/null; done
    buildah bud --pull-never -t stratum "$sources"
    tool=$(buildah from --pull-never stratum)
    inside=$(buildah mount "$tool")
    export inside
    # As `docker run --read-only --user 1000` has it: nothing but /prints can be written.
    unshare --mount --propagation private bash -euc '
        mount --bind "$inside" "$inside"
        mount --rbind /dev "$inside/dev"
        mkdir -p "$inside/prints"
        mount --bind "$prints" "$inside/prints"
        mount -o remount,bind,ro "$inside"
        chroot --userspec=1000:1000 "$inside" sh -euc "
            cd /prints
            ! touch /tmp/x 2>/dev/null
            gcode2vdb hull.gcode -o hull.vdb
            vdbtrace hull.vdb -o hull.png --size 320x240
            vdbview --version
            ls -l"'
    buildah rm "$base" "$tool" >/dev/null
    rm -rf "$sources" "$prints"
    echo "Debian $release: container passed at $tried"
    exit
fi
export root=$PWD/build/matrix/debian-$release builds="" cxx=clang++ corpus=$PWD/${STRATUM_CORPUS:-../shared/corpus}
[[ $compiler == clang ]] || cxx=g++
[[ ${STRATUM_CORPUS:-} != /* ]] || corpus=$STRATUM_CORPUS
if [[ $what == tarball ]]; then
    root=$root-empty
    bare "$root" ca-certificates
    rm -rf "$root/stratum"
    mkdir -p "$root/stratum"
    tar -xzf build/bundle/stratum-*.tar.gz -C "$root/stratum" --strip-components=1
    cp data/gcode/hull.gcode "$root/stratum/"
else
    bare "$root" ca-certificates,git,python3
    if [[ ! -d $root/stratum/.git ]]; then git clone -q --no-hardlinks . "$root/stratum"; fi
    git -C "$root/stratum" fetch -q "$PWD" HEAD
    git -C "$root/stratum" checkout -q --detach FETCH_HEAD
    # CMake forgets a cache's other variables where the compiler changes.
    builds=$PWD/build/matrix/builds-$release-$compiler
    mkdir -p "$builds" "$root/stratum/build"
    git config --file "$root/root/.gitconfig" --replace-all safe.directory /stratum
fi

case $what in
    demo) commands="bash scripts/demo.sh" ;;
    rooms) commands="bash scripts/test.sh -LE 'client|slow|study|python'" ;;
    tests) commands="bash scripts/demo.sh && bash scripts/test.sh" ;;
    pip) commands='
        source scripts/packages.sh
        install_packages "${BUILD_PACKAGES[@]}"
        install_packages --available python3-pip python3-venv python3-scikit-build-core
        rm -rf /tmp/environment
        python3 -m venv --system-site-packages /tmp/environment
        # Without asking PyPI where Debian has what builds it.
        isolation=
        if python3 -c "import scikit_build_core" 2>/dev/null; then isolation=--no-build-isolation; fi
        /tmp/environment/bin/pip install $isolation --no-deps .
        cd /tmp
        cp /stratum/data/gcode/hull.gcode .
        environment/bin/gcode2vdb hull.gcode -o hull.vdb
        environment/bin/vdbtrace hull.vdb -o hull.png --size 320x240 --brdf pla-blue
        environment/bin/python3 -c "import stratum; assert stratum.__file__.startswith(\"/tmp/environment\"), stratum.__file__
assert stratum.render(\"hull.gcode\", size=(64, 48), spp=1, brdf=\"pla-blue\").srgb.std() > 5"' ;;
    tarball) commands='
        for tool in bin/gcode2vdb bin/vdbtrace bin/vdbview bin/vdbmerge bin/vdbstudy; do $tool --version | head -n 1; done
        TIMEFORMAT="100 times --version: %R s"
        time for n in {1..100}; do bin/gcode2vdb --version >/dev/null; done
        bin/gcode2vdb hull.gcode -o hull.vdb
        bin/vdbtrace hull.vdb -o hull.png --size 320x240 --brdf pla-blue
        ls -l hull.vdb hull.png
        md5sum hull.vdb hull.png' ;;
esac

export commands
# Mounts of its own, which end with the shell.
unshare --mount --propagation private bash -euc '
    mount -t proc proc "$root/proc"
    mount --rbind /dev "$root/dev"
    [[ -z $builds ]] || mount --bind "$builds" "$root/stratum/build"
    if [[ -d $corpus ]]; then mkdir -p "$root/corpus"; mount --bind "$corpus" "$root/corpus"; fi
    exec chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LANG=C.UTF-8 STRATUM_CXX="$cxx" \
        STRATUM_CORPUS=/corpus bash -euc "cd /stratum && $commands"'
echo "Debian $release, $compiler: $what passed at $tried"
