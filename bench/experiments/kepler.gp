# gnuplot -c kepler.gp DIR SCRIPTS
dir = ARG1
load ARG2."/style.gp"

# ---- Orbits --------------------------------------------------------------------------------------------------------

array orders[3] = [4, 6, 8]
array names[4] = ["taylor", "tvi", "start", "midpoint"]
array factors[4] = [1, 1, 2, 2]
array colours[4] = [taylor_colour, tvi_colour, start_colour, midpoint_colour]

do for [type in types] {
    eval open(type, "kepler_orbits", 820, 680)
    set multiplot layout 3,4 margins 0.065, 0.99, 0.07, 0.96 spacing 0.03, 0.08
    set xrange [-1.2:1.2]; set yrange [-1.2:1.2]; set size ratio -1
    set xtics 1; set ytics 1
    unset key
    set parametric; set trange [0:2 * pi]
    do for [row=1:3] { do for [column=1:4] {
        label = sprintf("%s %d", names[column], factors[column] * orders[row])
        set title label
        if (column == 1) { set ylabel "q_2" } else { unset ylabel }
        if (row == 3) { set xlabel "q_1" offset 0, 0.5 } else { unset xlabel }
        plot 0.36 / 1.36 + cos(t) / 1.36, sqrt(1 - 0.36**2) / 1.36 * sin(t) with lines lw 1 lc rgb black, \
             rows("kepler_orbits", of(label), "$3, $4") using 1:2 with points pt 7 ps 0.2 lc rgb colours[column]
    } }
    unset multiplot
    unset parametric
}

# ---- Stormer-Verlet and SVHd ---------------------------------------------------------------------------------------

reset
load ARG2."/style.gp"
$work << END
stormer-verlet 2 #222222 0 4
svhd           2 #D55E00 0 7
right          2 #7FC97F 0 9
midpoint       2 #1F5FA8 0 5
END
eval work_style
do for [type in types] {
    eval open(type, "kepler_verlet", 860, 370)
    set multiplot layout 1,2 margins 0.085, 0.98, 0.14, 0.92 spacing 0.1, 0.1
    set xrange [0:25]; set xlabel "t"
    set yrange [-0.14:0.14]; set ylabel "relative energy error"
    set key left bottom opaque
    set title "Kepler, h = 0.25: energy"
    energy(label) = rows("kepler_verlet_energy", of(label), "$2, $5")
    plot energy("stormer-verlet 2") with linespoints ls 1 ps 0.5 title "Stormer-Verlet", \
         energy("svhd 2") with linespoints ls 2 ps 0.5 title "SVHd", \
         energy("midpoint 2") with linespoints ls 4 ps 0.5 title "midpoint 2"
    set xrange [*:*]; set yrange [*:*]
    set logscale xy; set format x powers; set format y powers
    set xlabel "CPU time of the run to t = 250 (ms)"; set ylabel "mean relative energy error"
    set title "Energy error against CPU time"
    plot for [i=1:|$work|] work_rows("kepler_verlet", i, 6) using 1:2 with linespoints ls i title work_field(i, 1)
    unset multiplot
    unset logscale; set format "%g"
}
