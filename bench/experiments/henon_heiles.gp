# gnuplot -c henon_heiles.gp DIR SCRIPTS
dir = ARG1
load ARG2."/style.gp"

# ---- Poincare sections ---------------------------------------------------------------------------------------------

array names[3] = ["taylor 6", "tvi 6", "midpoint 12"]
array colours[3] = [taylor_colour, tvi_colour, midpoint_colour]

do for [type in types] {
    eval open(type, "henon_heiles_sections", 1000, 680)
    set multiplot layout 2,3 margins 0.06, 0.98, 0.09, 0.94 spacing 0.05, 0.09
    set xrange [-0.55:0.8]; set yrange [-0.55:0.55]; set xtics 0.4; set ytics 0.4
    unset key
    do for [H in "12 8"] { do for [k=1:3] {
        set title sprintf("%s, h = 0.5, H = 1/%s", names[k], H)
        if (k == 1) { set ylabel "p_y" } else { unset ylabel }
        if (H eq "8") { set xlabel "y" offset 0, 0.5 } else { unset xlabel }
        plot rows("henon_heiles_sections", of(names[k])." && $2 == ".H, "$4, $5") with dots lc rgb colours[k]
    } }
    unset multiplot
}

# ---- Work ----------------------------------------------------------------------------------------------------------

reset
load ARG2."/style.gp"
$work << END
tvi            4  #D55E00 1 6
tvi            6  #D55E00 0 7
symmetric-tvi  4  #B22222 1 4
symmetric-tvi  6  #B22222 0 5
shooting       4  #222222 1 12
shooting       6  #222222 0 13
taylor         6  #AA5599 0 3
both-ends      6  #56A8E8 0 5
start          12 #009E73 0 7
midpoint       6  #1F5FA8 1 4
midpoint       12 #1F5FA8 0 5
END
eval work_style
do for [type in types] {
    eval open(type, "henon_heiles_work", 920, 370)
    set multiplot layout 1,3 margins 0.08, 0.81, 0.14, 0.91 spacing 0.065, 0.1
    set logscale xy; set format x powers; set format y powers
    set xlabel "CPU time of the run (ms)"; set xtics 10; set ytics 1e2
    set yrange [1e-14:10]
    unset key
    set ylabel "error"
    set title "H = 1/12, t = 1000: position"
    plot for [i=1:|$work|] work_rows("henon_heiles_12", i, 8) using 1:2 with linespoints ls i
    unset ylabel
    set title "H = 1/8, t = 100: position"
    plot for [i=1:|$work|] work_rows("henon_heiles_8", i, 8) using 1:2 with linespoints ls i
    set title "H = 1/8: energy (mean)"
    set key at screen 0.815, 0.93 left top Left reverse vertical samplen 2.5 title "method and order" left
    plot for [i=1:|$work|] work_rows("henon_heiles_8", i, 6) using 1:2 with linespoints ls i \
        title work_label(i)
    unset multiplot
    unset logscale; set format "%g"
}
