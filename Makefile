# make help       these lines
# make            build/libtvi.a and build/libtvi.so, by all cores; make -j1 for one; V=1 prints the commands. As root it
#                 installs what it lacks from Debian; DEPS=0 forbids that, as does DESTDIR
# make libs       what a program with build/libtvi.a is linked with, before it is installed
# make check      the tests (installs what they need from Debian, as root), five minutes of two cores
# make check-long what takes longer, a quarter of an hour: sanitizers, valgrind, coverage, narrower instruction sets,
#                 aarch64, warnings of both compilers
# make check-isas the tests with the base instruction set and AVX2;  make check-arm: on aarch64, by qemu
# make check-all  both, and what takes longer still: generated code on every scene with every method
# make check-NAME one of the checks alone, as their lines say: make check-ad, make check-valgrind
# make margins    how far the bounds of the tests are from what they bound, with all instruction sets; half an hour
# make bench      the library and the baselines over all scenes: tables, CSV, plots in build/bench; SCENE=kepler for one
# make cov        lines of ad and src that the tests run; fails below 95%
# make fuzz       random programs led by coverage (libFuzzer), a minute; SECONDS=n for longer
# make fuzz-steps random steps against their definition in quadruple precision; SEED=n COUNT=m
# make constants  the constants that were found by trials, the command that shows each, and their number
# make analyse    clang-tidy and cppcheck over everything
# make blas-threads     the same bits for any number of threads of OpenBLAS
# make install    headers, libraries, manual pages, documents, tvi.pc and tvi-config.cmake below PREFIX
#                 (LIBDIR, DESTDIR); make uninstall takes them away
# make dist       build/tvi-VERSION.tar.gz, of what was committed last: it builds without git
# make compare    the baselines of bench/baselines only: CSV in build/bench/baselines; SCENE=kepler for one
# make choose     the tables of docs/choosing.md: the fastest method for each scene and error, five minutes
# make tails      its table of tvi_stats.tail: right and wrong steps
# make suggest    its table of tvi_suggest_step: what runs with the suggested steps reach
# make orbit      the first picture of README.md: an eccentric orbit beside SciPy's DOP853, ten seconds
# make tolerance  runs to a tolerance through forces of all widths, beside SciPy's DOP853
# make light      light bodies beside heavy ones in every kind of steps: which are right, refused, or warned of
# make performance   the tables and the picture of docs/performance.md, those of compiled.md and ensembles.md, five
#                 minutes
# make peers REBOUND=DIR HEYOKA=DIR   error against time beside REBOUND and heyoka, which you have built; either may be
#                 missing: the table of docs/performance.md and the picture of README.md, some minutes
# make gradient   the gradient of a run beside the run, and beside tangent columns: two tables of docs/fits.md
# make fits       fits in Python by derivatives of runs, beside those by differences: two tables of docs/fits.md
# make constraints   steps on constraints beside minimal coordinates and other methods: docs/constraints.md, 8 minutes
# make devices    what each device for speed gives (docs/adding.md), ten minutes; PLAIN=1: a library without any
# make compare-with COMMIT=hash   times and instructions of steps beside that commit's, row by row, and of ensembles
#                 beside integrators, five minutes; ROWS=pattern for some rows
# make python-cost  what a step and a run cost in Python beside C (docs/python.md), half a minute
# make instructions  tests/instructions.txt anew: what a step costs
# make mistakes   tests/python/mistakes.md anew: the texts that common mistakes get
# make abi        tests/abi.txt anew, what linked programs rely on; it prints what is lost
# make order-doubling   the table and the picture of docs/order-doubling.md
# make stability  where methods break: the tables and pictures of docs/stability.md, four minutes
# make guard      the steps that are refused: its table in docs/adaptive.md alone, a minute and a half
# make longrun    the table and the picture of docs/roundoff.md, 25 minutes of two cores; MINUTES=n for less
# make verify     the tables of the documents made anew and compared, times excepted
# make docs-tables   all tables and pictures of the documents anew, an hour; those of one target: make performance-docs,
#                 choose-docs, bench-docs, peers-docs, tails-docs, suggest-docs, stability-docs, guard-docs, longrun-docs,
#                 adaptive-docs, chaos-docs, constraints-docs, gradient-docs, fits-docs, order-doubling-docs,
#                 experiments-docs, maps-docs, orbit-docs
# make chaos      Lyapunov exponents and MEGNO of Henon-Heiles by the tangent map: tables and picture of docs/chaos.md
# make maps       order and chaos over planes of starts, by ensembles: the pictures of
#                 docs/ensembles.md, some minutes
# make adaptive   fixed and rescaled steps on eccentric orbits and close encounters: the table and the picture of
#                 docs/adaptive.md
# make experiments      the figures of the paper: CSV, tables and pictures in build/bench/experiments, one minute
# make gallery    the pictures of docs/python/README.md, half a minute
# make references bench/scenes/references.h anew, in quadruple precision

