# What the scripts of this folder share. Sourced:
#   . "$(dirname "${BASH_SOURCE[0]}")/common.sh"
# A script ends with exit code 77 where this machine cannot do its work; its last line is the reason.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$top"
. cmake/packages.sh
version=$(sed -nE 's/^project\(MECH9 VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)
packages=build/packages
work=build/packaging
mkdir -p "$packages" "$work"

# End with a reason, where this machine lacks something.
left_out() {
  echo "$1"
  exit 77
}

# Set `compiled` to the folder of a release build, whose objects of the library all packages are linked from: that of the variable
# MECH9_COMPILED, or build/packaging/compiled. Options that do not belong into packages are refused.
compile_library() {
  need_packages build
  compiled=${MECH9_COMPILED:-$work/compiled}
  [ -n "${MECH9_COMPILED:-}" ] || cmake -S . -B "$compiled" -G Ninja -DCMAKE_BUILD_TYPE=Release -DMECH9_BUILD_TESTS=OFF
  compiled=$(cd "$compiled" && pwd)
  if ! grep -q '^CMAKE_BUILD_TYPE:STRING=Release$' "$compiled/CMakeCache.txt" || grep -q '^MECH9_NATIVE:BOOL=ON$' "$compiled/CMakeCache.txt"; then
    echo "$compiled is no release build for all machines" >&2
    exit 1
  fi
  cmake --build "$compiled" --target mech9 --parallel "$(nproc)"
}

# Set `root` to the folder of a clean system of Debian, build/packaging/NAME: clean_system SUITE NAME. debootstrap makes a first one,
# which is kept and copied.
clean_system() {
  local first=$work/$1.first
  root=$work/$2
  [ "$(id -u)" -eq 0 ] || left_out "a clean system of Debian needs root"
  unshare --mount --propagation private mount -t tmpfs tmpfs "$work" 2>/dev/null ||
    left_out "a clean system of Debian needs mounts of its own, which this machine does not allow"
  if [ ! -e "$first/made" ]; then
    command -v debootstrap >/dev/null || need_packages trials || left_out "debootstrap is not installed"
    remove_system "$first"
    debootstrap --variant=minbase "$1" "$first" >"$work/debootstrap.log" 2>&1 ||
      left_out "debootstrap did not make a system of $1: $(tail -n 1 "$work/debootstrap.log")"
    printf 'APT::Install-Recommends "false";\nDpkg::Use-Pty "false";\nquiet "2";\n' >"$first/etc/apt/apt.conf.d/trial"
    touch "$first/made"
  fi
  remove_system "$root"
  cp -a "$first" "$root"
}

# Remove a system, unless something is mounted in it.
remove_system() {
  local folder
  folder=$(realpath -m "$1")
  if grep -q " $folder/" /proc/self/mounts; then
    echo "$folder has mounts" >&2
    exit 1
  fi
  rm -rf --one-file-system "$folder"
}

# Run a command in the system `root`. What is mounted for it, nobody else sees, and it goes with the command.
inside() {
  unshare --mount --propagation private sh -c '
    root=$1; shift
    mount -t proc proc "$root/proc"
    mount -t sysfs -o ro sysfs "$root/sys" || true
    mount -t tmpfs tmpfs "$root/dev/shm"
    exec chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"
  ' sh "$root" "$@"
}

# NumPy's wheel for a version of Python in build/packaging/numpy, so that the trials need no network.
fetch_numpy() {
  compgen -G "$work/numpy/numpy-*-cp${1/./}-*.whl" >/dev/null ||
    "$work/tools/bin/pip" download --quiet --no-deps --only-binary :all: --python-version "$1" --dest "$work/numpy" "numpy>=1.21" ||
    left_out "pip could not download NumPy for Python $1"
}
