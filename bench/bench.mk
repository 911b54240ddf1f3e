# The order sweeps and the quadruple-precision references. Included by the Makefile.

SCENES       := $(wildcard bench/scenes/*.c)
SCENE_OBJECTS = $(patsubst %.c,$(BUILD)/%.o,$(SCENES))
include bench/baselines/baselines.mk

SWEEP_OBJECTS = $(patsubst %.c,$(BUILD)/%.o,$(wildcard bench/runs/*.c)) $(BASELINE_OBJECTS) $(SCENE_OBJECTS)

# CSV, tables and plots in $(BUILD)/bench; SCENE=name for one scene, BUDGET=seconds for all of it.
bench: need-bench
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/sweep/sweep
	$(BUILD)/bench/sweep/sweep --out $(BUILD)/bench $(if $(SCENE),--scene $(SCENE)) $(if $(BUDGET),--budget $(BUDGET))
	gnuplot -c bench/sweep/plot.gp $(BUILD)/bench
	@echo "Tables and plots: $(BUILD)/bench/*.csv, *.png, *.svg"

# the tables of docs/choosing.md, five minutes
choose: need-library
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/choosing/choose
	$(BUILD)/bench/choosing/choose $(BUILD)/bench/choosing $(BUDGET)

# the table of tails of docs/choosing.md
tails: need-library
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/choosing/tails
	@mkdir -p $(BUILD)/bench/choosing
	OPENBLAS_NUM_THREADS=1 $(BUILD)/bench/choosing/tails $(BUILD)/bench/choosing
	@cat $(BUILD)/bench/choosing/tails.md
.PHONY: tails

# the table of suggested steps of docs/choosing.md; METHOD=name ORDER=n for another method
suggest: need-library
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/choosing/suggest
	OPENBLAS_NUM_THREADS=1 $(BUILD)/bench/choosing/suggest $(BUILD)/bench/choosing $(or $(METHOD),galerkin) $(or $(ORDER),16)
	@cat $(BUILD)/bench/choosing/suggest.md
.PHONY: suggest

# the table of docs/adaptive.md of runs to a tolerance that meet narrow forces
tolerance: need-library all
	$(call need,$(foreach package,numpy cffi matplotlib,'python3-$(package):$(HAS_PYTHON)') \
	    'python3-scipy:/usr/bin/python3 -c "import scipy"')
	@mkdir -p $(BUILD)/bench/tolerance
	$(PYTHON_HERE) /usr/bin/python3 -W ignore bench/tolerance/tolerance.py $(BUILD)/bench/tolerance/tolerance.md
	@cat $(BUILD)/bench/tolerance/tolerance.md
.PHONY: tolerance

# the first picture of README.md: an eccentric orbit beside SciPy's DOP853, ten seconds
orbit: need-bench all
	$(call need,$(foreach package,numpy cffi,'python3-$(package):$(HAS_PYTHON)') \
	    'python3-scipy:/usr/bin/python3 -c "import scipy"')
	@mkdir -p $(BUILD)/bench/orbit
	$(PYTHON_HERE) /usr/bin/python3 bench/orbit/orbit.py $(BUILD)/bench/orbit
	gnuplot -c bench/orbit/orbit.gp $(BUILD)/bench/orbit bench/experiments
	@cat $(BUILD)/bench/orbit/orbit.txt
.PHONY: orbit

# light bodies beside heavy ones in every kind of steps: which are right, refused, or warned of
light: need-library all
	$(call need,$(foreach package,numpy cffi matplotlib,'python3-$(package):$(HAS_PYTHON)'))
	@mkdir -p $(BUILD)/bench/light
	$(PYTHON_HERE) /usr/bin/python3 bench/light/light.py $(BUILD)/bench/light/light.md
	@cat $(BUILD)/bench/light/light.md
.PHONY: light

# the table and the picture of docs/order-doubling.md
order-doubling: need-bench
	@$(MAKE) --no-print-directory $(JOBS) $(BUILD)/bench/order_doubling/order_doubling
	$(BUILD)/bench/order_doubling/order_doubling $(BUILD)/bench/order-doubling
	gnuplot -c bench/order_doubling/order_doubling.gp $(BUILD)/bench/order-doubling
.PHONY: order-doubling

# the tables and the picture of docs/chaos.md
chaos: need-bench
	@$(MAKE) --no-print-directory $(BUILD)/bench/chaos/chaos
	OPENBLAS_NUM_THREADS=1 $(BUILD)/bench/chaos/chaos $(BUILD)/bench
	gnuplot -c bench/chaos/chaos.gp $(BUILD)/bench bench/experiments
.PHONY: chaos

# The generated tables and pictures of the documents: all made anew and compared, but for times; or put into the
# documents; or those alone that one target makes: make performance-docs, make choose-docs. Without REBOUND and
# heyoka what shows them stays as it is.
DOCUMENTS ?= README.md $(wildcard docs/*.md)
verify: need-bench
	MAKE='$(MAKE)' bench/tables.sh verify $(BUILD) all $(DOCUMENTS)
docs-tables: need-bench
	MAKE='$(MAKE)' WITHOUT=$(if $(and $(REBOUND),$(HEYOKA)),,peers) bench/tables.sh replace $(BUILD) all $(DOCUMENTS)
%-docs: need-bench
	MAKE='$(MAKE)' bench/tables.sh replace $(BUILD) $* $(DOCUMENTS)
.PHONY: verify docs-tables

# all of them, or those of SCENE=name
references: need-library
	@$(MAKE) --no-print-directory $(BUILD)/bench/references/reference
	$(BUILD)/bench/references/reference $(SCENE) > $(BUILD)/bench/references.txt
	$(if $(SCENE),bench/references/replace.sh $(SCENE) bench/scenes/references.h,cat) \
	    $(BUILD)/bench/references.txt > $(BUILD)/bench/references.h
	mv $(BUILD)/bench/references.h bench/scenes/references.h

SWEEP_PROGRAMS := $(BUILD)/bench/sweep/sweep $(BUILD)/bench/choosing/choose \
                  $(BUILD)/bench/order_doubling/order_doubling $(BUILD)/bench/chaos/chaos
$(BUILD)/bench/sweep/sweep: $(BUILD)/bench/sweep/bench.o $(BUILD)/bench/sweep/summary.o
$(BUILD)/bench/chaos/chaos: $(BUILD)/bench/experiments/experiment.o
$(filter-out %/sweep,$(SWEEP_PROGRAMS)): %: %.o
$(SWEEP_PROGRAMS): $(SWEEP_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -pthread -o $@ $(filter %.o,$^) $(filter %.a,$^) $(BASELINE_LIBS) $(LIBS)

# what callgrind runs is steps
SCENE_PROGRAMS := $(BUILD)/bench/choosing/tails $(BUILD)/bench/choosing/suggest $(BUILD)/bench/steps/steps
$(BUILD)/bench/choosing/tails: $(BUILD)/bench/stability/cases.o
$(SCENE_PROGRAMS): %: %.o $(SCENE_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(LIBS)

REFERENCE_SOURCES := $(wildcard bench/references/*.c)
REFERENCE_OBJECTS := $(REFERENCE_SOURCES:%.c=$(BUILD)/%.o)
$(BUILD)/bench/references/reference: $(REFERENCE_OBJECTS) $(SCENE_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -o $@ $^ $(LIBS) -lquadmath
$(REFERENCE_OBJECTS): $(BUILD)/bench/references/%.o: bench/references/%.c
	@mkdir -p $(@D)
	$(call SAY,CC $<)$(QUADCC) $(QUAD) -MMD -MP -c -o $@ $<

$(BUILD)/bench/%.o: bench/%.c
	@mkdir -p $(@D)
	$(call SAY,CC $<)$(CC) $(TOOL) $(CFLAGS) -DBENCH_CFLAGS='"$(BASE) $(CFLAGS)"' -MMD -MP -c -o $@ $<

# what runs cost in Python beside C: the figures of docs/python.md, half a minute
python-cost: need-check all
	@mkdir -p $(BUILD)/bench/python
	@$(CC) -std=c11 -O2 -Iinclude -o $(BUILD)/bench/python/cost bench/python/cost.c $(BUILD)/libtvi.a $(LIBS)
	@$(PYTHON_HERE) $(PYTHON) bench/python/cost.py $(BUILD)/bench/python/cost
.PHONY: python-cost
