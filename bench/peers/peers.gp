# gnuplot -c peers.gp DIR SCRIPTS
# Reads DIR/peers.csv and draws DIR/peers.png and .svg: error against time a simulated year, Sun and eight planets.
dir = ARG1
load ARG2."/style.gp"

# peer, title, colour, point type; one without rows is left out
$curves << END
"tvi, compiled" "tvi, compiled" #D55E00 7
"tvi, tape"     "tvi, tape"     #E69F00 6
"WHFast"        "REBOUND: WHFast, corrector 17" #1F5FA8 5
"WHCKL"         "REBOUND: WHCKL"                #56A8E8 4
"WHFast512"     "REBOUND: WHFast512"            #999999 9
"IAS15"         "REBOUND: IAS15"                #009E73 13
"heyoka"        "heyoka"                        #AA5599 11
END
field(i, k) = word($curves[i], k)
# labels have a comma, and stand in quotes; then come setting, seconds, time, error
curve(label) = sprintf("< awk -F'\"' '$1 == \"planets,\" && $2 == \"%s\" {split($3, x, \",\"); " \
    ."print x[4], x[5]}' %s/peers.csv", label, dir)
present = ""
do for [i=1:|$curves|] {
    if (strlen(system(curve(field(i, 1))[2:])) > 0) { present = present." ".i }
}

set logscale xy
set format y powers
set yrange [1e-13:0.1]
set xlabel "CPU time of a simulated year (us)"
set ylabel "distance from the solution after 250 years (AU)"
set title "Sun and eight planets: error against time"
set key outside right top Left reverse samplen 2 spacing 1.4

do for [type in types] {
    eval open(type, "peers", 900, 460)
    plot for [c in present] i=int(c), curve(field(i, 1)) with linespoints lw 1.7 ps 0.9 lc rgb field(i, 3) \
        pt int(field(i, 4)) title field(i, 2)
}
