# gnuplot -c pendulum.gp DIR SCRIPTS
dir = ARG1
load ARG2."/style.gp"

# ---- Level sets ----------------------------------------------------------------------------------------------------

wrapped(q) = q - 2 * pi * floor((q + pi) / (2 * pi))
momentum(H, q) = sqrt(2 * (H - 9.8 * (1 - cos(q))))
energies = system(sprintf("awk -F, '$1 == \"midpoint 4\" && !seen[$2]++ {print $5 * $5 / 2 + 9.8 * (1 - cos($4))}' " \
    ."%s/pendulum_levels.csv", dir))

do for [type in types] {
    eval open(type, "pendulum_levels", 860, 330)
    set multiplot layout 1,3 margins 0.06, 0.985, 0.14, 0.91 spacing 0.04, 0.1
    set xrange [-pi:pi]; set yrange [-9:9]; set samples 2000
    set xtics ("-π" -pi, "-π/2" -pi/2, "0" 0, "π/2" pi/2, "π" pi)
    set xlabel "q (rad)"; set ylabel "p (1/s)"
    unset key
    exact = "for [H in energies] momentum(real(H), x) lc rgb grey lw 1, " \
        ."for [H in energies] -momentum(real(H), x) lc rgb grey lw 1"
    set title "Level sets of the energy"
    eval "plot ".exact
    unset ylabel
    do for [k=1:2] {
        label = k == 1 ? "tvi 2 (trapezoid)" : "midpoint 4"
        set title (k == 1 ? "TVI 2, h = 0.1 to t = 20" : "midpoint 4")
        points = rows("pendulum_levels", of(label), "$4, $5")
        eval "plot ".exact.", points using (wrapped($1)):2 with points pt 7 ps 0.25 lc rgb '". \
            (k == 1 ? tvi_colour : midpoint_colour)."'"
    }
    unset multiplot
}

# ---- Order 6 at h = 0.5 --------------------------------------------------------------------------------------------

reset
load ARG2."/style.gp"
do for [type in types] {
    eval open(type, "pendulum_large_step", 820, 330)
    set multiplot layout 1,2 margins 0.075, 0.98, 0.14, 0.92 spacing 0.1, 0.1
    set xrange [0:200]; set xlabel "t (s)"
    set yrange [0:20]; set ylabel "energy (exact: 9.8)"
    set key left top
    set title "Pendulum, h = 0.5: energy"
    energy_at(e) = 9.8 * (1 + e)
    large(label) = rows("pendulum_large_step", of(label)." && $2 == 500", "$3, $6")
    plot large("taylor 6") using 1:(energy_at($2)) with lines lw 1.6 lc rgb taylor_colour title "Taylor 6", \
         large("tvi 6 (Gauss 4)") using 1:(energy_at($2)) with lines lw 1.2 lc rgb tvi_colour title "TVI 6, Gauss 4", \
         large("tvi 6 (Lobatto 4)") using 1:(energy_at($2)) with lines lw 1.2 lc rgb htvi_colour title "TVI 6, Lobatto 4", \
         large("midpoint 12") using 1:(energy_at($2)) with lines lw 1.6 lc rgb midpoint_colour title "midpoint 12"
    set logscale y; set format y powers; set yrange [1e-10:10]; set ytics 1e2
    set ylabel "|relative energy error|"
    set key right bottom opaque
    set title "Its relative error"
    plot large("taylor 6") using 1:(abs($2)) with lines lw 1.6 lc rgb taylor_colour title "Taylor 6", \
         large("tvi 6 (Gauss 4)") using 1:(abs($2)) with lines lw 1 lc rgb tvi_colour title "TVI 6, Gauss 4", \
         large("start 12") using 1:(abs($2)) with lines lw 1 lc rgb start_colour title "start 12", \
         large("midpoint 12") using 1:(abs($2)) with lines lw 1 lc rgb midpoint_colour title "midpoint 12"
    unset multiplot
    unset logscale; set format y "%g"
}

# ---- Work ----------------------------------------------------------------------------------------------------------

reset
load ARG2."/style.gp"
$work << END
tvi            4  #D55E00 1 6
tvi            6  #D55E00 0 7
htvi-right     4  #E69F00 1 8
htvi-right     6  #E69F00 0 9
symmetric-tvi  4  #B22222 1 4
shooting       4  #222222 1 12
shooting       6  #222222 0 13
both-ends      6  #56A8E8 0 5
start          8  #009E73 1 6
start          12 #009E73 0 7
right          8  #7FC97F 1 8
right          12 #7FC97F 0 9
midpoint       6  #1F5FA8 1 4
midpoint       12 #1F5FA8 0 5
END
eval work_style
do for [type in types] {
    eval open(type, "pendulum_work", 780, 480)
    set logscale xy; set format x powers; set format y powers
    set yrange [1e-16:1]; set ytics 1e2
    set xlabel "CPU time of the run to t = 20 s (ms)"; set ylabel "mean relative energy error"
    set title "Pendulum: energy error against CPU time"
    set key outside right top Left reverse title "method and order" left
    plot for [i=1:|$work|] work_rows("pendulum_work", i, 6) using 1:2 with linespoints ls i \
        title work_label(i)
}
