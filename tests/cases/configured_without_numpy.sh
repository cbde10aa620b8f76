#!/usr/bin/env bash
# Without Python and numpy a build is configured all the same: a warning tells that the scripts in Python are left out.
#
# usage: configured_without_numpy.sh CMAKE CTEST TREE FORTRAN_COMPILER
set -euo pipefail
cmake=$1 ctest=$2 tree=$3 compiler=$4
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
  echo "FAILED: $*"
  exit 1
}

"$cmake" -S "$tree" -B "$folder/build" -G Ninja -DCMAKE_Fortran_COMPILER="$compiler" -DMECH9_BUILD_TESTS=ON \
  -DMECH9_TEST_PYTHON=false >"$folder/log" 2>&1 || { cat "$folder/log"; fail "cmake does not configure"; }
tr -s ' \n' ' ' <"$folder/log" | grep -q "Python 3 with numpy" || fail "nothing tells that Python is not there"
tests=$("$ctest" --test-dir "$folder/build" -N)
grep -q ' test_rotation$' <<<"$tests" || fail "a test in Fortran is missing"
grep -q ' moved_build$' <<<"$tests" || fail "a test in bash is missing"
for name in accuracy stress malformed_mech9k line_input session_behaviour; do
  ! grep -q " $name\$" <<<"$tests" || fail "$name would need Python"
done
echo "configured without numpy"
