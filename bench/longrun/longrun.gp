# gnuplot -c longrun.gp DIR SCRIPTS
# Reads DIR/longrun.csv and draws DIR/longrun.png and .svg: the rms of the energy error over the orbits against time.
dir = ARG1
load ARG2."/style.gp"

set logscale xy
set format xy powers
set key bottom right Left reverse samplen 2 spacing 1.2
set xlabel "years"
set ylabel "rms over 32 orbits of the relative energy error"
set xrange [1e3:*]
set yrange [3e-17:*]
array lines[4] = ["galerkin plain", "galerkin compensated", "midpoint plain", "midpoint compensated"]
array colours[4] = [tvi_colour, midpoint_colour, tvi_colour, midpoint_colour]
array points[4] = [6, 7, 8, 9]

# through the last point of the compensated Galerkin curve
stats rows("longrun", of(lines[2]), "$3, $4") using 1:2 name "end" nooutput
law(t) = end_max_y * (t / end_max_x) ** 0.5

do for [type in types] {
    eval open(type, "longrun", 900, 520)
    plot law(x) lc rgb grey dt 2 lw 1.4 title "t^{1/2}", \
        for [i=1:4] rows("longrun", of(lines[i]), "$3, $4") with linespoints lw 1.5 ps 0.7 lc rgb colours[i] \
        pt points[i] title lines[i]
}
