# Steps on constraints: docs/constraints.md. Included by the Makefile, after performance.mk.

CONSTRAINTS          = $(BUILD)/bench/constraints
CONSTRAINTS_SHARED   = $(CONSTRAINTS)/chain.o $(PERFORMANCE_DIR)/turns.o $(EXPERIMENTS_DIR)/experiment.o
CONSTRAINTS_PROGRAMS = $(CONSTRAINTS)/constraints $(CONSTRAINTS)/work

# package: libsundials-dev; without it there is no IDA and no CVODE
CONSTRAINTS_SUNDIALS := $(if $(wildcard /usr/include/ida/ida.h),-lsundials_ida -lsundials_cvode -lsundials_nvecserial \
                        -lsundials_sunmatrixdense -lsundials_sunmatrixband -lsundials_sunlinsoldense -lsundials_sunlinsolband \
                        -lsundials_sunnonlinsolfixedpoint)

constraints: need-bench
	@$(MAKE) --no-print-directory -s $(CONSTRAINTS_PROGRAMS)
	OPENBLAS_NUM_THREADS=1 $(CONSTRAINTS)/constraints $(CONSTRAINTS)
	OPENBLAS_NUM_THREADS=1 $(CONSTRAINTS)/work $(CONSTRAINTS)
	gnuplot -c bench/constraints/work.gp $(CONSTRAINTS) bench/experiments
	@cat $(CONSTRAINTS)/constraints.md $(CONSTRAINTS)/kept.md $(CONSTRAINTS)/work.md
.PHONY: constraints

# the rivals by hand have the flags of the baselines
$(CONSTRAINTS)/rattle.o $(CONSTRAINTS)/sundials.o: CFLAGS += $(BASELINE_FLAGS) $(if $(CONSTRAINTS_SUNDIALS),-DCONSTRAINTS_SUNDIALS)
$(CONSTRAINTS)/constraints: $(PERFORMANCE_DIR)/stepping.o
$(CONSTRAINTS)/work: $(CONSTRAINTS)/rattle.o $(CONSTRAINTS)/sundials.o $(BUILD)/bench/longrun/constrained.o
$(CONSTRAINTS_PROGRAMS): %: %.o $(CONSTRAINTS_SHARED) $(SWEEP_OBJECTS) $(BUILD)/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -o $@ $(filter %.o,$^) $(filter %.a,$^) $(BASELINE_LIBS) $(CONSTRAINTS_SUNDIALS) $(LIBS)
