# Sourced by the other scripts: installs Debian packages that are missing, and is quick when none is.

# install_packages [--available] NAME...: with --available without those that this release of Debian does not have.
# A|B: the one that the release has.
install_packages() {
    local missing=() wanted=() name available=no
    if [[ "$1" == --available ]]; then
        available=yes
        shift
    fi
    for name in "$@"; do
        dpkg-query -W -f='${Status} ' ${name//|/ } 2>/dev/null | grep -q 'ok installed' || missing+=("$name")
    done
    [ ${#missing[@]} -eq 0 ] && return 0
    local run=()
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo >/dev/null || { echo "Run this as root: packages must be installed: ${missing[*]}" >&2; return 1; }
        run=(sudo)
    fi
    "${run[@]}" apt-get update -q >/dev/null
    for name in "${missing[@]}"; do
        [[ $name != *'|'* || -n "$(apt-cache madison "${name%%|*}")" ]] || name=${name#*|}
        name=${name%%|*}
        if [[ $available == yes && -z "$(apt-cache madison "$name")" ]]; then
            echo "This release of Debian has no $name: the tests that need it are skipped."
        else
            wanted+=("$name")
        fi
    done
    [ ${#wanted[@]} -eq 0 ] && return 0
    echo "Installing: ${wanted[*]}"
    "${run[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${wanted[@]}" >/dev/null
}

# STRATUM_CXX names another compiler than clang++, e.g. g++.
compiler_choice() {
    [[ -z "${STRATUM_CXX:-}" ]] || echo "-DCMAKE_CXX_COMPILER=$STRATUM_CXX"
}

# What the tools are built with. Why clang: docs/benchmarks.md, "Compilers".
BUILD_PACKAGES=(clang lld ccache cmake ninja-build libopenvdb-dev libnanovdb-dev libboost-dev libboost-iostreams-dev libtbb-dev libblosc-dev liblz4-dev
    libopenexr-dev libglm-dev libpng-dev libssl-dev libcli11-dev libfmt-dev nlohmann-json3-dev libfast-float-dev
    libassimp-dev libhwy-dev libdeflate-dev libjpeg62-turbo-dev libwebp-dev zlib1g-dev libzip-dev libstb-dev libeigen3-dev libqoi-dev
    pkg-config     pybind11-dev python3-dev python3-numpy)
[[ ${STRATUM_CXX:-} != g++ ]] || BUILD_PACKAGES+=(g++)
# What the tests need besides: the test library and the real programs that our files must work in. The daemons of Slurm
# are started by their test, not as services of the machine. GCC compiles the programs of others that use our libraries.
TEST_PACKAGES=(g++ admesh calculix-ccx ffmpeg 'lib3mf1|lib3mf1t64' libgtest-dev libopenvdb-tools libnanovdb-tools blender python3 python3-openvdb mypy
    prusa-slicer slurmctld slurmd slurm-client munge chromium chromium-driver python3-selenium python3-pandas python3-matplotlib appstream desktop-file-utils
    shared-mime-info libxml2-utils dpkg-dev file mmdebstrap xvfb locales libgl1-mesa-dri libx11-6 tesseract-ocr)
# What the benchmarks (-DSTRATUM_BENCH=ON) measure against, and draw with.
BENCH_PACKAGES=(libembree-dev python3-matplotlib)
