# gnuplot -c longrun.gp DIR SCRIPTS
# Reads DIR/longrun.csv and draws DIR/longrun.png and .svg: the rms of the energy error over the orbits against steps.
dir = ARG1
load ARG2."/style.gp"

set logscale xy
set format xy powers
set key top left Left reverse samplen 2 spacing 1.1
set xlabel "steps"
set xrange [1e3:4e6]
set yrange [3e-17:1e-11]
law(t) = 4e-17 * t ** 0.5
linear(t) = 4e-19 * t

# label, title, colour, point type
$library << END
"Kepler 0.1 galerkin" "Kepler, h = 0.1" #D55E00 7
"Kepler 0.25 galerkin" "Kepler, h = 0.25" #E69F00 6
"outer Solar System 100 galerkin" "Solar System, h = 100" #1F5FA8 9
"outer Solar System 250 galerkin" "h = 250" #56A8E8 8
"outer Solar System 400 galerkin" "h = 400" #222222 11
"magnetic bottle 0.1 galerkin" "magnetic bottle" #009E73 5
"elastic pendulum 0.1 galerkin" "elastic pendulum" #7FC97F 4
"double pendulum 0.015625 galerkin" "double pendulum" #AA5599 13
END
$control << END
"Kepler 0.1 galerkin rounded coefficients" "Kepler, h = 0.1, rounded coefficients" #D55E00 7
"outer Solar System 250 galerkin rounded coefficients" "Solar System, h = 250, the same" #56A8E8 8
"outer Solar System 400 galerkin rounded coefficients" "h = 400, the same" #222222 11
"outer Solar System 100 galerkin plain sums" "h = 100, plain sums" #1F5FA8 9
END
samples(label) = rows("longrun", of(label)." && $2 == \"energy\"", "$3, $4")

do for [type in types] {
    eval open(type, "longrun", 1000, 480)
    set multiplot layout 1,2 margins 0.08, 0.985, 0.12, 0.93 spacing 0.08, 0.1
    set ylabel "rms over the orbits of the relative energy error"
    set title "The library"
    plot law(x) lc rgb grey dt 2 lw 1.4 title "t^{1/2}", linear(x) lc rgb grey dt 3 lw 1.4 title "t", \
        for [i=1:|$library|] samples(word($library[i], 1)) with linespoints lw 1.5 ps 0.6 lc rgb word($library[i], 3) \
        pt int(word($library[i], 4)) title word($library[i], 2)
    unset ylabel
    set title "The controls"
    plot law(x) lc rgb grey dt 2 lw 1.4 title "t^{1/2}", linear(x) lc rgb grey dt 3 lw 1.4 title "t", \
        for [i=1:|$control|] samples(word($control[i], 1)) with linespoints lw 1.5 ps 0.6 lc rgb word($control[i], 3) \
        pt int(word($control[i], 4)) title word($control[i], 2)
    unset multiplot
}
