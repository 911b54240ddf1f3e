# style.gp - what the pictures share. Loaded by each script, which is called: gnuplot -c NAME.gp DIR SCRIPTS,
# and has set dir = ARG1.

set datafile commentschars "#"

# ---- Data ----------------------------------------------------------------------------------------------------------

# Columns (an awk expression) of the rows of DIR/FILE.csv, below its head, for which a condition of awk holds.
rows(file, condition, columns) = sprintf("< awk -F, '/^#/ {next} head++ && %s {print %s}' %s/%s.csv", \
    condition, columns, dir, file)
# column 1 is the method's label
of(label) = sprintf("$1 == \"%s\"", label)

# ---- Looks ---------------------------------------------------------------------------------------------------------

black = "#222222"; grey = "#999999"
taylor_colour = "#AA5599"; tvi_colour = "#D55E00"; htvi_colour = "#E69F00"; symmetric_colour = "#B22222"
start_colour = "#009E73"; right_colour = "#7FC97F"; ends_colour = "#56A8E8"; midpoint_colour = "#1F5FA8"

set grid xtics ytics lt 1 lw 0.6 lc rgb "#DDDDDD"
set border 3 lw 1 lc rgb "#444444"
set tics nomirror
set title font ",12" offset 0, -0.5
powers = "10^{%T}"

open(type, name, width, height) = sprintf("set terminal %s size %d,%d font 'DejaVu Sans,%d' lw 1.2; " \
    ."set output '%s/%s.%s'", type eq "png" ? "pngcairo" : "svg", width, height, \
    type eq "png" ? 10 : 12, dir, name, type)
types = "png svg"

# ---- Work and precision --------------------------------------------------------------------------------------------

# The script's own table of curves stands here: method, order, colour, dashes (0: none), point type.
$work << END
END
work_field(i, k) = word($work[i], k)
work_label(i) = work_field(i, 1)." ".work_field(i, 2)
work_rows(file, i, column) = rows(file, of(work_label(i))." && $".column." > 0", "$5 * 1e3, $".column)
work_style = "do for [i=1:|$work|] { eval sprintf('set style line %d lc rgb \"%s\" lw 1.6 pt %s ps 0.8 dt %s', i, " \
    ."work_field(i, 3), work_field(i, 5), work_field(i, 4) eq '1' ? '2' : '1') }"
