# The order sweeps and the quadruple-precision references. Included by the Makefile.

SCENES       := $(wildcard bench/scenes/*.c)
SCENE_OBJECTS = $(patsubst %.c,$(BUILD)/%.o,$(SCENES))
include bench/baselines/baselines.mk

SWEEP_OBJECTS = $(patsubst %,$(BUILD)/bench/%.o,run report contenders sweep) $(BASELINE_OBJECTS) $(SCENE_OBJECTS)

# CSV, tables and plots in $(BUILD)/bench; SCENE=name for one scene, BUDGET=seconds for all of it.
bench: need-bench
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/sweep
	$(BUILD)/bench/sweep --out $(BUILD)/bench $(if $(SCENE),--scene $(SCENE)) $(if $(BUDGET),--budget $(BUDGET))
	gnuplot -c bench/plot.gp $(BUILD)/bench
	@echo "Tables and plots: $(BUILD)/bench/*.csv, *.png, *.svg"

# the tables of docs/choosing.md and README.md, five minutes
choose: need-library
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/choose
	$(BUILD)/bench/choose $(BUILD)/bench/choosing $(BUDGET)

# the table of tails of docs/choosing.md
tails: need-library
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/tails
	@mkdir -p $(BUILD)/bench/choosing
	OPENBLAS_NUM_THREADS=1 $(BUILD)/bench/tails $(BUILD)/bench/choosing
	@cat $(BUILD)/bench/choosing/tails.md
.PHONY: tails

# the tables and the picture of docs/order-doubling.md
order-doubling: need-bench
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/order_doubling
	$(BUILD)/bench/order_doubling $(BUILD)/bench/order-doubling
	gnuplot -c bench/order_doubling.gp $(BUILD)/bench/order-doubling
.PHONY: order-doubling

# the tables and the picture of docs/chaos.md
chaos: need-bench
	@$(MAKE) --no-print-directory $(BUILD)/bench/chaos
	OPENBLAS_NUM_THREADS=1 $(BUILD)/bench/chaos $(BUILD)/bench
	gnuplot -c bench/chaos.gp $(BUILD)/bench bench/experiments
.PHONY: chaos

# the table and the picture of docs/roundoff.md; MINUTES=n for another length of the runs
MINUTES ?= 18
longrun: need-bench
	@$(MAKE) --no-print-directory $(BUILD)/bench/longrun
	$(BUILD)/bench/longrun $(BUILD)/bench $(MINUTES)
	gnuplot -c bench/longrun.gp $(BUILD)/bench bench/experiments
	@cat $(BUILD)/bench/longrun.md
.PHONY: longrun

# The generated tables of the documents: all made anew and compared, but for times; or put into the documents.
DOCUMENTS ?= README.md $(wildcard docs/*.md)
verify: need-bench
	MAKE='$(MAKE)' bench/tables.sh verify $(BUILD) $(DOCUMENTS)
docs-tables: need-bench
	MAKE='$(MAKE)' bench/tables.sh replace $(BUILD) $(DOCUMENTS)
.PHONY: verify docs-tables

references: need-library
	@$(MAKE) --no-print-directory $(BUILD)/bench/reference
	$(BUILD)/bench/reference > $(BUILD)/bench/references.h
	mv $(BUILD)/bench/references.h bench/scenes/references.h

$(BUILD)/bench/sweep: $(BUILD)/bench/bench.o $(BUILD)/bench/summary.o
$(BUILD)/bench/choose: $(BUILD)/bench/choose.o
$(BUILD)/bench/order_doubling: $(BUILD)/bench/order_doubling.o
$(BUILD)/bench/chaos: $(BUILD)/bench/chaos.o $(BUILD)/bench/experiments/experiment.o
$(BUILD)/bench/longrun: $(BUILD)/bench/longrun.o $(BUILD)/bench/experiments/experiment.o
$(BUILD)/bench/sweep $(BUILD)/bench/choose $(BUILD)/bench/order_doubling $(BUILD)/bench/chaos $(BUILD)/bench/longrun: $(SWEEP_OBJECTS) \
                                                                                               $(BUILD)/libtvi.a
	$(CC) $(CFLAGS) -pthread -o $@ $^ $(BASELINE_LIBS) $(LIBS)

$(BUILD)/bench/tails: $(BUILD)/bench/tails.o $(SCENE_OBJECTS) $(BUILD)/libtvi.a
	$(CC) $(CFLAGS) -o $@ $^ $(LIBS)

# what callgrind runs
$(BUILD)/bench/steps: $(BUILD)/bench/steps.o $(SCENE_OBJECTS) $(BUILD)/libtvi.a
	$(CC) $(CFLAGS) -o $@ $^ $(LIBS)

$(BUILD)/bench/reference: $(BUILD)/bench/reference.o $(BUILD)/bench/quad.o $(SCENE_OBJECTS) $(BUILD)/libtvi.a
	$(CC) $(CFLAGS) -o $@ $^ $(LIBS) -lquadmath

$(BUILD)/bench/quad.o $(BUILD)/bench/reference.o: $(BUILD)/bench/%.o: bench/%.c
	@mkdir -p $(@D)
	$(QUADCC) $(QUAD) -MMD -c -o $@ $<

$(BUILD)/bench/%.o: bench/%.c
	@mkdir -p $(@D)
	$(CC) $(TOOL) $(CFLAGS) -DBENCH_CFLAGS='"$(BASE) $(CFLAGS)"' -MMD -c -o $@ $<
