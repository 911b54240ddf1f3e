# gnuplot -c plot.gp DIR
# Reads DIR/work_precision.csv and draws, as PNG and SVG, for each scene in it
#   DIR/SCENE_work.*    position error against CPU time
#   DIR/SCENE_order.*   error at the end against h, with pieces of line of slope 2, 4, 8, 16

dir = ARG1
csv = dir."/work_precision.csv"

# method, order, colour, dashes (0: none), point type
$curves << END
stormer-verlet 2  #222222 0 4
tvi            4  #D55E00 1 6
tvi            8  #D55E00 0 7
taylor         8  #AA5599 1 12
taylor         16 #AA5599 0 13
midpoint       8  #56A8E8 0 7
midpoint       12 #2277C4 0 7
midpoint       20 #08254F 0 7
galerkin       8  #009E73 1 4
galerkin       16 #009E73 0 5
compiled       16 #D0006F 0 2
gauss          16 #777777 1 9
blanes-moan    6  #B8A000 1 11
END
field(i, k) = word($curves[i], k)
name(method) = method eq "compiled" ? "galerkin" : method eq "tvi" ? "paper's TVI" : method
note(method) = method eq "compiled" ? ", compiled" : method eq "gauss" || method eq "blanes-moan" ? ", by hand" : ""
label(i) = name(field(i, 1))." ".field(i, 2).note(field(i, 1))
# method and order of the curves that show a slope, which is their order
$slopes << END
stormer-verlet 2
galerkin       8
galerkin       16
END

# ---- What is in the file -----------------------------------------------------------------------------------------------

scene_names = system("awk -F, '!/^#/ && $1 != \"scene\" && !seen[$1]++ {print $1}' ".csv)
said(scene, pattern) = system("sed -n 's/^# scene ".scene.": ".pattern."$/\\1/p' ".csv)
select(scene, method, order) = sprintf("$1 == \"%s\" && $2 == \"%s\" && $3 == %s", scene, method, order)
# columns x, y of the curve's rows, as far as y can be drawn
rows(scene, i, x, y) = sprintf("< awk -F, '%s && $%d > 0 {print $%d, $%d}' %s", \
    select(scene, field(i, 1), field(i, 2)), y, x, y, csv)
has(scene, i) = system(sprintf("awk -F, '%s {print 1; exit}' %s", select(scene, field(i, 1), field(i, 2)), csv)) eq "1"
# h and end error of the row whose error comes closest to 1e-8; nothing where none is converged
anchor(scene, method, order) = system(sprintf("awk -F, '%s && $10 > 0 && $10 < 0.03 {d = (log($10) - log(1e-8))^2; " \
    ."if (!n++ || d < best) {best = d; at = $5 \" \" $10}} END {print at}' %s", select(scene, method, order), csv))

# ---- How it looks ------------------------------------------------------------------------------------------------------

set logscale xy
set format x "10^{%T}"
set format y "10^{%T}"
set xrange [*:*] noextend
set yrange [1e-16:1e2]
set ytics 1e2
unset mytics
set offsets graph 0.03, graph 0.03, 0, 0
set grid xtics ytics lt 1 lw 0.6 lc rgb "#DDDDDD"
set border 3 lw 1 lc rgb "#444444"
set tics nomirror
set key outside right top Left reverse title "method and order" left samplen 3 spacing 1.3 width 1
set style textbox opaque noborder margins 0.3, 0.1
set title font ",15"
do for [i=1:|$curves|] {
    eval sprintf("set style line %d lc rgb '%s' lw 1.7 pt %s ps 0.9 dt %s", i, field(i, 3), field(i, 5), \
        field(i, 4) eq "1" ? "(9,5)" : "1")
}

open(type, name) = sprintf("set terminal %s size 1120,720 font 'DejaVu Sans,%d' lw 1.2; set output '%s/%s.%s'", \
    type eq "png" ? "pngcairo" : "svg", type eq "png" ? 12 : 14, dir, name, type)

# A piece of slope p beside the curve through (h, e): it starts there, two decades long, at 0.3 of the error.
guide(h, e, p) = sprintf("set arrow from %g, %g to %g, %g nohead lw 1.4 dt (3,3) lc rgb '#777777'; " \
    ."set label 'slope %d' at %g, %g left offset 0.4, -0.5 front boxed tc rgb '#555555'", \
    h, 0.3 * e, h * 100**(1.0 / p), 30 * e, p, h, 0.3 * e)

# ---- The plots ---------------------------------------------------------------------------------------------------------

do for [type in "png svg"] {
    do for [scene in scene_names] {
        title = said(scene, "\\(.*\\); time unit.*")
        unit = said(scene, ".*; time unit: \\(.*\\)")

        present = ""
        do for [i=1:|$curves|] { if (has(scene, i)) { present = present." ".i } }
        if (present eq "") { continue }

        eval open(type, scene."_work")
        set title title.": work and precision"
        set xlabel "CPU time of the run (ms)"
        set ylabel "error of the position at the end (2-norm)"
        plot for [c in present] i=int(c), rows(scene, i, 7, 11) using ($1 * 1e3):2 with linespoints ls i title label(i)

        eval open(type, scene."_order")
        set title title.": order"
        set xlabel "step h".(unit eq "" ? "" : " (".unit.")")
        set ylabel "error of (q, p) at the end (maximum norm)"
        do for [i=1:|$slopes|] {
            at = anchor(scene, word($slopes[i], 1), word($slopes[i], 2))
            if (words(at) == 2) { eval guide(real(word(at, 1)), real(word(at, 2)), int(word($slopes[i], 2))) }
        }
        plot for [c in present] i=int(c), rows(scene, i, 5, 10) using 1:2 with linespoints ls i title label(i)
        unset arrow
        unset label
    }
}
