# The pictures of bench/run, by gnuplot. Uses its $work, $output, $problems and words.

colours=('#0072b2' '#d55e00' '#009e73' '#cc79a7' '#e69f00' '#56b4e9' '#000000' '#7f3f00' '#808080' '#8b0000' '#006400' '#4b0082' '#b8860b' '#2f4f4f')

# The beginning that all of them have in common: picture, height.
begin_picture() {
  cat <<EOT
set encoding utf8
set terminal svg enhanced font 'sans-serif,14' background '#ffffff' size 960,$2
set output '$output/pictures/$1.svg'
set border 3 lc rgb '#606060'
set tics nomirror out
set grid lc rgb '#cccccc' lw 0.8 dt 1
set logscale xy
set format xy '10^{%L}'
set mxtics 1
set mytics 1
set key outside right top Left reverse samplen 1.5 noenhanced
EOT
  local i
  for i in "${!colours[@]}"; do
    echo "set linetype $((i + 1)) lw 2 pt $((i + 4)) ps 0.6 lc rgb '${colours[$i]}'"
  done
}

# The rows of each method as a block of their own, two blank lines between.
in_blocks() {
  awk 'NR > 1 { if (NR > 2 && $1 != last) printf "\n\n"; last = $1; print }' "$1"
}

draw_precision() {
  local problem=$1 methods
  in_blocks "$work/$problem.dat" >"$work/$problem.blocks"
  methods=$(awk 'NR > 1 && !seen[$1]++ { print $1 }' "$work/$problem.dat" | paste -sd ' ')
  [ -n "$methods" ] || return 0
  {
    begin_picture "bench_$problem" 460
    cat <<EOT
methods = '$methods'
set multiplot layout 1,2 title "${words[$problem]}" noenhanced margins char 9,char 22,char 4,char 3 spacing char 10
set xlabel 'error [rad, m]' noenhanced
set ylabel 'time [s]'
unset key
plot for [i=1:words(methods)] '$work/$problem.blocks' index i-1 using 3:4 with linespoints lt i
set ylabel 'evaluations of the motion'
set key
plot for [i=1:words(methods)] '$work/$problem.blocks' index i-1 using 3:5 with linespoints lt i title word(methods, i)
unset multiplot
EOT
  } | gnuplot -d
}

draw_growth() {
  {
    begin_picture bench_growth 460
    cat <<EOT
set multiplot layout 1,2 title 'Growth with the number of links' margins char 9,char 30,char 4,char 3 spacing char 10
set xlabel 'links'
set ylabel 'time [µs]'
unset key
plot '$work/ladder.dat' using 2:5 every ::1 with linespoints lt 1, '' using 2:6 every ::1 with linespoints lt 2, \
  '$work/chain.dat' using 2:6 every ::1 with linespoints lt 3
set ylabel 'memory [MB]'
set key
set format y '%g'
plot '$work/ladder.dat' using 2:(1/0) every ::1 with linespoints lt 1 title 'ladder, a position', \
  '' using 2:(1/0) every ::1 with linespoints lt 2 title 'ladder, an evaluation', \
  '$work/chain.dat' using 2:(1/0) every ::1 with linespoints lt 3 title 'chain, an evaluation', \
  '$work/ladder.dat' using 2:7 every ::1 with linespoints lt 4 title 'ladder, memory', \
  '$work/chain.dat' using 2:7 every ::1 with linespoints lt 5 title 'chain, memory'
unset multiplot
EOT
  } | gnuplot -d
}

draw_pictures() {
  local problem
  for problem in $problems; do
    draw_precision "$problem"
  done
  draw_growth
}
