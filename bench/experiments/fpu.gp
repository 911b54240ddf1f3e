# gnuplot -c fpu.gp DIR SCRIPTS
dir = ARG1
load ARG2."/style.gp"

array names[5] = ["stormer-verlet 2", "svhd 2", "midpoint 2", "taylor 8", "midpoint 16"]
array colours[4] = [tvi_colour, start_colour, taylor_colour, black]
array labels[4] = ["I_1", "I_2", "I_3", "I"]

# the least and the largest value of a column within each unit of time
bands(label, h, column) = sprintf("< awk -F, '/^#/ {next} head++ && %s && $2 == %s {b = int($3); y = $%d; " \
    ."if (!(b in low)) low[b] = high[b] = y; if (y < low[b]) low[b] = y; if (y > high[b]) high[b] = y} " \
    ."END {for (b = 0; b < 200; b++) if (b in low) print b + 0.5, low[b], high[b]}' %s/fpu.csv", \
    of(label), h, column, dir)

do for [type in types] {
    eval open(type, "fpu", 800, 400)
    set multiplot layout 2,5 margins 0.065, 0.975, 0.16, 0.93 spacing 0.025, 0.13
    unset key
    set xrange [0:200]; set yrange [0:1.6]; set xtics 0, 100, 100; set ytics 0.5
    do for [h in "0.03 0.01"] { do for [k=1:5] {
        set title sprintf("%s, h = %s", names[k], h) font ",9"
        if (k == 1) { set ylabel "energy"; set format y "%g" } else { unset ylabel; set format y "" }
        if (h eq "0.01") { set xlabel "t" offset 0, 0.5 } else { unset xlabel }
        if (k == 5 && h eq "0.01") { do for [c=1:4] { set label c labels[c] at screen 0.3 + 0.1 * c, 0.03 center \
            tc rgb colours[c] } }
        plot for [c=1:4] bands(names[k], h, c + 3) using 1:2:3 with filledcurves lc rgb colours[c] fs solid \
                 border lc rgb colours[c], \
             for [c=1:4] bands(names[k], h, c + 3) using 1:(($2 + $3) / 2) with lines lw 1 lc rgb colours[c]
    } }
    unset multiplot
    unset label
}