BUILD   ?= build
# All cores build, and test; make -j1 for one. A line for each file; V=1 for the commands.
JOBS     = $(if $(filter -j% --jobserver%,$(MAKEFLAGS)),,-j$(shell nproc 2>/dev/null || echo 2))
IS_QUIET = $(findstring s,$(filter-out -%,$(firstword $(MAKEFLAGS))))
SAY      = $(if $(V),,@$(if $(IS_QUIET),,echo '$(1)'; ))
PREFIX  ?= /usr/local
DESTDIR ?=
VERSION := $(shell sed -n 's/^.define TVI_VERSION "\([^"]*\)".*/\1/p' include/tvi.h)
SOVERSION := 1

# No -ffast-math: the roundoff of a step is part of the design. No contraction of multiply-adds, so that gcc and clang
# round alike. No errno from the mathematical functions, so that square roots are one instruction.
# No traps, as clang has it: the larger of two numbers is no branch, and loops with it are those of vectors.
# Debuggers get the lines; the places of variables, which code that is optimized seldom keeps, take a tenth of the time.
# valgrind 3.19 reads version 4 of DWARF, and not what clang writes as version 5.
CFLAGS   ?= -O3 -gdwarf-4 -g1
# WERROR=1, as CI has it: a warning is an error.
WARNINGS := -Wall -Wextra -Wpedantic -Wshadow -Wconversion $(if $(WERROR),-Werror)
BASE     := -std=c11 $(WARNINGS) -ffp-contract=off -fno-math-errno -fno-trapping-math -fPIC -fvisibility=hidden -Iinclude
# what is not the product: tests, bench and the quadruple-precision reference, which only gcc compiles
TOOL     := -std=c11 $(WARNINGS) -D_POSIX_C_SOURCE=200809L -Iinclude -Iad -Isrc -Ibench -Ibench/scenes
QUADCC   ?= gcc
QUAD     := -std=gnu11 -O2 -Wall -Wextra $(if $(WERROR),-Werror) -Iinclude -Iad -Ibench -Ibench/scenes

# elementary functions in vectors (ad/elementary.h), where SLEEF is; SLEEF=0: those of the mathematical library
SLEEF     ?= 1
HAS_SLEEF := $(if $(filter-out 0,$(SLEEF)),$(shell pkg-config --exists sleef 2>/dev/null && echo sleef))
BASE      += $(if $(HAS_SLEEF),-DJET_SLEEF)

# what is done for speed alone (ad/devices.h) left out: PLAIN=1
BASE      += $(if $(PLAIN),-DTVI_PLAIN) $(if $(DEVICES),-DTVI_DEVICES)

# An exception of C++ that leaves an observer passes runs, which then end what they have begun.
$(BUILD)/src/run/%.o $(BUILD)/src/events/%.o: BASE += -fexceptions

