#!/usr/bin/env bash
# The installed tree, moved to another place: a user's CMake project, and mech9-link with its samples.
# usage: installed_package.sh CMAKE BUILD PROJECT FOLDER [CMAKE-OPTION...]
set -eu
cmake=$1
build=$2
project=$3
folder=$4
shift 4
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
rm -rf "$folder"
mkdir -p "$folder"

"$cmake" --install "$build" --prefix "$folder/first" >"$folder/install.log"
mv "$folder/first" "$folder/moved"
[ -x "$folder/moved/bin/mech9k" ]
samples=$folder/moved/share/mech9/user_procs

"$cmake" -S "$project" -B "$folder/project" -G Ninja -DCMAKE_PREFIX_PATH="$folder/moved" -DSAMPLES="$samples" "$@" \
  >"$folder/configure.log" 2>&1 || { cat "$folder/configure.log"; exit 1; }
"$cmake" --build "$folder/project" >"$folder/build.log" 2>&1 || { cat "$folder/build.log"; exit 1; }

"$here/link_command.sh" "$folder/moved/bin/mech9-link" "$samples" "$folder/linked"
