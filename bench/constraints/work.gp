# gnuplot -c work.gp DIR SCRIPTS
# Reads DIR/work.csv and draws DIR/work.png and .svg: the error at the end against CPU time, for each problem.
dir = ARG1
load ARG2."/style.gp"

# label, title, colour, dashes (0: none), point type
$work << END
"galerkin 16" "galerkin 16" #D55E00 0 7
"RATTLE 2" "RATTLE by hand" #222222 0 4
"RATTLE 4" "order 4" #AA5599 0 9
"RATTLE 6" "order 6" #56A8E8 0 8
"RATTLE 8" "order 8" #1F5FA8 0 5
"RATTLE 10" "order 10" #009E73 0 11
"IDA index 1" "IDA" #999999 1 6
"CVODE Adams" "CVODE Adams" #E69F00 1 10
END
array problems[5] = ["pendulum", "double pendulum", "chain of 10", "water", "heavy top"]

eval work_style
set logscale xy
set format xy powers
set yrange [1e-14:1]
points(problem, i) = rows("work", sprintf("$1 == \"%s\" && $2 == \"%s\"", problem, work_field(i, 1)), "$4 * 1e3, $5")

do for [type in types] {
    eval open(type, "work", 1000, 1160)
    set multiplot layout 3,2 margins 0.075, 0.985, 0.05, 0.965 spacing 0.075, 0.075
    unset key
    do for [k=1:5] {
        set title problems[k]
        if (k % 2) { set ylabel "largest error of a coordinate at the end" } else { unset ylabel }
        if (k > 3) { set xlabel "CPU time (ms)" } else { unset xlabel }
        plot for [i=1:|$work|] points(problems[k], i) with linespoints ls i
    }
    set key center center Left reverse samplen 2
    unset title; unset ylabel; unset xlabel; unset tics; unset border; unset grid
    plot for [i=1:|$work|] NaN with linespoints ls i title work_field(i, 2)
    unset multiplot
    set tics; set border 3; set grid
}
