# gnuplot -c order_doubling.gp DIR
# Reads DIR/errors.csv and draws DIR/order-doubling.png and .svg: error against h, the paper's form and ours.

dir = ARG1
rows(scene, method, degree) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\" && $3 == %d {print $5, $6}' %s/errors.csv", \
    scene, method, degree, dir)

# method, colour, point type
$methods << END
tvi      #D55E00 6
start    #009E73 5
midpoint #2277C4 7
END
names = "'truncated, start (the paper)' 'on-curve, start' 'on-curve, midpoint'"

set logscale xy
set format xy "10^{%T}"
set yrange [1e-13:1e3]
set ytics 1e2
unset mytics
set grid xtics ytics lt 1 lw 0.6 lc rgb "#DDDDDD"
set border 3 lw 1 lc rgb "#444444"
set tics nomirror
set xlabel "step h"
set key top left Left reverse samplen 2 spacing 1.2 opaque

do for [type in "png svg"] {
    eval sprintf("set terminal %s size 1120,520 font 'DejaVu Sans,11' lw 1.2; set output '%s/order-doubling.%s'", \
        type eq "png" ? "pngcairo" : "svg", dir, type)
    set multiplot layout 1,2 title "Kepler to t = 3: error at the end against the step, equal numbers of derivatives"
    do for [degree in "2 4"] {
        N = int(degree)
        set title sprintf("N = %d: slope %d truncated, %d on-curve", N, N, 2 * N)
        set ylabel N == 2 ? "error of (q, p), maximum norm" : ""
        plot for [i=1:3] rows("kepler", word($methods[i], 1), N) using 1:2 with linespoints lw 1.7 ps 0.9 \
            lc rgb word($methods[i], 2) pt int(word($methods[i], 3)) title word(names, i)
    }
    unset multiplot
}
