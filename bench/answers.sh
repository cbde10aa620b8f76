# Studies, searches and sensitivities of bench/run, measured on whole runs of mech9k. Uses its $work, $top, $programs and $mode.

# Processor time of a command [s], its words on standard error.
processor_time() {
  local TIMEFORMAT='%U %S'
  { time "$@" >/dev/null 2>>"$work/answers.failed"; } 2>&1 | awk '{ print $1 + $2 }'
}

# The four-bar linkage of bench_positions with the words of standard input behind it.
four_bar_with() {
  cat "$top/bench/data/four_bar.nml" - >"$work/answer.nml"
}

measure_answers() {
  local mech9k=$programs/../bin/mech9k runs=4000 positions=36000 starts=1000
  [ $mode = full ] || { runs=40; positions=360; starts=20; }
  : >"$work/answers.failed"

  four_bar_with <<EOT
&parameter name='crank', sets='pair(2).point(1)', low=0.10, high=0.15 /
&quantity name='swing', of='q3', take='range' /
&study kind='latin', runs=$runs, seed=1 /
EOT
  echo "study $runs $(processor_time "$mech9k" "$work/answer.nml" --set time.intervals=360 --study --quiet --threads 1 --table "$work/answer.dat")"

  : | four_bar_with
  for parameters in 0 10; do
    [ $parameters = 0 ] || for sets in pair\({2,3,4}\).point\({1,2}\) pair\(4\).moving_point\({1,2}\) point\(1\).position\({1,2}\); do
      echo "&parameter name='${sets//[^a-z0-9_]/}', sets='$sets' /"
    done | four_bar_with
    echo "sensitivity$parameters $positions $(processor_time "$mech9k" "$work/answer.nml" --set time.intervals=$positions --quiet \
      --hdf5 "$work/answer.h5" $([ $parameters = 0 ] || echo "--set output.sensitivities=.true."))"
  done

  for example in timed_path five_timed_points; do
    echo "$example $starts $(processor_time "$mech9k" "$top/examples/$example/$example.nml" --set optimum.starts=$starts --optimize --quiet \
      --threads 1 --table "$work/answer.dat")"
  done
}
