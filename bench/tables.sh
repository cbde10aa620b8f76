# The text of bench/benchmarks.md, from what bench/run measured. Uses its $work, $top, $programs, $mode, $problems and words.

machine() {
  local model cores
  model=$(sed -n 's/^model name[[:space:]]*: //p' /proc/cpuinfo | head -n 1)
  cores=$(nproc)
  echo "${model:-a processor without a name}, $cores cores; $(uname -sr)"
}

# name, median times and ratios of each mechanism
position_table() {
  cat <<'EOT'
| mechanism | links, coordinates | positions [µs] | ratio | with velocities, accelerations and a point [µs] | ratio |
| --- | --- | --- | --- | --- | --- |
EOT
  awk '
    BEGIN {
      name["closed_form"] = "four-bar, closed form"; size["closed_form"] = ""
      name["four_bar"] = "four-bar"; size["four_bar"] = "4, 4"
      name["six_bar"] = "six-bar"; size["six_bar"] = "6, 7"
      name["fig1"] = "Fig. 1"; size["fig1"] = "6, 7"
      name["rsur"] = "spatial R-S-U-R"; size["rsur"] = "7, 7"
      name["stewart_gough"] = "Stewart-Gough platform"; size["stewart_gough"] = "14, 36"
      name["legs"] = "pair of legs"; size["legs"] = "31, 36"
    }
    NR > 1 { printf "| %s | %s | %.3f | %.1f | %.3f | %.1f |\n", name[$1], size[$1], $2, $4, $3, $5 }
  ' "$work/positions.dat"
  # the other program has no point
  awk -F '\t' '
    NR == FNR { if ($1 ~ /^closed_form/) { split($0, cell, " "); place = cell[2]; all = cell[3] } next }
    NF == 4 { printf "| four-bar, %s | 4, 4 | %.3f | %.1f | %.3f | %.1f |\n", $1, $2, $2 / place, $3, $3 / all }
  ' "$work/positions.dat" "$work/positions.others"
}

# whole runs of mech9k: their processor time, and the time of one of their positions, parameters or starts
answers_table() {
  cat <<'EOT'
| whole run | processor time [s] | of one |
| --- | --- | --- |
EOT
  awk '
    NR == FNR { if ($1 == "four_bar") position = $3; next }
    $1 == "study" {
      each = 1e6 * $3 / $2 / 361
      printf "| study of %d four-bars, 361 positions of each, the range of a coordinate | %.3f | %.3f µs a position, %.2f of the table above |\n", $2, $3,
        each, each / position
    }
    $1 == "plain" { plain = $3; printf "| four-bar, %d positions to an HDF5 file | %.3f | %.2f µs a position |\n", $2, $3, 1e6 * $3 / $2 }
    $1 == "sensitivity" {
      printf "| the same with derivatives of all columns by ten parameters | %.3f | %.2f µs a position, %.1f times as long |\n", $3, 1e6 * $3 / $2, $3 / plain
    }
    $1 == "timed_path" { printf "| search for eighteen timed points, %d starts | %.2f | %.1f ms a start |\n", $2, $3, 1e3 * $3 / $2 }
    $1 == "five_timed_points" { printf "| search for five timed points, %d starts | %.2f | %.1f ms a start |\n", $2, $3, 1e3 * $3 / $2 }
  ' "$work/positions.dat" "$work/answers.dat"
}

# versions and settings of other programs, once each, and where they have no rows
settings_list() {
  cat "$work"/*.others | awk '$1 == "setting" && !seen[$2]++ { sub(/^setting /, ""); print "-", $0 }'
  sed -n 's/^missing \([^ ]*\).*/\1/p' "$work"/*.others "$work/others.dat" | sort -u | paste -sd ',' |
    sed 's/,/, /g; /./s/^/- not installed on this machine, and not measured: /'
}

# times of an objective and their ratios to a position
synthesis_table() {
  cat <<'EOT'
| | time [µs] | positions of the four-bar linkage |
| --- | --- | --- |
EOT
  awk '
    NR > 1 {
      printf "| a position of the four-bar linkage | %.3f | 1 |\n", $1
      printf "| a value beside a known run | %.2f | %.1f |\n", $2, $4
      printf "| its gradient by nine parameters | %.2f | %.1f |\n", $3, $5
      printf "| a value whose run is followed from its start | %.1f | %.1f |\n", $6, $6 / $1
    }
  ' "$work/synthesis.dat"
}

# the least time of any run of a method whose error is below a bound
precision_table() {
  cat <<'EOT'
| method | 1e-4 | 1e-6 | 1e-8 | 1e-10 | least error |
| --- | --- | --- | --- | --- | --- |
EOT
  awk '
    NR > 1 {
      if (!($1 in least)) { order[++n] = $1; least[$1] = $3 }
      if ($3 < least[$1]) least[$1] = $3
      for (p = 4; p <= 10; p += 2)
        if ($3 <= 10 ^ -p && (!(($1, p) in time) || $4 < time[$1, p])) { time[$1, p] = $4; work[$1, p] = $5 }
    }
    END {
      for (i = 1; i <= n; i++) {
        printf "| %s |", order[i] == "by-hand" ? "by hand" : order[i]
        for (p = 4; p <= 10; p += 2)
          if ((order[i], p) in time) printf " %.3g ms, %d |", 1000 * time[order[i], p], work[order[i], p]
          else printf " - |"
        printf " %.1e |\n", least[order[i]]
      }
    }
  ' "$work/$1.dat"
}

