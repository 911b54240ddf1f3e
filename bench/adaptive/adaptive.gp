# gnuplot -c adaptive.gp DIR SCRIPTS
# Reads DIR/steps.csv and DIR/errors.csv and draws DIR/adaptive.png and .svg: the step along the Pythagorean orbit, and
# the error at pericentre against revolutions for fixed steps, rescaled steps and steps to a tolerance.
dir = ARG1
load ARG2."/style.gp"

set logscale y
set format y powers
curve(file, label) = rows(file, of(label), "$2, $3")

do for [type in types] {
    eval open(type, "adaptive", 1000, 460)
    set multiplot layout 1,2 margins 0.08, 0.985, 0.33, 0.925 spacing 0.1, 0.1
    set title "Pythagorean three bodies: size of the steps"
    set ylabel "step in t"
    set xlabel "t"
    set xrange [0:70]; set yrange [1e-7:10]
    set key at screen 0.27, 0.01 center bottom Left reverse samplen 2
    plot curve("steps", "pythagorean automatic 0.3") with lines lw 1 lc rgb midpoint_colour title "automatic g", \
         curve("steps", "pythagorean own 0.9") with lines lw 1 lc rgb tvi_colour title "own g, of the pairs"
    set title "Kepler: error of the position at pericentre"
    set ylabel "distance from the solution, a = 1"
    set xlabel "revolutions"
    set xrange [0:100]; set yrange [1e-15:1]
    set key at screen 0.75, 0.01 center bottom maxrows 4 Left reverse samplen 2
    plot curve("errors", "kepler_eccentric_90 fixed steps 0.0628") with lines lw 1.6 lc rgb htvi_colour \
             title "e = 0.9, 100 fixed steps a revolution", \
         curve("errors", "kepler_eccentric_90 fixed steps 0.00785") with lines lw 1.6 lc rgb tvi_colour \
             title "e = 0.9, 800 fixed steps", \
         curve("errors", "kepler_eccentric_90 own 0.837") with lines lw 1.6 lc rgb midpoint_colour \
             title "e = 0.9, 10 rescaled steps", \
         curve("errors", "kepler_eccentric_90 tolerance 1e-14") with lines lw 1.6 lc rgb start_colour \
             title "e = 0.9, Taylor to a tolerance", \
         curve("errors", "kepler_eccentric_99 fixed steps 0.000982") with lines lw 1.6 dt 2 lc rgb tvi_colour \
             title "e = 0.99, 6400 fixed steps", \
         curve("errors", "kepler_eccentric_99 own 1.14") with lines lw 1.6 dt 2 lc rgb midpoint_colour \
             title "e = 0.99, 10 rescaled steps", \
         curve("errors", "kepler_eccentric_99 tolerance 1e-14") with lines lw 1.6 dt 2 lc rgb start_colour \
             title "e = 0.99, Taylor to a tolerance"
    unset multiplot
}
