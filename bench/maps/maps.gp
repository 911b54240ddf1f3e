# gnuplot -c maps.gp DIR STYLE
# Reads DIR/section.csv, henon_heiles.csv and planet.csv, and draws DIR/henon_heiles.png and planet.png, and .svg.
dir = ARG1
load ARG2."/style.gp"

csv(name) = sprintf("< awk -F, '/^#/ {next} head++ && $3 != \"nan\" && $3 != \"-nan\" {print $1, $2, ($3 < 1 ? 1 : $3)}' %s/%s.csv", dir, name)
lost(name) = sprintf("< awk -F, '/^#/ {next} head++ && $3 ~ /nan/ {print $1, $2}' %s/%s.csv", dir, name)

unset grid
set border lw 1 lc rgb "#444444"
set palette defined (0 "#1F5FA8", 0.3 "#BBD4EC", 0.35 "#F7E9B0", 0.6 "#E69F00", 1 "#B22222")
set logscale cb; set cbrange [1:50]; set cblabel "MEGNO" offset 0.5, 0
set cbtics (1, 2, 5, 10, 20, 50)
unset key

do for [type in types] {
    eval open(type, "henon_heiles", 980, 430)
    set multiplot layout 1,2
    set xrange [-0.45:0.7]; set yrange [-0.52:0.52]
    set xlabel "y"; set ylabel "p_y" offset 1, 0
    set title "section x = 0, H = 1/8"
    plot sprintf("< awk -F, '/^#/ {next} head++ {print $2, $3}' %s/section.csv", dir) with dots lc rgb black
    set title "MEGNO, 200 x 200 starts"
    plot csv("henon_heiles") with points pt 5 ps 0.2 lc palette
    unset multiplot
    eval open(type, "planet", 760, 430)
    set xrange [0.55:0.8]; set yrange [0:0.4]
    set xlabel "a, in radii of the giant's orbit"; set ylabel "e" offset 1, 0
    set title "MEGNO of a small planet inside of a giant's orbit, 100 x 100 starts"
    plot lost("planet") with points pt 5 ps 0.85 lc rgb grey, csv("planet") with points pt 5 ps 0.85 lc palette
}