# the least times to 1e-8 by the program and by hand with the same integrator, one over the other
hand_ratio() {
  awk '
    NR > 1 && $3 <= 1e-8 && (!($1 in time) || $4 < time[$1]) { time[$1] = $4 }
    END { printf "%.2f", time["prince-dormand"] / time["by-hand"] }
  ' "$work/andrews.dat"
}

growth_table() {
  cat <<'EOT'
| N | links | read [s] | plan [s] | a position [µs] | a link [µs] | an evaluation [µs] | a link [µs] | memory [MB] |
| --- | --- | --- | --- | --- | --- | --- | --- | --- |
EOT
  awk '
    NR > 1 {
      position = $5 > 0 ? sprintf("%.2f | %.3f", $5, $5 / $2) : "- | -"
      printf "| %d | %d | %.3f | %.3f | %s | %.2f | %.3f | %.1f |\n", $1, $2, $3, $4, position, $6, $6 / $2, $7
    }
  ' "$work/$1.dat"
}

mixed_names="chain=open chain;tip=four-bar at the tip;middle=four-bar in the middle;base=four-bar at the base"
mixed_names+=";modules=modules in series;tree=tree of modules"

# evaluations in the plane and in space side by side, and their ratio to those of the open chain with as many links N
mixed_table() {
  cat <<'EOT'
| structure | N | links | independent | plane [µs] | a link [µs] | to the chain | space [µs] | a link [µs] | to the chain |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
EOT
  awk -v names="$mixed_names" '
    BEGIN { split(names, pairs, ";"); for (i in pairs) { split(pairs[i], word, "="); name[word[1]] = word[2] } }
    {
      time[$1, $2, $3] = $7
      if ($2 == "space")
        printf "| %s | %d | %d | %d | %.2f | %.3f | %.2f | %.2f | %.3f | %.2f |\n", name[$1], $3, $4, $5, time[$1, "plane", $3],
          time[$1, "plane", $3] / $4, time[$1, "plane", $3] / time["chain", "plane", $3], $7, $7 / $4, $7 / time["chain", "space", $3]
    }
  ' "$work/mixed.dat"
}

# memory for each further link, from the two largest N
memory_table() {
  cat <<'EOT'
| structure | from N to N | plane [kB a link] | space [kB a link] |
| --- | --- | --- | --- |
EOT
  awk -v names="$mixed_names" '
    BEGIN { split(names, pairs, ";"); for (i in pairs) { split(pairs[i], word, "="); name[word[1]] = word[2] } }
    {
      if (!seen[$1]++) order[++n] = $1
      if ($3 > to[$1]) { from[$1] = to[$1]; to[$1] = $3 }
      links[$1, $3] = $4
      memory[$1, $2, $3] = 1024 * $8
    }
    END {
      for (i = 1; i <= n; i++) {
        k = order[i]
        more = links[k, to[k]] - links[k, from[k]]
        printf "| %s | %d, %d | %.1f | %.1f |\n", name[k], from[k], to[k],
          (memory[k, "plane", to[k]] - memory[k, "plane", from[k]]) / more,
          (memory[k, "space", to[k]] - memory[k, "space", from[k]]) / more
      }
    }
  ' "$work/mixed.dat"
}

# an evaluation by each program, and its ratios to the closed form and to MECH9
others_table() {
  cat <<'EOT'
| mechanism | N | program | an evaluation [µs] | to the form by hand | to MECH9 | difference of accelerations |
| --- | --- | --- | --- | --- | --- | --- |
EOT
  awk -F '\t' '
    BEGIN {
      name["two_links"] = "two links in the plane"; name["four_bar"] = "four-bar in the plane"; name["andrews"] = "Andrews\047 mechanism"
      name["chain"] = "open chain in space"; name["tip"] = "four-bar at the tip of a chain in space"
      name["modules"] = "modules in series in space"; name["legs"] = "pair of legs"
    }
    NF < 5 { next }
    {
      n++
      row[n] = $0
      if ($3 == "by hand") hand[$1, $2] = $4
      if ($3 == "MECH9") own[$1, $2] = $4
    }
    END {
      for (i = 1; i <= n; i++) {
        split(row[i], cell, "\t")
        at = cell[1] SUBSEP cell[2]
        printf "| %s | %s | %s | %.3f | %s | %.3g | %s |\n", name[cell[1]], cell[2], cell[3], cell[4],
          at in hand ? sprintf("%.1f", cell[4] / hand[at]) : "", cell[4] / own[at], cell[3] == "MECH9" ? "" : cell[5]
      }
    }
  ' "$work/others.dat"
}

