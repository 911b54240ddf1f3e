# fragments.awk PAGE.md...: the fragments of C in pages for users, as a file to be compiled: what is above a line of dots
# stands beside the program's functions, what is below it, or all of it, in one; its variables have the names of tvi.h.
BEGIN {
    print "#include <tvi.h>\n#include <stddef.h>\n"
    print "static const double pi = 3.14159;"
    print "tvi_potential_fn potential;"
    print "void fragments(tvi_system *, tvi_system *, tvi_system *, tvi_integrator *, tvi_integrator *, tvi_options, tvi_observer *, void *);"
}
/^```c$/  { inside = 1; above = below = ""; next }
/^```/    { if (inside) { if (below == "") { below = above; above = "" } functions = functions above; body = body "    {\n" below "    }\n"; count++ } inside = 0; next }
inside && /^\.\.\.$/ { below = " "; next }
inside && below      { below = below $0 "\n"; next }
inside               { above = above $0 "\n" }
END {
    print functions
    print "void fragments(tvi_system *system, tvi_system *rescaled, tvi_system *driven,"
    print "               tvi_integrator *integrator, tvi_integrator *other,"
    print "               tvi_options options, tvi_observer *observer, void *buffer)\n{"
    print "    double t = 0, t_end = 1, q[2] = {1, 0}, p[2] = {0, 1};"
    printf "%s    (void)t_end, (void)rescaled, (void)driven, (void)other, (void)options, (void)observer, (void)buffer, (void)pi;\n}\n", body
    exit !count
}
