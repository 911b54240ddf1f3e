# gnuplot -c derivatives.gp DIR SCRIPTS
dir = ARG1
load ARG2."/style.gp"

array scene[4] = ["pendulum", "kepler", "fpu", "solar"]
array n[4] = [1, 2, 6, 18]
array colours[4] = [tvi_colour, start_colour, midpoint_colour, taylor_colour]
label(i) = sprintf("n = %d, %s", n[i], scene[i])

do for [type in types] {
    eval open(type, "derivatives", 900, 400)
    set multiplot layout 1,2 margins 0.08, 0.81, 0.14, 0.92 spacing 0.05, 0.1
    set logscale y; set format y powers
    set yrange [1e-2:1e4]; set ylabel "time of one evaluation (us)"
    set xrange [0:21]; set xtics 5; set xlabel "derivative j"
    set title "Series (lines), Jacobians (dashes), 2^j (dots)"
    unset key
    plot for [i=1:4] rows("derivatives", of(scene[i]), "$3, $4") using 1:($2 * 1e6) with linespoints \
             pt 7 ps 0.6 lw 1.6 lc rgb colours[i] title label(i), \
         for [i=1:4] rows("derivatives", of(scene[i]), "$3, $5") using 1:($2 * 1e6) with linespoints \
             pt 6 ps 0.6 lw 1.6 dt 2 lc rgb colours[i] title label(i), \
         0.01 * 2**x lc rgb grey lw 2 dt 3
    set logscale x; set xrange [1:22]; set xtics (1, 2, 5, 10, 20)
    unset ylabel; set format y ""
    set title "The same on two logarithmic axes"
    set key at screen 0.82, 0.85 left top reverse Left vertical
    plot for [i=1:4] rows("derivatives", of(scene[i]), "$3, $4") using 1:($2 * 1e6) with linespoints \
             pt 7 ps 0.6 lw 1.6 lc rgb colours[i] title label(i), \
         for [i=1:4] rows("derivatives", of(scene[i]), "$3, $5") using 1:($2 * 1e6) with linespoints \
             pt 6 ps 0.6 lw 1.6 dt 2 lc rgb colours[i] notitle, \
         0.05 * x**2 lc rgb grey lw 2 dt 3 title "slope 2"
    unset multiplot
    reset
    load ARG2."/style.gp"
}