# what runs a tape is compiled once for each instruction set, and one is chosen at run time (ad/isa.c). Those that have
# fused multiply-adds use them.
ISAS         := $(if $(findstring x86_64,$(shell $(CC) -dumpmachine)),avx2 avx512)
FLAGS_avx2   := -mavx2 -mfma -ffp-contract=fast
FLAGS_avx512 := $(FLAGS_avx2) -mavx512f -mavx512dq -mavx512vl -mprefer-vector-width=512
ISA_SOURCES  := ad/sweep.c $(wildcard ad/rule*.c ad/sum*.c)
# steppers, whose tables alone are made once: their names in all sets but the base have the suffix of the set
TABLES       := src/galerkin/tables.c src/galerkin/lobatto.c src/generating/methods.c src/generating/action.c
SET_SOURCES  := $(filter-out $(TABLES),$(wildcard src/galerkin/*.c src/generating/*.c))
AD_OBJECTS   := $(patsubst %.c,$(BUILD)/%.o,$(wildcard ad/*.c)) $(BUILD)/ad/embedded_rules.o \
                $(ISAS:%=$(BUILD)/ad/sweeps_%.o)
EMBEDDED_SRC := $(patsubst %,$(BUILD)/src/embedded_%.o,code galerkin)
SRC_OBJECTS  := $(EMBEDDED_SRC) $(patsubst %.c,$(BUILD)/%.o,$(wildcard src/*/*.c)) \
                $(ISAS:%=$(BUILD)/src/steppers_%.o)
EMBEDDED    := $(BUILD)/ad/embedded_rules.o $(EMBEDDED_SRC)
OBJECTS     := $(AD_OBJECTS) $(SRC_OBJECTS)
LIBS         = $(shell pkg-config --libs lapack blas $(HAS_SLEEF)) -lm -pthread

.DELETE_ON_ERROR:
.PHONY: help libs all built check check-long bench choose references clean need-library need-check need-bench

all: need-library
	@$(MAKE) --no-print-directory $(JOBS) built
	$(if $(IS_QUIET),,@echo 'Made $(BUILD)/libtvi.a and $(BUILD)/libtvi.so. Next: make check, or make install, or a program:'; \
	    echo '    cc program.c -Iinclude $(BUILD)/libtvi.a $$(make -s libs) && ./a.out')

built: $(BUILD)/libtvi.a $(BUILD)/libtvi.so ; @:

# what there is to make: the lines at the head of this file
help:
	@sed -n '/^#/!q; s/^# //p' Makefile

# what programs with $(BUILD)/libtvi.a are linked with
libs:
	@echo $(LIBS)

# the Python that has what the module needs: that of the path, or Debian's, which has Debian's packages
PYTHONS    := $(or $(PYTHON),python3 /usr/bin/python3)
HAS_PYTHON := for python in $(PYTHONS); do "$$python" -c "import numpy, cffi, matplotlib" && exit 0; done; exit 1
PYTHON      = $(eval PYTHON := $(shell for python in $(PYTHONS); do "$$python" -c "import numpy, cffi" 2>/dev/null && echo "$$python" && exit; done; echo python3))$(PYTHON)

# ---- What is needed from Debian: `package:test`, installed where the test fails ---------------------------------------

