# Roundoff in long runs: docs/roundoff.md. Included by the Makefile, after bench.mk.

LONGRUN         = $(BUILD)/bench/longrun
LONGRUN_OBJECTS = $(patsubst %.c,$(BUILD)/%.o,$(wildcard bench/longrun/*.c)) $(EXPERIMENTS_DIR)/experiment.o
MINUTES        ?= 23

# MINUTES=n: more or fewer orbits; SCENE=kepler: the rows of one scene, without the picture; COMPILED=1: by generated
# code. Fails where a row does not do what it must.
longrun: need-bench
	@$(MAKE) --no-print-directory $(LONGRUN)/longrun
	@$(if $(COMPILED),LONGRUN_COMPILED=1) $(LONGRUN)/longrun $(LONGRUN) $(MINUTES) $(SCENE); status=$$?; cat $(LONGRUN)/longrun.md; \
	$(if $(SCENE),,gnuplot -c bench/longrun/longrun.gp $(LONGRUN) bench/experiments &&) exit $$status
.PHONY: longrun

# a library whose Galerkin steps have the rule of sooner.h in the place of their own, and the rounding of nearest.h
$(LONGRUN)/sooner/libtvi.a: bench/longrun/sooner.h bench/longrun/nearest.h $(BUILD)/libtvi.a
	@$(MAKE) --no-print-directory BUILD=$(LONGRUN)/sooner SOONER=1 $@
ifdef SOONER
$(BUILD)/src/galerkin/%.o: BASE += -Ibench/longrun -include sooner.h
$(BUILD)/src/galerkin/lobatto%o: BASE += -include nearest.h
endif
$(LONGRUN)/longrun: $(LONGRUN_OBJECTS) $(SWEEP_OBJECTS) $(LONGRUN)/sooner/libtvi.a
	$(call SAY,LD $@)$(CC) $(CFLAGS) -pthread -o $@ $^ $(BASELINE_LIBS) $(LIBS)
