#!/usr/bin/env bash
# examples/run in a project that was moved with its build folder: it says so and configures anew. A stand-in for cmake
# refuses, as cmake does, a cache that was made for another place.
#
# usage: moved_build.sh TREE
set -euo pipefail
tree=$1
folder=$(cd "$(mktemp -d)" && pwd -P)
trap 'rm -rf "$folder"' EXIT

fail() {
  echo "FAILED: $*"
  exit 1
}

project=$folder/project
mkdir -p "$project/examples" "$project/cmake" "$project/build/release/CMakeFiles" "$project/build/release/bin" "$folder/tools"
cp "$tree/examples/run" "$tree/examples/list.txt" "$project/examples/"
echo 'need_packages() { :; }' >"$project/cmake/packages.sh"
cat >"$folder/tools/cmake" <<'END'
#!/usr/bin/env bash
if [ "$1" = --preset ]; then
  cache=build/release/CMakeCache.txt
  [ ! -f $cache ] || grep -q "^CMAKE_HOME_DIRECTORY:INTERNAL=$PWD\$" $cache || { echo "made for another place"; exit 1; }
  echo "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" >$cache
fi
END
cat >"$project/build/release/bin/mech9k" <<'END'
#!/usr/bin/env bash
while [ $# -gt 0 ]; do
  if [ "$1" = --table ]; then printf '# title\nt q1\n0 0\n' >"$2"; fi
  shift
done
END
chmod +x "$folder/tools/cmake" "$project/build/release/bin/mech9k"
PATH=$folder/tools:$PATH
unset MECH9_BIN

echo "CMAKE_HOME_DIRECTORY:INTERNAL=/elsewhere/project" >"$project/build/release/CMakeCache.txt"
said=$("$project/examples/run" fig1 2>&1) || fail "the moved build folder is not noticed: $said"
grep -q "build/release was made for the project in /elsewhere/project" <<<"$said" || fail "nothing is said: $said"
said=$("$project/examples/run" fig1 2>&1) || fail "the second time: $said"
! grep -q "was made for" <<<"$said" || fail "a build folder in its place is configured anew: $said"
echo "a moved build folder is configured anew"
