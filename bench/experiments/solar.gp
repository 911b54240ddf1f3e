# gnuplot -c solar.gp DIR SCRIPTS
dir = ARG1
load ARG2."/style.gp"

array names[8] = ["taylor 4", "tvi 4", "start 8", "midpoint 8", "taylor 6", "tvi 6", "start 12", "midpoint 12"]
array colours[5] = [tvi_colour, htvi_colour, start_colour, midpoint_colour, taylor_colour]
array planets[5] = ["Jupiter", "Saturn", "Uranus", "Neptune", "Pluto"]

do for [type in types] {
    eval open(type, "solar", 900, 500)
    set multiplot layout 2,4 margins 0.065, 0.985, 0.18, 0.95 spacing 0.02, 0.1
    set xrange [-52:52]; set yrange [-40:52]; set size ratio -1
    set xtics 25; set ytics 25
    unset key
    do for [k=1:8] {
        if (k == 8) { do for [i=1:5] {
            set label i planets[i] at screen 0.2 + 0.12 * i, 0.03 center tc rgb colours[i]
        } }
        set title names[k]
        if (k % 4 == 1) { set ylabel "y (AU)"; set format y "%g" } else { unset ylabel; set format y "" }
        if (k > 4) { set xlabel "x (AU)" offset 0, 0.5 } else { unset xlabel }
        plot for [i=1:5] rows("solar", of(names[k])." && $2 == ".i, "$4, $5") with points pt 7 ps 0.22 \
                 lc rgb colours[i], \
             "<echo 0 0" with points pt 3 ps 0.8 lc rgb black notitle
    }
    unset multiplot
    unset label
}
