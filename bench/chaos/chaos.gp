# gnuplot -c chaos.gp DIR STYLE
# Reads DIR/chaos.csv and draws DIR/chaos.png and .svg: the exponent and MEGNO against time.
dir = ARG1
load ARG2."/style.gp"

array labels[3] = ["1/12", "1/8 (regular)", "1/8 (chaotic)"]
array colours[3] = [midpoint_colour, start_colour, tvi_colour]

set logscale x; set format x powers
set xlabel "t"
do for [type in types] {
    eval open(type, "chaos", 920, 370)
    set multiplot layout 1,2 margins 0.08, 0.985, 0.14, 0.91 spacing 0.09, 0.1
    set logscale y; set format y powers
    set title "largest Lyapunov exponent, ln(d/d_0) / t"
    set key bottom left Left reverse samplen 2
    plot for [k=1:3] rows("chaos", of(labels[k]), "$2, $3") with lines lw 1.6 lc rgb colours[k] title "H = ".labels[k]
    set title "MEGNO"
    set yrange [0.5:1e4]
    set key top left Left reverse samplen 2
    plot for [k=1:3] rows("chaos", of(labels[k]), "$2, $4") with lines lw 1.6 lc rgb colours[k] notitle, \
        2 lc rgb grey dt 2 title "2: regular"
    unset multiplot
    unset yrange
}
