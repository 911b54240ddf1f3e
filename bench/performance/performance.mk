# What docs/performance.md shows, five minutes. Included by the Makefile after bench.mk.

PERFORMANCE          := cost dispatch events compiled compiling rivals ensembles
PERFORMANCE_DIR       = $(BUILD)/bench/performance
PERFORMANCE_PROGRAMS  = $(PERFORMANCE:%=$(PERFORMANCE_DIR)/%)
PERFORMANCE_SHARED    = $(patsubst %,$(PERFORMANCE_DIR)/%.o,turns bodies curves stepping) $(EXPERIMENTS_DIR)/experiment.o

# ONE=name for one of them
performance: need-bench
	@$(MAKE) --no-print-directory -s $(PERFORMANCE_PROGRAMS)
	@for name in $(or $(ONE),$(PERFORMANCE)); do \
	    OPENBLAS_NUM_THREADS=1 $(PERFORMANCE_DIR)/$$name $(PERFORMANCE_DIR) || exit 1; done
	@[ -n "$(ONE)" ] || { echo '| | |'; echo '|---|---|'; \
	    sed -n 's/^# \(processor\|compiler\|flags\|flags of the baselines\|widest instruction set\): \(.*\)/| \1 | \2 |/p' \
	        $(PERFORMANCE_DIR)/work_precision.csv; } >$(PERFORMANCE_DIR)/machine.md
	@[ -n "$(ONE)" ] || gnuplot -c bench/performance/performance.gp $(PERFORMANCE_DIR) bench/experiments
	@for file in $(PERFORMANCE_DIR)/$(ONE)*.md; do echo && cat $$file; done

.PHONY: performance

# in a library whose devices are chosen as it runs
devices: need-bench
	@$(MAKE) --no-print-directory -s $(JOBS) BUILD=$(BUILD)/devices DEVICES=1 $(BUILD)/devices/bench/performance/devices
	@mkdir -p $(PERFORMANCE_DIR) && OPENBLAS_NUM_THREADS=1 $(BUILD)/devices/bench/performance/devices $(PERFORMANCE_DIR)
	@cat $(PERFORMANCE_DIR)/devices.md
.PHONY: devices

# the recurrences by hand, compiled as the library is
BY_HAND = $(PERFORMANCE_DIR)/by_hand.o $(ISAS:%=$(PERFORMANCE_DIR)/by_hand_%.o)
$(BY_HAND): BASE += -Ibench -Ibench/scenes -Ibench/baselines
$(PERFORMANCE_DIR)/by_hand.o: TOOL = $(BASE)
$(PERFORMANCE_DIR)/%.o: TOOL += -Ibench/baselines $(if $(ISAS),-DJET_ISA_X86)
$(PERFORMANCE_DIR)/compiled: $(BY_HAND)
$(PERFORMANCE_DIR)/compiled: $(BUILD)/bench/adaptive/solution.o

# matrices where the library takes products, and the reverse
$(PERFORMANCE_DIR)/cost: LDFLAGS += -Wl,--wrap=tvi_curve_choose_jacobians

$(PERFORMANCE_PROGRAMS) $(PERFORMANCE_DIR)/devices: $(PERFORMANCE_DIR)/%: $(PERFORMANCE_DIR)/%.o $(PERFORMANCE_SHARED) $(SWEEP_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) $(LDFLAGS) -o $@ $^ $(BASELINE_LIBS) $(LIBS)
