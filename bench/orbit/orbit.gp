# gnuplot -c orbit.gp DIR STYLE
# Reads DIR/orbit.csv and draws DIR/orbit.png and .svg: the steps of the last revolution, and the energy error.
dir = ARG1
load ARG2."/style.gp"

of_what(label, what) = rows("orbit", of(label)." && $2 == \"".what."\"", "$3, $4")
e = 0.6
do for [type in types] {
    eval open(type, "orbit", 920, 330)
    set multiplot layout 1,2
    unset logscale; set format "%g"
    set lmargin at screen 0.05; set rmargin at screen 0.49; set tmargin at screen 0.90; set bmargin at screen 0.14
    set size ratio -1
    set xrange [-0.85:1.85]; set yrange [-1.0:1.0]; set xtics 1; set ytics 1
    set xlabel "x"; unset ylabel
    set title "steps of revolution 3,000"
    set key top right samplen 1
    set parametric; set trange [0:2*pi]; set samples 400
    plot e + cos(t), sqrt(1 - e*e) * sin(t) with lines lw 1.2 lc rgb "#BBBBBB" title "exact", \
        "<echo 0 0" with points pt 7 ps 1.6 lc rgb htvi_colour notitle, \
        of_what("DOP853", "orbit") with points pt 6 ps 1.1 lw 1.8 lc rgb tvi_colour title "DOP853", \
        of_what("tvi", "orbit") with points pt 7 ps 0.9 lc rgb midpoint_colour title "tvi"
    unset parametric
    set size noratio
    set lmargin at screen 0.60; set rmargin at screen 0.98
    set logscale y; set format y powers
    set xrange [0:3000]; set yrange [1e-17:1]; set xtics 1000; set ytics 1e4
    set xlabel "revolutions"
    set title "relative energy error"
    set key at graph 0.98, graph 0.62
    plot of_what("DOP853", "energy") with lines lw 2.2 lc rgb tvi_colour title "SciPy's DOP853", \
        of_what("tvi", "energy") with lines lw 2.2 lc rgb midpoint_colour title "tvi"
    unset multiplot
}
