# What the working tree costs beside a commit, row by row. Included by the Makefile after bench.mk.

COMPARE          = $(BUILD)/compare
COMPARE_SOURCES := $(wildcard bench/compare/*.c) bench/performance/bodies.c $(SCENES)
COMPARE_HEADERS := $(wildcard include/*.h bench/compare/*.h bench/scenes/*.h) bench/performance/bodies.h

# COMMIT=hash, or another name of a commit; ROWS=pattern for some rows. callgrind knows no AVX-512.
compare-with: need-library
	$(call need,'valgrind:command -v valgrind')
	@[ "$(COMMIT)" ] || { echo 'Say which commit: make compare-with COMMIT=hash' >&2; exit 1; }
	@hash=$$(git rev-parse --verify --short=8 '$(COMMIT)^{commit}') || exit 1; \
	$(MAKE) --no-print-directory $(JOBS) $(COMPARE)/tree/compare $(COMPARE)/$$hash/compare && \
	$(PYTHON) bench/compare/compare.py $(COMPARE)/$$hash $$hash $(COMPARE)/tree tree '$(or $(ROWS),.)' \
	    $(if $(filter base,$(TVI_ISA)),base,avx2)
.PHONY: compare-with

# One program for both libraries, by public headers alone. The commit's own Makefile builds its library, which stays.
compare_link = $(CC) -std=c11 $(WARNINGS) -D_POSIX_C_SOURCE=200809L -I$(1) -Ibench -Ibench/scenes $(CFLAGS) -o $@ \
               $(COMPARE_SOURCES) $(2) $(LDFLAGS)
$(COMPARE)/tree/compare: $(COMPARE_SOURCES) $(COMPARE_HEADERS) $(BUILD)/libtvi.a
	@mkdir -p $(@D)
	$(call SAY,LD $@)$(call compare_link,include,$(BUILD)/libtvi.a $(LIBS))
$(COMPARE)/%/compare: $(COMPARE_SOURCES) $(COMPARE_HEADERS) $(COMPARE)/%/source/build/libtvi.a
	$(call SAY,LD $@)$(call compare_link,$(@D)/source/include,$(@D)/source/build/libtvi.a \
	    $$($(MAKE) -s --no-print-directory -C $(@D)/source BUILD=build libs))
$(COMPARE)/%/source/build/libtvi.a: $(COMPARE)/%/source always
	@$(MAKE) --no-print-directory -C $< BUILD=build build/libtvi.a
$(COMPARE)/%/source:
	@rm -rf $@ $@.part && mkdir -p $@.part && git archive $* | tar -x -C $@.part && mv $@.part $@
.PRECIOUS: $(COMPARE)/%/source $(COMPARE)/%/source/build/libtvi.a
