# gnuplot -c almost_symplectic.gp DIR SCRIPTS
dir = ARG1
load ARG2."/style.gp"

# the largest error within each of 40 logarithmic intervals of time
envelope(method, stop) = sprintf("< awk -F, '/^#/ {next} head++ && $1 == \"%s\" && $2 == \"%s\" {" \
    ."b = int(10 * log($3) / log(10)); " \
    ."e = $4 < 0 ? -$4 : $4; if (!(b in top) || e > top[b]) top[b] = e} END {for (b = 10; b < 40; b++) if (b in top) " \
    ."print 10^((b + 0.5) / 10), top[b]}' %s/almost_symplectic.csv", method, stop, dir)

array passes[4] = ["no pass", "1 pass", "2 passes", "3 passes"]
array tolerances[5] = ["1e-4", "1e-5", "1e-7", "1e-9", "roundoff"]
# a curve is wider than those that are drawn over it
width(i, count) = 2 + count - i
array colours[5] = [taylor_colour, htvi_colour, tvi_colour, start_colour, midpoint_colour]

do for [type in types] {
    eval open(type, "almost_symplectic", 960, 370)
    set multiplot layout 1,3 margins 0.075, 0.985, 0.14, 0.92 spacing 0.03, 0.1
    set logscale xy
    set format x powers; set format y powers
    set xrange [10:1e4]; set xtics 10, 10, 1e3; set yrange [1e-11:10]; set ytics 1e2
    set xlabel "t (s)"
    set ylabel "largest relative energy error around t"
    set title "TVI 4, h = 0.1, fixed passes"
    set key inside left bottom vertical opaque width -1
    plot for [i=1:4] envelope("tvi 4", passes[i]) using 1:2 with lines lw width(i, 4) lc rgb colours[i] title passes[i]
    unset ylabel; set format y ""
    set title "TVI 4, tolerance of the corrector"
    plot for [i=1:5] envelope("tvi 4", tolerances[i]) using 1:2 with lines lw width(i, 5) lc rgb colours[i] title tolerances[i]
    set title "midpoint 8, fixed passes"
    set key inside left top
    plot for [i=1:4] envelope("midpoint 8", passes[i]) using 1:2 with lines lw width(i, 4) lc rgb colours[i] title passes[i]
    unset multiplot
}
