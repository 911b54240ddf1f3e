# fragments.awk PAGE.md...: the fragments of C in pages for users, as a program that runs each of them. What is above a line
# of dots stands beside the program's functions, what is below it, or all of it, in a function of its own; its variables have
# the names of tvi.h. Every status in it must be TVI_OK, and the integrator that it leaves goes on.
/^```c$/  { inside = 1; above = below = ""; where = FILENAME ":" FNR; next }
/^```/    { if (inside) fragment(); inside = 0; next }
inside && /^\.\.\.$/ { below = " "; next }
inside    { find_calls($0) }
inside && below      { below = below $0 "\n"; next }
inside               { above = above $0 "\n" }

# what returns a status
function find_calls(s)
{
    while (match(s, /tvi_[a-z_]+\(/)) {
        call = substr(s, RSTART, RLENGTH - 1)
        if (call !~ /_(free|default|error|order)$|^tvi_bodies_[^s]|^tvi_rigid_(force|point|torque|turn)/) calls[call] = 1
        s = substr(s, RSTART + RLENGTH)
    }
}

function fragment()
{
    if (below == "") { below = above; above = "" }
    count++
    body = body "\n" above "static bool fragment_" count "(void)\n{\n    START\n    {\n" below
    body = body "        return ends_well(\"" where "\", integrator, t, q, p);\n    }\n}\n"
}

END {
    while ((getline line <"tests/fragments.h") > 0) print line
    for (call in calls) printf "#define %s(...) checked(\"%s\", %s(__VA_ARGS__))\n", call, call, call
    print body "\nint main(void)\n{\n    bool well = true;"
    for (i = 1; i <= count; i++) printf "    well = fragment_%d() && well;\n", i
    print "    return !(well && all_checked);\n}"
    exit !count
}
