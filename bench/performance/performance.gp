# gnuplot -c performance.gp DIR SCRIPTS
# Reads DIR/cost_n.csv and DIR/cost_degree.csv and draws DIR/performance.png and .svg: the cost of a step against n and N.
dir = ARG1
load ARG2."/style.gp"

set logscale xy
set format y powers
set key top left Left reverse samplen 2 spacing 1.2
array titles[3] = ["step with matrices", "step with products", "one expansion"]
array colours[3] = [tvi_colour, midpoint_colour, grey]
array columns[3] = ["$1, $3", "$1, $4", "$1, $2"]
array points[3] = [6, 7, 5]

do for [type in types] {
    eval open(type, "performance", 1000, 420)
    set multiplot layout 1,2
    set ylabel "time (us)"
    set title "gravity of 3 to 40 bodies, N = 8"
    set xlabel "degrees of freedom n"
    set xtics (9, 18, 30, 60, 120)
    set xrange [8:135]
    plot for [i=1:3] rows("cost_n", "1", columns[i]) with linespoints lw 1.7 ps 0.9 lc rgb colours[i] pt points[i] \
        title titles[i]
    set title "6 bodies"
    set xlabel "degree N"
    set xtics (2, 3, 4, 6, 8, 12, 16, 20, 30)
    set xrange [1.8:33]
    unset ylabel
    plot for [i=1:3] rows("cost_degree", "1", columns[i]) with linespoints lw 1.7 ps 0.9 lc rgb colours[i] pt points[i] \
        title titles[i]
    unset multiplot
}
