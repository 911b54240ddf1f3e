# arm.mk - make check-arm: builds the library for aarch64 by Debian's cross compiler and runs, by qemu-user, the program
# of the README and the suites whose results depend on vectors, on rounding, on the elementary functions or on long
# double. Included by tests.mk. Everything is below $(BUILD)/arm.

# aarch64 has no libquadmath; long double has quadruple precision there (tests/arm/quadmath.h)
ifneq ($(filter aarch64%,$(shell $(QUADCC) -dumpmachine)),)
QUAD      += -include tests/arm/quadmath.h -Itests/arm
CHECK_LIBS = $(shell pkg-config --libs check) $(LIBS)
endif

PACKAGES_ARM := 'pkg-config:command -v pkg-config' 'gcc-aarch64-linux-gnu:command -v aarch64-linux-gnu-gcc' \
                'libc6-dev-arm64-cross:test -e /usr/aarch64-linux-gnu/include/math.h' 'qemu-user:command -v qemu-aarch64'
need-arm: ; $(call need,$(PACKAGES_ARM))
	@tests/arm.sh $(BUILD)/arm

# the second make has another compiler and another BUILD
ARM          := $(abspath $(BUILD))/arm
ARM_PACKAGES := PKG_CONFIG_SYSROOT_DIR=$(ARM)/root PKG_CONFIG_LIBDIR=$(ARM)/root/usr/lib/aarch64-linux-gnu/pkgconfig
# no suite here needs the baselines, which take long to compile
ARM_HELPERS  := $(filter-out %/generated.c %/reference.c,$(wildcard tests/problems/*.c bench/scenes/*.c bench/references/*.c)) \
                bench/stability/cases.c
check-arm: need-arm
	@echo "Building below $(BUILD)/arm, then checking"
	@$(ARM_PACKAGES) $(MAKE) --no-print-directory -k $(JOBS) run-check-arm ARM=$(ARM) BUILD=$(BUILD)/arm \
	    CC=$(ARM)/bin/cc QUADCC=$(ARM)/bin/cc AR=aarch64-linux-gnu-ar HELPERS='$(ARM_HELPERS:%.c=$(BUILD)/arm/%.o)'

ARM_FOLDERS := ad library generating events
ARM_CHECKS  := check-arm-readme $(ARM_FOLDERS:%=check-arm-%)
.PHONY: need-arm check-arm run-check-arm check-arm-built do-arm-built $(ARM_CHECKS) $(ARM_CHECKS:check-%=do-%)
run-check-arm: $(ARM_CHECKS)
$(ARM_CHECKS): check-arm-built

# the tests are not optimized, since compiling them would take longer than running them; they are linked with what leaves
# out rows of their loops
check-arm-built: ; $(REPORT) "aarch64: the library and the tests are built" $(DO)
do-arm-built: $(BUILD)/libtvi.a $(BUILD)/libtvi.so $(ARM_FOLDERS:%=$(BUILD)/check/%)
ifneq ($(findstring command,$(origin ARM)),)
$(TEST_OBJECTS) $(HELPERS): CFLAGS = -O1 -g
$(ARM_FOLDERS:%=$(BUILD)/check/%): LDFLAGS += -Wl,--wrap=_tcase_add_test
$(ARM_FOLDERS:%=$(BUILD)/check/%): $(BUILD)/tests/arm/sampled.o
$(BUILD)/tests/arm/%.o: tests/arm/%.c
	@mkdir -p $(@D)
	$(call SAY,CC $<)$(CC) $(TEST_FLAGS) -c -o $@ $<
endif

# the command of the README builds its program, with the cross compiler as cc; the printed numbers but the last one are
# those of the README
check-arm-readme: ; $(REPORT) "aarch64: the program of the README" $(DO)
do-arm-readme: export PATH := $(ARM)/bin:$(PATH)
do-arm-readme: $(BUILD)/libtvi.a
	tests/readme.sh README.md $(BUILD)/check
	sh -c "$$(sed -n 's/^    \(cc program.c -I.*\) && .*/\1/p' README.md | sed 's| build/| $(BUILD)/|; s|program.c|-o $(BUILD)/check/readme $(BUILD)/check/readme.c|')"
	$(ARM)/bin/run $(BUILD)/check/readme > $(BUILD)/check/readme.out
	cat $(BUILD)/check/readme.out
	grep -F "$$(sed -n 's/^    \(q = .*,\) error .*/\1/p' README.md)" $(BUILD)/check/readme.out

# One row of so many in each loop runs (tests/arm/sampled.c), since qemu is 10 to 30 times slower than a processor. The
# cross compiler is cc for generated code, too.
$(ARM_FOLDERS:%=check-arm-%): check-arm-%: ; $(REPORT) "aarch64: tests/$*" $(DO)
$(ARM_FOLDERS:%=do-arm-%): export PATH := $(ARM)/bin:$(PATH)
$(ARM_FOLDERS:%=do-arm-%): export TESTS_EVERY = $(EVERY)
do-arm-ad:         EVERY := 4
do-arm-ad:         SUITES := record,domain,tape,series,identity,tangent,adjoint,isa,roots,elementary,gradient,hash,emit
do-arm-library:    EVERY := 6
do-arm-library:    SUITES := closed forms,linear,passes,products,sums,stepping,quad,arena
do-arm-generating: EVERY := 20
do-arm-generating: SUITES := forms,orders,methods,points,convergence,dense,galerkin,serves,statements,fingerprints,references,tangent map
do-arm-events:     EVERY := 8
do-arm-events:     SUITES := events,search,times,tolerance runs,progress
$(ARM_FOLDERS:%=do-arm-%): do-arm-%: $(BUILD)/check/%
	tests/suites.sh '$(SUITES)' $(ARM)/bin/run $<
