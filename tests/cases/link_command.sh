#!/usr/bin/env bash
# mech9-link: makes the samples of user_procs into FOLDER, and says clearly what is wrong with wrong calls.
# usage: link_command.sh MECH9-LINK USER_PROCS FOLDER
set -u
link=$1
samples=$2
folder=$3
failed=0
rm -rf "$folder"
mkdir -p "$folder/with blank"

# expect CODE TEXT COMMAND...: the command ends with this code and says this
expect() {
  local code=$1 text=$2 said answer
  shift 2
  said=$("$@" 2>&1)
  answer=$?
  if [ "$answer" -ne "$code" ] || ! grep -qF -- "$text" <<<"$said"; then
    printf 'FAILED: %s\n  ended with %s, expected %s and "%s"; it said:\n%s\n' "$*" "$answer" "$code" "$text" "$said"
    failed=1
  fi
}

expect 0 'with your user_pair)' "$link" -o "$folder/trammel" "$samples/trammel/trammel.f90"
expect 0 'with your user_pair_values)' \
  "$link" "$samples/trammel/trammel_values.f90" --lto -o "$folder/trammel_values"
expect 0 'with your user_pair_values)' \
  "$link" -o "$folder/cam_follower" "$samples/cam_follower/cam_follower.f90" "$samples/cam_follower/oldcam.f"
expect 0 'with your user_drive)' "$link" -O2 -o "$folder/cycloidal_drive" "$samples/cycloidal_drive/cycloidal_drive.f90"
expect 0 'with your user_drive_values)' \
  "$link" -o "$folder/cycloidal_drive_values" "$samples/cycloidal_drive/cycloidal_drive_values.f90"
expect 0 'with your user_coupling)' "$link" -o "$folder/cardan_coupling" "$samples/cardan_coupling/cardan_coupling.f90"
expect 0 'with your user_coupling_values)' \
  "$link" -o "$folder/cardan_coupling_values" "$samples/cardan_coupling/cardan_coupling_values.f90"
expect 0 'with your user_force)' "$link" -o "$folder/air_drag" "$samples/air_drag/air_drag.f90"

# several hooks in one program, names with blanks, every template compiles
cp "$samples"/templates/*.f90 "$folder/with blank"
expect 0 'with your user_coupling user_drive user_force user_pair)' \
  "$link" -o "$folder/with blank/all" "$folder/with blank/user_pair.f90" "$folder/with blank/user_drive.f90" \
  "$folder/with blank/user_force.f90" "$folder/with blank/user_coupling.f90"
expect 0 'with your user_coupling_values user_drive_values user_pair_values)' "$link" -v -o "$folder/with blank/values" \
  "$folder/with blank/user_pair_values.f90" "$folder/with blank/user_drive_values.f90" \
  "$folder/with blank/user_coupling_values.f90"

expect 0 'mech9-link -o NAME FILE...' "$link" --help
expect 0 'mech9-link 0.' "$link" --version
expect 2 'no name given' "$link" "$samples/trammel/trammel.f90"
expect 2 'no file given' "$link" -o "$folder/none"
expect 2 '-o needs a name' "$link" -o
expect 2 'unknown option --fast' "$link" --fast -o "$folder/none" "$samples/trammel/trammel.f90"
expect 2 'what is it?' "$link" -o "$folder/none" "$samples/trammel/trammel.nml"
expect 8 'there is no file nowhere.f90' "$link" -o "$folder/none" nowhere.f90
expect 8 'there is no folder' "$link" -o "$folder/nowhere/none" "$samples/trammel/trammel.f90"
expect 1 'the compiler no-such-compiler is not here' \
  env MECH9_FC=no-such-compiler "$link" -o "$folder/none" "$samples/trammel/trammel.f90"

# --debug: subscripts in the user's code are checked, which a call of a procedure of ours need not be told
sed 's/parameters(1), 0.0_wp, 0.0_wp/parameters(1)*state%dq(nint(parameters(2))), 0.0_wp, 0.0_wp/' \
  "$samples/templates/user_force.f90" >"$folder/beyond.f90"
expect 0 'with your user_force)' "$link" --debug -o "$folder/beyond" "$folder/beyond.f90"
cat >"$folder/beyond.nml" <<'END'
&mechanism links=2, coordinates=1 /
&structure cq=1 /
&pair coordinate=1, links=1,2, kind='prismatic', axis=1,0,0 /
&initial coordinate=1, position=0.0, velocity=0.0 /
&body link=2, mass=1.0 /
&load kind='user' /
&user parameters=1.0, 1 /
&time start=0.0, end=1.0, intervals=10 /
END
expect 0 '' "$folder/beyond_d" --no-write "$folder/beyond.nml"
expect 2 "'state%dq' above upper bound" "$folder/beyond_d" --no-write "$folder/beyond.nml" --set user.parameters=1,9

# the compiler holds the user's argument list against the hook's
sed 's/type(taylor), intent(in) :: q/real(wp), intent(in) :: q/' "$samples/trammel/trammel.f90" >"$folder/wrong.f90"
expect 1 'does not compile' "$link" -o "$folder/none" "$folder/wrong.f90"
expect 1 'none of the files holds a user procedure' "$link" -o "$folder/none" "$samples/cam_follower/oldcam.f"
if ls "$folder"/none* >/dev/null 2>&1; then
  echo 'FAILED: a failed call left a program behind'
  failed=1
fi
exit $failed
