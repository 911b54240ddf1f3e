#!/bin/sh
# profile.sh PROGRAM
# Where the instructions of a step go, in percent of all of it, LAPACK and libm included: a table of the steps of
# tests/instructions.txt, counted by callgrind with TVI_ISA=avx2 (valgrind knows no AVX-512). PROGRAM: see bench/steps/instructions.sh.
#   expansion     the Taylor curve
#   node forces   the function at the nodes of the quadrature
#   gradient      seeds of the discrete action's gradient, without the forces, and their product with the Jacobian matrices
#   Jacobians     these matrices dQ/dz; 0 where only products are had
#   closing       the equations of the generating function; with products the seeds' adjoint sweep is one with it
#   corrector     factors, solutions and decisions of the passes, without the residuals
#   rest          predictor, increments, compensated sums, copies; of Galerkin the sums of the collocation, and of a
#                 Lagrangian the algebra of its second derivatives
set -u
program=$1

echo '| scene | method, h | instructions | expansion, % | node forces, % | gradient, % | Jacobians, % | closing, % | corrector, % | rest, % |'
echo '|---|---|---|---|---|---|---|---|---|---|'
grep -v '^#' tests/instructions.txt | while read -r scene method order h rest; do
    echo "profile: $scene" >&2
    bench/steps/instructions.sh "$program" avx2 "$scene" "$method" "$order" "$h" </dev/null |
        awk -v head="| $scene | $method $order, $h |" '
            $1 == "total" { total = $2 }
            $1 != "call" { next }
            { caller = $2; callee = $3; n = $4 }
            callee == "tvi_curve_expand" { expansion += n }
            callee == "values" && caller !~ /^series$|legendre/ { forces += n }
            callee == "tvi_action_seed" || callee == "tvi_curve_pull" { gradient += n }
            callee == "tvi_curve_pull" && caller == "solve" { closing -= n }
            callee == "tvi_curve_differentiate" { jacobians += n }
            callee ~ /^(tvi_)?close_(type[123]|poincare)/ && caller !~ /^close_type/ { closing += n }
            callee == "tvi_newton_solve" { corrector += n }
            callee == "residual" { corrector -= n }
            function cell(n) { printf " %.1f |", 100 * n / total; rest -= n }
            END {
                if (!total) exit 1
                rest = total
                printf "%s %d |", head, total
                cell(expansion); cell(forces); cell(gradient ? gradient - forces : 0); cell(jacobians); cell(closing); cell(corrector)
                printf " %.1f |\n", 100 * rest / total
            }' || exit 1
done
