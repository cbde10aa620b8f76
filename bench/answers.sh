# Studies, searches and sensitivities of bench/run, measured on whole runs of mech9k. Uses its $work, $top, $programs and $mode.

# A row: a name, how many runs, positions or starts it has, and the processor time of a command [s], which must succeed.
row_of() {
  local name=$1 count=$2 TIMEFORMAT='%U %S' spent
  shift 2
  if ! spent=$({ time "$@" >/dev/null 2>"$work/answer.failed"; } 2>&1); then
    cat "$work/answer.failed" >&2
    echo "bench/run: this command failed: $*" >&2
    exit 1
  fi
  awk -v name="$name" -v count="$count" '{ print name, count, $1 + $2 }' <<<"$spent"
}

# The four-bar linkage of bench_positions with the words of standard input behind it.
four_bar_with() {
  cat "$top/bench/data/four_bar.nml" - >"$work/answer.nml"
}

measure_answers() {
  local mech9k=$programs/../bin/mech9k runs=4000 positions=36000 starts=1000 sets example
  [ $mode = full ] || { runs=40; positions=360; starts=20; }

  four_bar_with <<EOT
&parameter name='crank', sets='pair(2).point(1)', low=0.10, high=0.15 /
&quantity name='swing', of='q3', take='range' /
&study kind='latin', runs=$runs, seed=1 /
EOT
  row_of study $runs "$mech9k" "$work/answer.nml" --set time.intervals=360 --study --quiet --threads 1 --table "$work/answer.dat"

  local to_file=(--set "time.intervals=$positions" --quiet --hdf5 "$work/answer.h5")
  four_bar_with </dev/null
  row_of plain $positions "$mech9k" "$work/answer.nml" "${to_file[@]}"
  for sets in pair\({2,3,4}\).point\({1,2}\) pair\(4\).moving_point\({1,2}\) point\(1\).position\({1,2}\); do
    echo "&parameter name='${sets//[^a-z0-9_]/}', sets='$sets' /"
  done | four_bar_with
  row_of sensitivity $positions "$mech9k" "$work/answer.nml" "${to_file[@]}" --set output.sensitivities=.true.

  for example in timed_path five_timed_points; do
    row_of $example $starts "$mech9k" "$top/examples/$example/$example.nml" --set optimum.starts=$starts --optimize --quiet --threads 1 \
      --table "$work/answer.dat"
  done
}
