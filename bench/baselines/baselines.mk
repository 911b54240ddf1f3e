# The baselines, and what compares them only. Included by bench.mk.

# gcc; vectors of pairs of numbers that were stored one by one would wait for them, hence no -ftree-slp-vectorize
BASELINE_FLAGS := -O3 -march=native -fno-math-errno -ffp-contract=fast -fno-tree-slp-vectorize

# packages: libgsl-dev, libsundials-dev, which has no pkg-config file
BASELINE_GSL      := $(shell pkg-config --libs gsl 2>/dev/null)
BASELINE_SUNDIALS := $(if $(wildcard /usr/include/arkode/arkode_erkstep.h),-lsundials_cvode -lsundials_arkode \
                     -lsundials_nvecserial -lsundials_sunnonlinsolfixedpoint)
BASELINE_LIBS     := $(BASELINE_GSL) $(BASELINE_SUNDIALS)
BASELINE_DEFINES  := $(if $(BASELINE_GSL),-DBASELINES_GSL) $(if $(BASELINE_SUNDIALS),-DBASELINES_SUNDIALS)
BASELINE_OBJECTS   = $(patsubst %.c,$(BUILD)/%.o,$(filter-out %/peers.c,$(wildcard bench/baselines/*.c)))

# the sweep of the baselines only; PEERS=folder: Gauss collocation against another program of it, folder/gauss, instead
compare: need-library
ifdef PEERS
	@$(MAKE) --no-print-directory $(BUILD)/bench/baselines/peers
	$(BUILD)/bench/baselines/peers $(PEERS)
else
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/sweep/sweep
	$(BUILD)/bench/sweep/sweep --baselines --out $(BUILD)/bench/baselines --budget $(or $(BUDGET),60) $(if $(SCENE),--scene $(SCENE))
endif
.PHONY: compare

$(BUILD)/bench/baselines/peers: $(BUILD)/bench/baselines/peers.o $(BUILD)/bench/runs/run.o $(BASELINE_OBJECTS) $(SCENE_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -o $@ $^ $(BASELINE_LIBS) $(LIBS)

$(BUILD)/check/baselines: CHECK_LIBS += $(BASELINE_LIBS)

$(BUILD)/bench/baselines/%.o: bench/baselines/%.c
	@mkdir -p $(@D)
	$(call SAY,CC $<)$(CC) $(TOOL) $(CFLAGS) $(BASELINE_FLAGS) $(BASELINE_DEFINES) -DBASELINE_FLAGS='"$(BASELINE_FLAGS)"' -MMD -MP -c -o $@ $<