# Root's make installs it. DEPS=0 forbids that, as does DESTDIR, which packagers have: what is missing is then named.
DEPS        ?= $(if $(DESTDIR),0,1)
MAY_INSTALL := [ "$(DEPS)" != 0 ] && [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null

PACKAGES_LIBRARY := 'pkg-config:command -v pkg-config' 'liblapack-dev:pkg-config --exists lapack' \
                    'libblas-dev:pkg-config --exists blas'
# whose absence costs time alone: who may not install it goes on without
SLEEF_PACKAGE    := $(if $(filter-out 0,$(SLEEF)),'libsleef-dev:pkg-config --exists sleef || ! { $(MAY_INSTALL); }')
PACKAGES_CHECK   := 'check:pkg-config --exists check' 'valgrind:command -v valgrind' 'clang:command -v clang' \
                    'clang-format:command -v clang-format' 'g++:command -v g++' 'cmake:command -v cmake' 'mandoc:command -v mandoc' \
                    'locales:test -e /usr/share/i18n/locales/de_DE' \
                    'libeigen3-dev:test -e /usr/include/eigen3/Eigen/Core' 'libopenmpi-dev:command -v mpicc' 'openmpi-bin:command -v mpirun' \
                    $(foreach package,numpy cffi matplotlib,'python3-$(package):$(HAS_PYTHON)')
PACKAGES_BENCH   := 'gnuplot-nox:command -v gnuplot'

define need
	@missing=; for need in $(1); do sh -c "$${need#*:}" >/dev/null 2>&1 || missing="$$missing $${need%%:*}"; done; \
	[ -z "$$missing" ] && exit 0; \
	$(MAY_INSTALL) || { echo "Missing:$$missing. Type:  sudo apt-get install -y$$missing" >&2; exit 1; }; \
	echo "Installing from Debian:$$missing"; \
	apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq $$missing >/dev/null
endef

need-library: ; $(call need,$(PACKAGES_LIBRARY) $(SLEEF_PACKAGE))
need-check: ; $(call need,$(PACKAGES_LIBRARY) $(SLEEF_PACKAGE) $(PACKAGES_CHECK))
need-bench: ; $(call need,$(PACKAGES_LIBRARY) $(SLEEF_PACKAGE) $(PACKAGES_BENCH))

# ---- The library -------------------------------------------------------------------------------------------------------

# All objects are made anew when the compiler, its flags or SLEEF are others.
BUILT_WITH := $(filter-out -Werror,$(CC) $(BASE) $(CFLAGS))
$(BUILD)/built_with: always
	@mkdir -p $(@D) && echo '$(BUILT_WITH)' | cmp -s - $@ || echo '$(BUILT_WITH)' >$@
.PHONY: always

$(BUILD)/ad/%.o: ad/%.c
	@mkdir -p $(@D)
	$(call SAY,CC $<)$(CC) $(BASE) $(CFLAGS) -MMD -MP -c -o $@ $<

# the text of the rules, for generated code (ad/emit.h)
EMBEDDED_RULES := $(addprefix ad/,compiler.h vector.h) include/jet.h $(addprefix ad/,graph.h tape.h rule.h sums.h elementary.h) \
                  $(wildcard ad/rule_*.c ad/sum_*.c) ad/emitted.h
$(BUILD)/ad/embedded_rules.c: ad/embed.awk $(EMBEDDED_RULES)
	@mkdir -p $(@D)
	$(call SAY,AWK $@)awk -v NAME=jet_embedded_rules -f ad/embed.awk $(EMBEDDED_RULES) >$@
# what defines generated code
$(BUILD)/src/embedded_code.c: ad/embed.awk src/compiled/code.h
	@mkdir -p $(@D)
	$(call SAY,AWK $@)awk -v NAME=tvi_embedded_code -f ad/embed.awk src/compiled/code.h >$@
# the steps of the Galerkin curve, for one system: generated.h, and what it includes
$(BUILD)/src/embedded_galerkin.c: ad/embed.awk $(wildcard src/*/*.h) include/tvi.h
	@mkdir -p $(@D)
	$(call SAY,AWK $@)awk -v NAME=tvi_embedded_galerkin -v INCLUDES='include src' -f ad/embed.awk src/galerkin/generated.h >$@
$(EMBEDDED): %.o: %.c
	$(call SAY,CC $<)$(CC) $(BASE) $(CFLAGS) -c -o $@ $<
# and is compiled as the library is: sums of one lane, which are not to be made vectors of once more, apart
comma := ,
GENERATED_FLAGS := -Werror=implicit-function-declaration -O3 -fno-math-errno -fno-trapping-math -fno-tree-slp-vectorize
quoted = "$(GENERATED_FLAGS) $(1)",
# with the SLEEF that the library has
SLEEF_FILE = $(notdir $(shell readlink $$($(CC) -print-file-name=libsleef.so)))
$(BUILD)/src/compiled/load.o: BASE += -DTVI_COMPILED_SLEEF='$(if $(HAS_SLEEF),"-DJET_SLEEF"$(comma) "$(or $(SLEEF_FILE:%=-l:%),-lsleef)"$(comma))'
$(BUILD)/src/compiled/load.o: BASE += -DTVI_COMPILED_FLAGS='$(call quoted,-ffp-contract=off) $(foreach isa,$(ISAS),$(call quoted,$(FLAGS_$(isa))))'

$(addprefix $(BUILD)/,ad/isa.o $(addprefix src/,compiled/load.o method/method.o)): \
    BASE += $(if $(ISAS),-DJET_ISA_X86)

define isa_objects
$(BUILD)/%.$(1).o: %.c
	@mkdir -p $$(@D)
	$$(call SAY,CC $$< ($(1)))$$(CC) $$(BASE) -Iad -Isrc $$(FLAGS_$(1)) -DJET_ISA=jet_isa_$(1) $$(CFLAGS) -MMD -MP -c -o $$@ $$<
endef
$(foreach isa,$(ISAS),$(eval $(call isa_objects,$(isa))))
OBJCOPY ?= objcopy
# NAME.avx2.o is the object as it is compiled; in NAME_avx2.o the names that it defines have the suffix of the set
define named_object
.PRECIOUS: $(BUILD)/%.$(1).o
$(BUILD)/%_$(1).o: $(BUILD)/%.$(1).o
	$$(call SAY,OBJCOPY $$@)nm --defined-only -g $$< | awk '{ print $$$$3, $$$$3 "_$(1)" }' >$$@.names && $(OBJCOPY) --redefine-syms=$$@.names $$< $$@
endef
$(foreach isa,$(ISAS),$(eval $(call named_object,$(isa))))
# all sources of a set as one object
define set_object
SET_PIECES += $(3:%.c=$(BUILD)/%.$(2).o)
SETS       += $(BUILD)/$(1)_$(2).o
$(BUILD)/$(1).$(2).o: $(3:%.c=$(BUILD)/%.$(2).o)
	$$(call SAY,LD $$@)$(LD) -r -o $$@ $$(filter %.o,$$^)
endef
$(foreach isa,$(ISAS),$(eval $(call set_object,ad/sweeps,$(isa),$(ISA_SOURCES)))$(eval $(call set_object,src/steppers,$(isa),$(SET_SOURCES))))

$(BUILD)/src/%.o: src/%.c
	@mkdir -p $(@D)
	$(call SAY,CC $<)$(CC) $(BASE) -Iad -Isrc $(CFLAGS) -MMD -MP -c -o $@ $<

$(BUILD)/libtvi.a: $(OBJECTS)
	@rm -f $@
	$(call SAY,AR $@)$(AR) rcs $@ $^

$(BUILD)/libtvi.so: $(OBJECTS)
	$(call SAY,LD $@)$(CC) $(CFLAGS) $(LDFLAGS) -shared -Wl,-soname,libtvi.so.$(SOVERSION) -o $@ $^ $(LIBS)

include src/packaging/install.mk

# ---- The bench ---------------------------------------------------------------------------------------------------------

include bench/bench.mk

include bench/experiments/experiments.mk
include bench/performance/performance.mk
include bench/constraints/constraints.mk
include bench/gradient/gradient.mk
include bench/compare/compare.mk
include bench/longrun/longrun.mk
include bench/adaptive/adaptive.mk
include bench/maps/maps.mk
include bench/peers/peers.mk

# ---- The tests ---------------------------------------------------------------------------------------------------------

include tests/tests.mk

include bench/stability/stability.mk

$(OBJECTS) $(SET_PIECES) $(TEST_OBJECTS) $(call objects_of,$(BENCH_SOURCES)): $(BUILD)/built_with

clean:
	rm -rf build

-include $(wildcard $(BUILD)/*/*.d $(BUILD)/*/*/*.d $(BUILD)/*/*/*/*.d)