write_tables() {
  local problem
  cat <<EOT
# Benchmarks

Measured by \`bench/run\`, which builds the programs with every instruction of the machine, runs them and writes this page.$([ $mode = full ] || printf '\n%s' "This was a quick run, over a twentieth of the times told below: its figures mean little.")

- machine: $(machine)
- build: $(build_words)$([ -z "$built" ] || printf '\n%s' "- built from nothing in $built s, programs of this page included")

Times are medians on one core. Other machines have other times; the ratios carry over.

## Time per position

Driven mechanisms over one cycle. The four-bar linkage (0.40, 0.15, 0.35, 0.30 m) is also written by hand in closed form, for this
one mechanism only (\`bench/closed_four_bar.f90\`); ratios are to that. The six-bar is the same four-bar with two
links more. Both columns are the whole work of
\`mech9k\` for a position except writing it, the checks of the branch included: with \`&output derivatives=0\`, and with all derivatives.

$(position_table)

Largest difference of the four-bar's accelerations from the closed form, relative to the largest acceleration:
$(awk '$1 == "four_bar" { print $6 }' "$work/positions.dat").

The last rows, if there are such, are other programs: pylinkage's compiled solver, without a point on the coupler. Largest error of the
rocker's pin over the crank: $(awk -F '\t' 'NF == 4 { print $4; n++ } END { if (n == 0) print "not measured" }' "$work/positions.others").

## Studies, searches, sensitivities

Whole runs of \`mech9k\` in one thread, with all of reading, planning and writing.

$(answers_table)

## Values of an objective

The objective of \`examples/timed_path\`: eighteen points at given times, nine parameters. Each design differs by up to a thousandth of
the parameters from one whose run is known.

$(synthesis_table)

## Work and precision

Wall time of an integration and evaluations of the motion against the error at its end, over the tolerances 1e-3 to 1e-13. Errors
are differences to references in extended precision in \`tests/reference\`; for the spatial slider-crank, to a run at
1e-13 by another method. The tables show the shortest time in which a method came below an error, and its evaluations.

Other programs stand behind our methods, over their steps or tolerances (\`bench/peers\`). They have the same links, pairs, bodies and loads, the same
closed position and rates at the start, and the time of their integration alone counts. Numbers behind their times are steps for Exudyn,
MuJoCo and Drake, evaluations for Pinocchio and Simbody. Angles count without whole turns. Their versions and settings:

$(settings_list)
EOT
  for problem in $problems; do
    echo
    echo "### ${words[$problem]}"
    echo
    [ ! -f "$output/pictures/bench_$problem.svg" ] || echo "![${words[$problem]}](pictures/bench_$problem.svg)"
    echo
    precision_table "$problem"
    if [ $problem = andrews ]; then
      cat <<EOT

The row \`by hand\` is the mechanism in one coordinate, derived by hand for this one mechanism (\`bench/closed_andrews.f90\`), with the integrator of
\`prince-dormand\`. To an error of 1e-8 the program takes $(hand_ratio) times as long with this integrator.
EOT
    fi
    if [ -s "$work/$problem.failed" ] || grep -q '^failed' "$work/$problem.others"; then
      echo
      echo "Runs that did not come to the end:"
      echo
      sed 's/^/- /' "$work/$problem.failed"
      sed -n 's/^failed /- /p' "$work/$problem.others"
    fi
  done
  cat <<EOT

## Growth

$([ ! -f "$output/pictures/bench_growth.svg" ] || echo "![Growth with the number of links](pictures/bench_growth.svg)")

Ladders of N parallelograms side by side, 2 N + 2 links, the first upright driven:

$(growth_table ladder)

Open chains of N links of 1 m and 1 kg, with axes x and y in alternation, all coordinates independent:

$(growth_table chain)

## Mixed structures

Evaluations of the motion: open chains of N links as above, with a four-bar at the tip, in the middle or at the base; N modules of a
revolute pair and a four-bar in series; binary trees of such modules. In the plane all axes are parallel, in space those of the chain are x
and y in alternation, those of the four-bars y.

$(mixed_table)

### Memory of mixed structures

Memory for data that each further link takes, from two sizes; reading, planning and evaluations are included.

$(memory_table)

## Other programs

Accelerations at the closed position in which each data file starts, by procedures of one thread (\`bench/peers/accelerations.py\`): by hand for this one
mechanism (\`bench/closed_structures.f90\`, \`bench/closed_andrews.f90\`; position and accelerations), by MECH9, by MuJoCo with contacts
off, and by Pinocchio. The last two are called from Python, which takes one or two microseconds of a call, and have the same links,
positions and rates. MuJoCo holds closed chains by soft constraints as hard as it allows, and starts from the accelerations of the call before;
Pinocchio's \`lcaba\` makes one proximal step. Both are measured as their packages are built. The last column tells how far their
accelerations are from those of MECH9, over the largest one.

$(others_table)
EOT
}

build_words() {
  local program=$programs/../bin/mech9k
  if [ -x "$program" ]; then
    "$program" --version | paste -sd ';' | sed 's/;/; /g'
  else
    echo "unknown"
  fi
}
