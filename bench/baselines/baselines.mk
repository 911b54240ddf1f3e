# The baselines and their comparison. For the Makefile to include after bench.mk and tests.mk; without it make check builds
# and tests the baselines too, but not those of GSL and SUNDIALS.

# gcc; vectors of pairs of numbers that were stored one by one would wait for them, hence no -ftree-slp-vectorize
BASELINE_FLAGS := -O3 -march=native -fno-math-errno -ffp-contract=fast -fno-tree-slp-vectorize

# packages: libgsl-dev, libsundials-dev, which has no pkg-config file
BASELINE_GSL      := $(shell pkg-config --libs gsl 2>/dev/null)
BASELINE_SUNDIALS := $(if $(wildcard /usr/include/arkode/arkode_erkstep.h),-lsundials_cvode -lsundials_arkode \
                     -lsundials_nvecserial -lsundials_sunnonlinsolfixedpoint)
BASELINE_LIBS     := $(BASELINE_GSL) $(BASELINE_SUNDIALS)
BASELINE_DEFINES  := $(if $(BASELINE_GSL),-DBASELINES_GSL) $(if $(BASELINE_SUNDIALS),-DBASELINES_SUNDIALS)
BASELINE_OBJECTS   = $(patsubst %.c,$(BUILD)/%.o,$(filter-out %/compare.c,$(wildcard bench/baselines/*.c)))

# SCENE=name for one scene; PEERS=folder: only Gauss collocation, against another program of it, folder/gauss
compare: need-bench
	@$(MAKE) --no-print-directory $(BUILD)/bench/compare
	$(BUILD)/bench/compare --out $(BUILD)/bench/baselines $(if $(SCENE),--scene $(SCENE)) $(if $(PEERS),--peers $(PEERS))
.PHONY: compare

$(BUILD)/bench/compare: $(BUILD)/bench/baselines/compare.o $(BASELINE_OBJECTS) $(BUILD)/bench/run.o $(BUILD)/bench/report.o \
                        $(SCENE_OBJECTS) $(BUILD)/libtvi.a
	$(CC) $(CFLAGS) -o $@ $^ $(BASELINE_LIBS) $(LIBS)

$(BUILD)/check/baselines: CHECK_LIBS += $(BASELINE_LIBS)

$(BUILD)/bench/baselines/%.o: bench/baselines/%.c
	@mkdir -p $(@D)
	$(CC) $(TOOL) $(CFLAGS) $(BASELINE_FLAGS) $(BASELINE_DEFINES) -DBASELINE_FLAGS='"$(BASELINE_FLAGS)"' -MMD -c -o $@ $<
