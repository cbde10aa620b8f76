#!/usr/bin/env bash
# The installed tree, moved to another place: a user's CMake project, the programs of examples/library, and mech9-link with its
# samples.
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

library=$(cd "$here/../../examples/library" && pwd)
"$cmake" -S "$library" -B "$folder/library" -G Ninja -DCMAKE_PREFIX_PATH="$folder/moved" "$@" \
  >"$folder/configure_library.log" 2>&1 || { cat "$folder/configure_library.log"; exit 1; }
"$cmake" --build "$folder/library" >"$folder/build_library.log" 2>&1 || { cat "$folder/build_library.log"; exit 1; }
(cd "$library" && "$folder/library/from_file" >"$folder/from_file.txt")
"$folder/library/from_values" >"$folder/from_values.txt"
[ "$(wc -l <"$folder/from_file.txt")" -eq 13 ]
[ "$(wc -l <"$folder/from_values.txt")" -eq 11 ]

"$here/link_command.sh" "$folder/moved/bin/mech9-link" "$samples" "$folder/linked"
