# Installs the Debian packages that building and testing need. Sourced by examples/run and tests/run:
#   . cmake/packages.sh && need_packages build pictures tests
# Does nothing, quickly and without network, when all are there.

# The lists: what a build needs, what draws the pictures, what the tests need besides, the browser that shows them pages, without which
# those are not tested, what makes Debian packages, and what judges and tries them. libc6-dev is only a recommendation of gcc, so that
# a minimal system can have a compiler that cannot link; with make, parts of the library are optimised together side by side.
packages_build="gfortran libc6-dev make cmake ninja-build liblapack-dev libsundials-dev libsundials-fortran-dev libedit-dev libhdf5-dev libexpat1-dev libnlopt-dev"
packages_pictures="gnuplot-nox graphviz"
packages_tests="python3 python3-pytest python3-numpy python3-h5py python3-xarray python3-h5netcdf python3-pandas python3-distributed hdf5-tools groff-base libopenmpi-dev openmpi-bin auto-07p"
packages_browser="chromium"
packages_packages="libopenmpi-dev openmpi-bin dpkg-dev file"
packages_trials="lintian debootstrap python3-venv"

# The packages among the arguments that are not installed.
missing_packages() {
  local package
  for package in "$@"; do
    case $(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null) in
      installed) ;;
      *) printf '%s ' "$package" ;;
    esac
  done
}

# Run a command as root: directly, or through sudo.
as_root() {
  if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

# Install what is missing of the named lists (build, pictures, tests, browser, packages, trials).
need_packages() {
  local list wanted="" missing
  for list in "$@"; do
    case $list in
      build) wanted="$wanted $packages_build" ;;
      pictures) wanted="$wanted $packages_pictures" ;;
      tests) wanted="$wanted $packages_tests" ;;
      browser) wanted="$wanted $packages_browser" ;;
      packages) wanted="$wanted $packages_packages" ;;
      trials) wanted="$wanted $packages_trials" ;;
      *) echo "need_packages: no list named $list" >&2; return 1 ;;
    esac
  done
  if ! command -v dpkg-query >/dev/null 2>&1; then
    echo "This is no Debian system; Debian's names of what is needed are:$wanted" >&2
    return 0
  fi
  missing=$(missing_packages $wanted)
  [ -n "$missing" ] || return 0

  echo "Installing Debian packages: $missing"
  if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null 2>&1; then
    echo "This needs root, and there is no sudo. As root, run: apt-get install $missing" >&2
    return 1
  fi
  local install="apt-get install -y -qq --no-install-recommends -o Acquire::Retries=3 -o Dpkg::Use-Pty=0"
  as_root apt-get update -qq -o Acquire::Retries=3 ||
    echo "apt-get update failed; trying with the package lists that are here" >&2
  if ! as_root env DEBIAN_FRONTEND=noninteractive $install $missing >/dev/null; then
    echo "Could not install: $missing" >&2
    return 1
  fi
}
