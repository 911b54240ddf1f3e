# tests.mk - make check, make check-long and make check-all: what is claimed of the library, a line for each claim.
# Included by the Makefile.
#
# make check has what needs one build of everything, in $(BUILD)/check, and what a change may break any day. make
# check-long has what takes longer, each with its reason beside it; CI runs both. make check-all has what takes longer
# still. Builds of another kind stand below $(BUILD): sanitize, threads, cov, read, gcc, arm.
# The longest checks stand first, so that the cores end together.

FOLDERS := $(patsubst tests/%/main.c,%,$(wildcard tests/*/main.c))
FIRST   := generating library compiled
CHECKS  := $(patsubst %,check-%,$(FIRST) cases $(filter-out $(FIRST),$(FOLDERS)) generated-few examples python install instructions \
           headers readme formatting tables symbols names floors)
LONG    := $(patsubst %,check-%,sanitizers cases-long arm coverage isas plain thorough valgrind gallery warnings-clang dist threads bench)
ALL     := $(patsubst %,check-%,generated members equilibria optimized)
.PHONY: check check-long check-all run-check run-check-long run-check-all test-programs $(CHECKS) $(CHECKS:check-%=do-%) \
        $(LONG) $(LONG:check-%=do-%) $(ALL) $(ALL:check-%=do-%)

# What several checks need is built before they run side by side; where that fails, they say so.
# The last line is the verdict.
# check-arm is checks of its own, below a folder of its own (arm.mk)
logs_of = $(patsubst %,$(BUILD)/check/%.log,$(filter-out check-arm,$(1))) \
          $(if $(filter check-arm,$(1)),$(patsubst %,$(BUILD)/arm/check/%.log,check-arm-built $(ARM_CHECKS)))
define checks
	@$(MAKE) --no-print-directory $(JOBS) built man
	@$(MAKE) --no-print-directory -k $(JOBS) test-programs || true
	@rm -f $(addsuffix .status,$(call logs_of,$(1)))
	@$(MAKE) --no-print-directory -k $(JOBS) run-$@; tests/verdict.sh $@ $(call logs_of,$(1))
endef
check: need-check ; $(call checks,$(CHECKS))
check-long: need-check ; $(call checks,$(LONG))
check-all: check check-long ; $(call checks,$(ALL))

run-check: $(CHECKS)
run-check-long: $(LONG)
run-check-all: $(ALL)

# A check is two targets: check-NAME says in one line how do-NAME went (report.sh).
REPORT = +@tests/report.sh
LOG    = 'make $@' $(BUILD)/check/$@.log
DO     = $(LOG) $(MAKE) -s --no-print-directory do-$(@:check-%=%)

# ---- The test programs: one for each folder with a main.c ---------------------------------------------------------------

# what uses quadruple precision, which only gcc compiles, is called so
quad_of       = $(foreach source,$(1),$(if $(findstring quad,$(notdir $(source))),$(source)))
objects_of    = $(patsubst %.c,$(BUILD)/%.o,$(1))
TEST_SOURCES := $(wildcard tests/problems/*.c $(FOLDERS:%=tests/%/*.c))
TEST_OBJECTS := $(call objects_of,$(TEST_SOURCES))
QUAD_OBJECTS := $(call objects_of,$(call quad_of,$(TEST_SOURCES)))
PROGRAMS     := $(addprefix $(BUILD)/check/,$(FOLDERS))

CHECK_CFLAGS = $(shell pkg-config --cflags check)
CHECK_LIBS   = $(shell pkg-config --libs check) -lquadmath $(LIBS)
TEST_FLAGS   = $(TOOL) $(if $(HAS_SLEEF),-DJET_SLEEF) $(if $(ISAS),-DJET_ISA_X86) -Itests -Ibench/baselines $(CHECK_CFLAGS) $(CFLAGS) -MMD -MP
QUAD_FLAGS   = $(QUAD) -Isrc -Itests -Ibench/baselines $(CHECK_CFLAGS) $(CFLAGS) -MMD -MP

$(filter-out $(QUAD_OBJECTS),$(TEST_OBJECTS)): $(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	$(call SAY,CC $<)$(CC) $(TEST_FLAGS) -c -o $@ $<

$(QUAD_OBJECTS): $(BUILD)/%.o: %.c
	@mkdir -p $(@D)
	$(call SAY,CC $<)$(QUADCC) $(QUAD_FLAGS) -c -o $@ $<

# what the programs take from each other and from the bench
HELPERS := $(call objects_of,$(wildcard tests/problems/*.c) $(filter-out %/reference.c,$(wildcard bench/references/*.c)) $(wildcard bench/scenes/*.c bench/baselines/*.c) \
            $(filter-out %/stability.c,$(wildcard bench/stability/*.c)))
$(BUILD)/check/helpers.a: $(HELPERS)
	@mkdir -p $(@D) && rm -f $@
	$(call SAY,AR $@)$(AR) rcs $@ $^

# the jets build and are tested without src/
library_of = $(if $(filter ad,$(1)),$(AD_OBJECTS),$(BUILD)/check/helpers.a $(BUILD)/libtvi.a)
define program
$(BUILD)/check/$(1) $(BUILD)/check/$(1)-generated: $(call objects_of,$(wildcard tests/$(1)/*.c)) $(call library_of,$(1))
endef
$(foreach folder,$(FOLDERS),$(eval $(call program,$(folder))))
# the loops of every instruction set (tests/library/loops.h)
$(BUILD)/check/library: $(ISAS:%=$(BUILD)/tests/library/loops_%.o)
$(BUILD)/check/library: WRAP = -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=aligned_alloc,--wrap=free
# their integrators run generated code: tests/problems/generated.c
GENERATED := $(patsubst %,$(BUILD)/check/%-generated,generating rescaled fuzz)
$(GENERATED): WRAP = -Wl,--wrap=tvi_integrator_create,--wrap=tvi_integrator_free

# the same objects with a library of another kind: without devices for speed (check-plain), or one that counts the lines
# which are run (check-coverage)
PLAIN_FOLDERS   := ad library generating rescaled ensemble
COVERED_FOLDERS := ad library generating events rescaled parameters driven compiled ensemble constraints gradient
OTHER_PROGRAMS  := $(PLAIN_FOLDERS:%=$(BUILD)/plain/check/%) $(COVERED_FOLDERS:%=$(BUILD)/cov/check/%)
define other_program
$(BUILD)/$(1)/check/$(2): $(call objects_of,$(wildcard tests/$(2)/*.c)) $(BUILD)/check/helpers.a $(BUILD)/$(1)/libtvi.a
endef
$(foreach folder,$(PLAIN_FOLDERS),$(eval $(call other_program,plain,$(folder))))
$(foreach folder,$(COVERED_FOLDERS),$(eval $(call other_program,cov,$(folder))))
$(filter %/library,$(OTHER_PROGRAMS)): $(ISAS:%=$(BUILD)/tests/library/loops_%.o)
$(filter %/library,$(OTHER_PROGRAMS)): WRAP = -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=aligned_alloc,--wrap=free
$(COVERED_FOLDERS:%=$(BUILD)/cov/check/%): LDFLAGS += --coverage

test-programs: $(PROGRAMS) $(GENERATED) $(BUILD)/bench/steps/steps
$(PROGRAMS) $(GENERATED) $(OTHER_PROGRAMS):
	@mkdir -p $(@D)
	$(call SAY,LD $@)$(CC) $(CFLAGS) $(LDFLAGS) $(WRAP) -o $@ $^ $(CHECK_LIBS)

# All suites of a program, and the four programs that have none.
FUZZERS := fuzz fuzz_steps fuzz_states fuzz_bodies
$(FOLDERS:%=check-%): check-%: ; $(REPORT) "tests/$*" $(DO)
$(FOLDERS:%=do-%): do-%: $(BUILD)/check/%
	$(if $(filter $*,$(FUZZERS)),,tests/suites.sh '' )$<

# The suites that depend on vectors and rounding, with narrower instruction sets than the one that make check takes.
check-isas: ; $(REPORT) "the instruction sets $(NARROWER)" $(DO)
NARROWER := base $(filter avx2,$(ISAS))
do-isas: $(addprefix $(BUILD)/check/,ad library events generating ensemble invariance constraints gradient)
	for set in $(NARROWER); do export TVI_ISA=$$set; \
	    tests/suites.sh 'identity,series,tangent,adjoint,elementary' $(BUILD)/check/ad && \
	    tests/suites.sh 'closed forms,structure,stepping,products,linear,sums' $(BUILD)/check/library && \
	    tests/suites.sh rounding $(BUILD)/check/invariance && \
	    tests/suites.sh '' $(BUILD)/check/events && \
	    tests/suites.sh steps,runs $(BUILD)/check/constraints && \
	    tests/suites.sh '' $(BUILD)/check/gradient && \
	    tests/suites.sh 'bits/bits,members' $(BUILD)/check/ensemble && \
	    tests/suites.sh 'forms,orders,points,convergence,dense,galerkin,references' $(BUILD)/check/generating || \
	    exit 1; done

# The library without what it does for speed alone (ad/devices.h), of which results differ by roundoff. The programs of
# the tests are the same ones; how fast it is tells nothing.
check-plain: ; $(REPORT) "the library without devices for speed" $(DO)
do-plain:
	$(MAKE) -s --no-print-directory BUILD=$(BUILD)/plain PLAIN=1 CFLAGS=-O1 $(BUILD)/plain/libtvi.a
	$(MAKE) -s --no-print-directory $(PLAIN_FOLDERS:%=$(BUILD)/plain/check/%)
	export TVI_TESTS=plain; \
	for folder in ad ensemble rescaled; do tests/suites.sh '' $(BUILD)/plain/check/$$folder || exit 1; done & beside=$$!; \
	tests/suites.sh '' $(BUILD)/plain/check/library && \
	tests/suites.sh 'forms,orders,points,convergence,dense,galerkin,references' $(BUILD)/plain/check/generating; \
	own=$$?; wait $$beside && exit $$own

# generated code: every scene with every method beside the memory of all kinds of steps, then the suites of orders,
# geometry, tangents, states and random programs; some minutes of the compiler, few where the cache below
# $(BUILD)/check/generated has it already
check-generated: ; $(REPORT) "generated code: every scene with every method, and the suites of other programs" $(DO)
do-generated: export TVI_COMPILED = all
do-generated: $(addprefix $(BUILD)/check/,compiled library) $(GENERATED)
	tests/suites.sh same,rows,ahead,alone $< & same=$$!; \
	tests/suites.sh faults/generated $(BUILD)/check/library; memory=$$?; wait $$same && exit $$memory
	tests/generated.sh $(BUILD)

check-generated-few: ; $(REPORT) "suites with generated code" $(DO)
do-generated-few: $(GENERATED)
	tests/generated.sh $(BUILD) few

# All of the tests of which make check has a share: every allocation of a system fails, every byte of a saved state is
# damaged in eight ways, steps of all forms' generated code allocate nothing, a million orbits, 1e5 members. They guard what changes rarely, at length.
check-thorough: ; $(REPORT) "tests of which make check has a share" $(DO)
do-thorough: export TVI_TESTS = all
do-thorough: $(addprefix $(BUILD)/check/,bodies ensemble events library generating stability)
	tests/suites.sh orbits $(BUILD)/check/bodies
	tests/suites.sh 'suggested steps of eccentric orbits' $(BUILD)/check/events
	tests/suites.sh faults $(BUILD)/check/library
	tests/suites.sh states $(BUILD)/check/generating
	tests/suites.sh members $(BUILD)/check/ensemble
	tests/suites.sh equilibria/springs $(BUILD)/check/stability

# 102,000 random members beside integrators, of which check-thorough has a 16th and make check a 170th
check-members: ; $(REPORT) "102,000 members of ensembles are integrators, to the bit" $(DO)
do-members: $(BUILD)/check/ensemble
	TVI_MEMBERS=all tests/suites.sh members $<

# 20,000 steps of every method about every equilibrium at 1 and at 100
check-equilibria: ; $(REPORT) "long runs about equilibria" $(DO)
do-equilibria: $(BUILD)/check/stability
	TVI_EQUILIBRIA=all tests/suites.sh equilibria/springs $<

# How far the bounds of the tests are from what they bound: below 1.5, and not the same with all instruction sets. In a
# copy of the tests each comparison keeps its margin (margins.py). CC=clang-19 for another compiler.
MARGINS         := $(BUILD)/margins
MARGIN_PROGRAMS := $(filter-out compiled,$(FOLDERS))
margins: need-check
	@mkdir -p $(MARGINS)
	@tests/margins.py copy tests $(MARGINS)/tests
	@for part in ad src include bench docs Makefile README.md; do ln -sfn $(CURDIR)/$$part $(MARGINS)/$$part; done
	@$(MAKE) -s --no-print-directory -C $(MARGINS) $(JOBS) BUILD=build $(MARGIN_PROGRAMS:%=build/check/%)
	@$(MAKE) -s --no-print-directory -k $(JOBS) $(foreach set,base $(ISAS),$(MARGINS)/$(set))
	@tests/margins.py list 1.5 $(foreach set,base $(ISAS),$(MARGINS)/$(set))
$(foreach set,base $(ISAS),$(MARGINS)/$(set)): $(MARGINS)/%: always
	@rm -f $@ && cd $(MARGINS) && for program in $(MARGIN_PROGRAMS); do \
	    TVI_ISA=$* TVI_MARGINS=$* build/check/$$program >$*.$$program.log 2>&1 || { cat $*.$$program.log; exit 1; }; done
.PHONY: margins

# ---- Memory and undefined behaviour: the same programs, some of their suites -------------------------------------------

# what a null pointer or an object too small leads to, the address sanitizer finds: these two are half of the compiling
SANITIZE   := -O1 -g1 -fsanitize=address,undefined -fno-sanitize=null,object-size -fno-sanitize-recover=all \
              -fno-omit-frame-pointer
VALGRIND   := valgrind -q --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite,indirect
IN_ONE_GO  := CK_FORK=no tests/suites.sh

check-sanitizers:
	$(REPORT) "address, leak and undefined-behaviour sanitizers" $(LOG) \
	    $(MAKE) -s --no-print-directory do-sanitizers BUILD=$(BUILD)/sanitize CFLAGS='$(SANITIZE)'
do-sanitizers: $(addprefix $(BUILD)/check/,library ad generating ensemble bodies constraints gradient fuzz fuzz_states fuzz_bodies) $(BUILD)/libtvi.so
	$(IN_ONE_GO) 'input,faults,stepping,closed forms,arena' $(BUILD)/check/library
	$(IN_ONE_GO) 'record,domain,tape,hash,series,identity,gradient' $(BUILD)/check/ad
	$(IN_ONE_GO) 'forms,serves,statements,states,fingerprints' $(BUILD)/check/generating
	$(IN_ONE_GO) 'failing,states,refused,members,runs/following' $(BUILD)/check/ensemble
	$(BUILD)/check/fuzz
	$(BUILD)/check/fuzz_states 1 250000
	$(IN_ONE_GO) 'refused,elements,places,sums' $(BUILD)/check/bodies
	$(IN_ONE_GO) 'statement,states,starts,wrong bodies,steps/tangents,runs' $(BUILD)/check/constraints
	$(IN_ONE_GO) 'gradient,integrals' $(BUILD)/check/gradient
	$(BUILD)/check/fuzz_bodies 1 1000000
	$(PYTHON_SANITIZED)

check-valgrind: ; $(REPORT) "valgrind" $(DO)
do-valgrind: $(addprefix $(BUILD)/check/,library ad)
	$(IN_ONE_GO) 'input/systems,input/functions,input/options,input/many steps,input/counts,faults/integrators' $(VALGRIND) $(BUILD)/check/library
	$(IN_ONE_GO) 'record,domain,tape' $(VALGRIND) $(BUILD)/check/ad

# threads on one system, library and all: integrators of their own, and ensembles
check-threads:
	$(REPORT) "two threads, ten thousand integrators; ensembles; thread sanitizer" $(LOG) \
	    $(MAKE) -s --no-print-directory do-threads BUILD=$(BUILD)/threads CFLAGS='-O1 -g1 -fsanitize=thread'
THREADS := $(patsubst tests/threads/%.c,%,$(filter-out %/blas.c,$(wildcard tests/threads/*.c)))
do-threads: $(THREADS:%=$(BUILD)/check/threads-%)
	for program in $^; do TSAN_OPTIONS=halt_on_error=1 OPENBLAS_NUM_THREADS=1 $$program || exit 1; done
$(THREADS:%=$(BUILD)/check/threads-%): $(BUILD)/check/threads-%: $(BUILD)/tests/threads/%.o $(BUILD)/libtvi.a
	@mkdir -p $(@D)
	$(call SAY,LD $@)$(CC) $(CFLAGS) $(LDFLAGS) $(WRAP) -pthread -o $@ $^ $(LIBS)
$(BUILD)/check/threads-ensemble: WRAP = -Wl,--wrap=pthread_create
$(BUILD)/tests/threads/%.o: tests/threads/%.c
	@mkdir -p $(@D)
	$(call SAY,CC $<)$(CC) $(TEST_FLAGS) -c -o $@ $<

# random programs led by coverage, with the sanitizers; SECONDS=n for longer. What fails is left in $(BUILD)/fuzz.
FUZZ_SECONDS  = $(or $(SECONDS),60)
FUZZ_SOURCES := $(wildcard ad/*.c src/*/*.c) $(filter-out %/main.c,$(wildcard tests/fuzz/*.c))
fuzz: need-check
	@mkdir -p $(BUILD)/fuzz/corpus
	clang $(BASE) -Iad -Isrc -O1 -g -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all -o $(BUILD)/fuzz/fuzz \
	    $(FUZZ_SOURCES) $(LIBS)
	cd $(BUILD)/fuzz && OPENBLAS_NUM_THREADS=1 ./fuzz -max_total_time=$(FUZZ_SECONDS) -max_len=512 -len_control=0 -timeout=20 corpus
.PHONY: fuzz

# random steps of random problems against their definition in quadruple precision: SEED=n COUNT=m. One problem alone is printed.
fuzz-steps: need-check
	@$(MAKE) --no-print-directory -s $(BUILD)/check/fuzz_steps
	$(BUILD)/check/fuzz_steps $(or $(SEED),1) $(or $(COUNT),$(if $(SEED),1,1000))
.PHONY: fuzz-steps

# ---- Warnings: all that is compiled --------------------------------------------------------------------------------------

# clang reads all sources and compiles none: the objects named are not made. gcc, which knows more of what may be
# uninitialized or out of bounds as it optimizes, compiles the library and the tests for make check, in CI with WERROR=1.
# check-optimized has the bench, too.

BENCH_SOURCES := $(wildcard bench/*/*.c)
NO_CLANG      := $(QUAD_OBJECTS) $(call objects_of,$(wildcard bench/references/*.c))

check-optimized:
	$(REPORT) "no warnings from gcc that optimizes" $(LOG) \
	    $(MAKE) -s --no-print-directory do-optimized BUILD=$(BUILD)/gcc CC=gcc QUADCC='gcc -Werror' CFLAGS='-O2 -Werror'
do-optimized: $(OBJECTS) $(TEST_OBJECTS) $(call objects_of,$(BENCH_SOURCES))

check-warnings-clang:
	$(REPORT) "no warnings from clang" $(LOG) \
	    $(MAKE) -s --no-print-directory do-warnings-clang BUILD=$(BUILD)/read CC=clang CFLAGS='-Werror -fsyntax-only'
do-warnings-clang: $(filter-out $(NO_CLANG) $(SETS),$(OBJECTS) $(SET_PIECES) $(TEST_OBJECTS) $(call objects_of,$(BENCH_SOURCES)))

# The programs of the bench are linked, some of them with functions of the library replaced by name. None is run.
BENCH_PROGRAMS = $(SWEEP_PROGRAMS) $(SCENE_PROGRAMS) $(EXPERIMENT_PROGRAMS) $(PERFORMANCE_PROGRAMS) $(ADAPTIVE)/adaptive \
                 $(LONGRUN)/longrun $(CONSTRAINTS_PROGRAMS) $(MAPS)/maps $(STABILITY)/break $(COMPARE)/tree/compare
check-bench: ; $(REPORT) "the programs of the bench are built" $(DO)
do-bench: ; $(MAKE) -s --no-print-directory $(JOBS) $(BENCH_PROGRAMS)

# .clang-format, and its 120 columns in comments too, which it leaves as they are; the width of prose
FORMATTED = $(sort $(foreach folder,ad bench include src tests,$(wildcard $(addprefix $(folder)/,*.[ch] *.hpp *.cpp */*.[ch] */*.cpp */*/*.[ch]))))
check-formatting: ; $(REPORT) "formatting" $(DO)
do-formatting:
	clang-format --dry-run -Werror $(FORMATTED)
	! grep -nE '^.{121,}' $(FORMATTED) $(wildcard src/python/tvi/*.py tests/python/*.py tests/cases/*.py docs/python/*.py)
	awk -f tests/prose.awk README.md docs/*.md docs/*/*.md

# ---- What users get ----------------------------------------------------------------------------------------------------

STRICT := -Wall -Wextra -Wpedantic -Wconversion -Werror

# each header alone, in C and in C++, and three programs in C++; that of tvi.hpp in every standard, and with the address
# sanitizer, which finds what an exception would leak, as does one of exceptions through functions of C; numbers that
# are not finite from a program with -ffast-math; std::sin of a jet has an error that says what to write
CXX_STANDARDS := g++/11 g++/14 g++/17 g++/20 g++/23 clang++/11 clang++/14 clang++/17 clang++/20 clang++/2b
check-headers: ; $(REPORT) "headers in C and C++" $(DO)
do-headers: tests/library/header.cpp tests/library/wrapper.cpp tests/library/fast_math.cpp tests/library/thrown.cpp $(BUILD)/libtvi.a
	@mkdir -p $(BUILD)/check
	for header in $(basename $(notdir $(wildcard include/*.h))); do echo "#include \"$$header.h\"" > $(BUILD)/check/$$header.c && \
	    for compiler in 'gcc -std=c11' 'clang -std=c11' 'g++ -std=c++11 -x c++' 'clang++ -std=c++11 -x c++'; do \
	        $$compiler $(STRICT) -Iinclude -fsyntax-only $(BUILD)/check/$$header.c || exit 1; done; done
	for compiler in g++ clang++; do \
	    $$compiler -std=c++17 $(STRICT) -Iinclude -o $(BUILD)/check/header tests/library/header.cpp $(BUILD)/libtvi.a $(LIBS) && \
	    $(BUILD)/check/header || exit 1; done
	for standard in $(CXX_STANDARDS); do \
	    $${standard%/*} -std=c++$${standard#*/} $(STRICT) -Wshadow -Iinclude -fsyntax-only tests/library/wrapper.cpp || exit 1; done
	for compiler in 'g++ -std=c++17' 'clang++ -std=c++11'; do \
	    $$compiler -g -fsanitize=address $(STRICT) -DWITH_EIGEN -isystem /usr/include/eigen3 -Iinclude \
	        -o $(BUILD)/check/wrapper tests/library/wrapper.cpp $(BUILD)/libtvi.a $(LIBS) && \
	    $(BUILD)/check/wrapper || exit 1; \
	    $$compiler -g -fsanitize=address $(STRICT) -Iinclude -o $(BUILD)/check/thrown tests/library/thrown.cpp $(BUILD)/libtvi.a $(LIBS) && \
	    $(BUILD)/check/thrown || exit 1; done
	for compiler in 'gcc -std=c11 -x c' 'clang -std=c11 -x c' 'g++ -std=c++11' 'clang++ -std=c++11'; do \
	    $$compiler -O2 -ffast-math $(STRICT) -Iinclude -o $(BUILD)/check/fast_math tests/library/fast_math.cpp \
	        -x none $(BUILD)/libtvi.a $(LIBS) && $(BUILD)/check/fast_math || exit 1; done
	echo 'jet f(jet x) { return std::sin(x) + std::pow(x, 2); }' > $(BUILD)/check/std.cpp
	for compiler in g++ clang++; do \
	    ! $$compiler -include tvi.hpp -Iinclude -fsyntax-only $(BUILD)/check/std.cpp 2> $(BUILD)/check/std.log && \
	    grep -q 'of a jet write sin(...), without std::' $(BUILD)/check/std.log && \
	    grep -q 'of a jet write pow(...), without std::' $(BUILD)/check/std.log || exit 1; done

# programs outside, with what is installed
check-install: ; $(REPORT) "installed: shared and static, by pkg-config and CMake, in C and C++; manual; uninstall" $(DO)
do-install: all
	CC='$(CC)' CXX='$(CXX)' MAKE='$(MAKE)' PYTHON='$(PYTHON)' STRICT='$(STRICT)' tests/install.sh $(abspath $(BUILD))/check/stage $(VERSION)

# what make dist makes, which takes another build
check-dist: ; $(REPORT) "the tarball: built, tested and installed without git" $(DO)
do-dist:
	CC='$(CC)' MAKE='$(MAKE)' tests/dist.sh $(abspath $(BUILD))/check/dist $(abspath $(BUILD))/tvi-$(VERSION).tar.gz

# the program of the README, by its own command, and with events: 1010 passages, and the steps that there are without; the
# fragments of pages
check-readme: ; $(REPORT) "the programs of the README" $(DO)
do-readme: $(BUILD)/libtvi.a $(BUILD)/libtvi.so
	@mkdir -p $(BUILD)/check
	tests/readme.sh README.md $(BUILD)/check
	CC='$(CC)' STRICT='$(STRICT)' LIBRARY='$(abspath $(BUILD)/libtvi.a) $(LIBS)' \
	    tests/fragments.sh $(abspath $(BUILD))/check/fragments $(filter-out docs/adding.md,$(wildcard docs/*.md))
	awk '/^```/ { inside = !inside; next } inside' docs/adding.md > $(BUILD)/check/adding.c
	$(CC) -std=c11 $(STRICT) -Iinclude -Iad -Isrc -DTVI_AT_THIRD=5 -Dtvi_type1_two_thirds=tvi_type1_start -fsyntax-only $(BUILD)/check/adding.c
	$(MAKE) -s --no-print-directory help | grep -q '^make install '
	for program in readme readme_step readme_events; do \
	    $(CC) -std=c11 $(STRICT) -Iinclude -o $(BUILD)/check/readme $(BUILD)/check/$$program.c $(BUILD)/libtvi.a $(LIBS) && \
	    $(BUILD)/check/readme > $(BUILD)/check/$$program.out || exit 1; done
	sh -c "$$(sed -n 's/^    \(cc program.c -I.*\) && .*/\1/p' README.md | sed 's|program.c|-o $(BUILD)/check/readme $(BUILD)/check/readme.c|; s| build/| $(BUILD)/|')"
	$(BUILD)/check/readme | cmp - $(BUILD)/check/readme.out
	cat $(BUILD)/check/readme.out
	grep -F "$$(sed -n 's/^    \(q = .*,\) error .*/\1/p' README.md)" $(BUILD)/check/readme.out $(BUILD)/check/readme_step.out
	test "$$(grep -c closest $(BUILD)/check/readme_events.out)" = 1010
	tail -n 1 $(BUILD)/check/readme_events.out | cmp - $(BUILD)/check/readme_step.out
	awk '/^```python$$/ { inside = 1; next } /^```/ { inside = 0 } inside' README.md >$(BUILD)/check/program.py
	sh -c "$$(sed -n 's/^    \(PYTHONPATH=.*\) program.py$$/\1/p' README.md | sed 's| [^ ]*/python3$$| $(PYTHON)|; s|=build/|=$(BUILD)/|') $(BUILD)/check/program.py" | \
	    grep "^$$(sed -n 's/^It prints `\(.* -0.6859\).*/\1/p' README.md | sed 's/\[/\\[/')"

# programs that users wrote, and what they have to print: tests/cases/cases.txt
check-cases: ; $(REPORT) "cases: each passes or fails as its line says" $(DO)
check-cases-long: ; $(REPORT) "cases that take longer" $(DO)
CASES = $(PYTHON_HERE) CXX='$(CXX)' STRICT='$(STRICT)' LIBS='$(LIBS)' PYTHON='$(PYTHON)' \
        tests/cases.sh tests/cases/cases.txt $(abspath $(BUILD))
do-cases: $(BUILD)/libtvi.a $(BUILD)/libtvi.so
	$(CASES) check
do-cases-long: $(BUILD)/libtvi.a $(BUILD)/libtvi.so
	$(CASES) long

# what make verify does, on a small document; the last line of make check
check-tables: ; $(REPORT) "tables of the documents: verify and replace; verdicts" $(DO)
do-tables:
	tests/tables.sh $(BUILD)
	tests/verdicts.sh $(BUILD)/check/verdicts

# the programs of docs/examples
check-examples: ; $(REPORT) "the examples, as their README says" $(DO)
do-examples: all
	MAKE='$(MAKE)' STRICT='$(STRICT)' tests/examples.sh $(abspath $(BUILD))/check/examples

# what linked programs rely on; `make abi` writes the file anew, and prints what is lost
ABI = CC='$(CC)' tests/abi.sh $(1) $(BUILD)/check/abi $(BUILD)/libtvi.so tests/abi.txt include/*.h
check-symbols: ; $(REPORT) "symbols: the ABI, no globals that change, nothing that prints" $(DO)
do-symbols: $(BUILD)/libtvi.so $(BUILD)/libtvi.a
	$(call ABI,compare)
	tests/symbols.sh $^ tests/abi.txt
abi: $(BUILD)/libtvi.so
	$(call ABI,renew)
.PHONY: abi

# a program that links the static library may use every other name for its own; DW.ref. is the compiler's, of cleanups
check-names: ; $(REPORT) "names: all that can be linked begin with tvi_ or jet_; none has more than 32 characters" $(DO)
do-names: $(BUILD)/libtvi.a
	tests/long_names.sh
	tests/constants.sh >/dev/null
	nm -A -g --defined-only $< | awk '{ names++ } $$NF !~ /^(tvi|jet)_|^DW\.ref\./ { print; failed = 1 } END { exit failed || !names }'

# the constants that were found by trials, with the commands that show what they do, and their number
constants: ; @tests/constants.sh
.PHONY: constants

check-floors: ; $(REPORT) "floors: no include goes up; no file, function or structure is large; names of pages" $(DO)
do-floors:
	tests/floors.sh
	tests/named.sh $(addprefix docs/,walk.md adding.md contributing.md notation.md jets.md)
	tests/sizes.sh
	tests/structures.sh

# what a step of each scene costs, in instructions; `make instructions` writes the file anew
INSTRUCTIONS := tests/instructions.sh $(BUILD)/bench/steps/steps tests/instructions.txt
COMPILED_BY   = '$(shell $(CC) --version | head -n 1), $(CFLAGS), $(shell $(CC) -dumpmachine), $(or $(HAS_SLEEF),no sleef)'
check-instructions: ; $(REPORT) "instructions of a step" $(DO)
do-instructions: $(BUILD)/bench/steps/steps
	$(INSTRUCTIONS) compare $(COMPILED_BY)
instructions: need-check
	@$(MAKE) --no-print-directory $(BUILD)/bench/steps/steps
	$(INSTRUCTIONS) renew $(COMPILED_BY)
.PHONY: instructions

include tests/python.mk
include tests/arm.mk
include tests/analyse.mk
