# gnuplot -c plot.gp DIR
# Reads what break wrote to DIR and draws there, as PNG and SVG,
#   linear.*   spectral radius of a step of the harmonic oscillator against h w
#   fpu_100.*  energy error of the Fermi-Pasta-Ulam chain of w = 100 against h w
#   survive.*  the largest step that survives, of each method, over some cases

dir = ARG1
open(type, name, width, height) = sprintf("set terminal %s size %d,%d font 'DejaVu Sans,%d' lw 1.2; set output '%s/%s.%s'", \
    type eq "png" ? "pngcairo" : "svg", width, height, type eq "png" ? 11 : 13, dir, name, type)
set grid xtics ytics lt 1 lw 0.6 lc rgb "#DDDDDD"
set border 3 lw 1 lc rgb "#444444"
set tics nomirror
set key outside right top Left reverse samplen 3 spacing 1.2 width 1

colours = "#222222 #D55E00 #009E73 #56A8E8 #08254F #AA5599 #E69F00 #0F7F7F #7F7F7F #A05020 #2277C4 #B0B000 #FF6080 #F7E35A #CC0000 #0000CC #00AACC"
colour(i) = word(colours, i)

do for [type in "png svg"] {
    eval open(type, "linear", 1000, 560)
    set title "Harmonic oscillator: spectral radius of a step"
    set xlabel "h w (step times frequency)"
    set ylabel "spectral radius"
    set xrange [0:8]
    set yrange [0.95:2.2]
    plot for [i=0:9] dir."/linear_curves.csv" index i using 1:2 every ::1 with points pt 7 ps 0.35 lc rgb colour(i + 1) \
        notitle, for [i=0:9] dir."/linear_curves.csv" index i using (NaN):(NaN) every ::1 with points pt 7 ps 1.2 \
        lc rgb colour(i + 1) title system(sprintf("sed -n '/\"/p' %s/linear_curves.csv | sed -n '%dp' | tr -d '\"'", dir, i + 1))

    set logscale y
    set format y "10^{%T}"
    set xrange [0:3.1]
    set yrange [1e-16:1e-1]
    set ylabel "largest relative energy error"
    eval open(type, "fpu_100", 860, 500)
    set title "Fermi-Pasta-Ulam, w = 100, to w t = 500"
    name(i) = system(sprintf("sed -n '/\"/p' %s/fpu_100.dat | sed -n '%dp' | tr -d '\"'", dir, i))
    is_gauss(i) = name(i)[1:5] eq "gauss" # "galerkin" is drawn over it
    plot for [i=1:17] dir."/fpu_100.dat" index i-1 using 1:2 every ::1 with linespoints pt 7 ps (is_gauss(i) ? 0.8 : 0.5) \
        lw (is_gauss(i) ? 3.5 : 1.4) lc rgb colour(i) title name(i)
    unset logscale y
    set format y

    eval open(type, "survive", 1150, 760)
    set title "Largest step that survives, relative to Gauss collocation of order 16"
    set xlabel "h of the method / h of gauss 16"
    set ylabel ""
    set logscale x
    set xrange [0.01:3]
    set yrange [31.5:0.5]
    set lmargin 22
    rows = "< awk -F, 'NR > 1 && $1 == \"%s\" && $4 != \"-\" {name = $2 \" \" $3; h[name] = $4; if (name == \"gauss 16\") g = $4} " \
        ."END {while ((getline < \"%s/methods.txt\") > 0) {n++; if ($0 in h) print n, h[$0] / g, \"\\\"\" $0 \"\\\"\"}}' %s/survive.csv"
    system(sprintf("awk -F, '$1 == \"kepler_60\" {print $2 \" \" $3}' %s/survive.csv > %s/methods.txt", dir, dir))
    cases = "kepler_60 kepler_90 separatrix pythagorean spring_pendulum henon_heiles_6 figure_eight unequal_masses"
    plot dir."/methods.txt" using (1e-9):0:ytic(1) notitle, \
        sprintf(rows, "kepler_60", dir, dir) using (1e-9):1:ytic(stringcolumn(3)) notitle, \
        for [i=1:8] sprintf(rows, word(cases, i), dir, dir) using 2:($1 + (i - 4.5) * 0.11) with points pt (i < 5 ? 7 : 5) ps 0.8 \
        lc rgb colour(i == 1 ? 1 : i) title word(cases, i) noenhanced
    unset logscale x
    set lmargin
    set ytics autofreq
}
