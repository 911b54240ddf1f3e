# install.mk - make install and make uninstall below $(DESTDIR)$(PREFIX), manual pages, the module of Python, make dist.
# Included by the Makefile.

LIBDIR     ?= $(PREFIX)/lib
LIB         = $(LIBDIR:$(PREFIX)/%=%)
HEADERS    := $(notdir $(wildcard include/*))
MAN        := $(BUILD)/man/man3
PAGES      := $(wildcard docs/*.md docs/CITATION.cff docs/*.png docs/*/*.png docs/examples/* docs/python/*.py docs/python/*.md)
ROOT        = $(DESTDIR)$(PREFIX)
CMAKE       = $(LIB)/cmake/tvi
SHARE      := share/doc/tvi
PAGE_DIRS  := $(patsubst docs/%,$(SHARE)/%,$(filter-out docs/,$(sort $(dir $(PAGES)))))
FILLED      = $(LIB)/pkgconfig/tvi.pc $(LIB)/pkgconfig/tvi-static.pc $(CMAKE)/tvi-config.cmake $(CMAKE)/tvi-config-version.cmake
FILL        = -e 's|@PREFIX@|$(PREFIX)|' -e 's|@LIB@|$(LIB)|' -e 's|@UP@|$(shell echo $(LIB) | sed 's|[^/]\+|..|g')|' \
              -e 's|@VERSION@|$(VERSION)|' -e 's|@SOVERSION@|$(SOVERSION)|' -e 's|@SLEEF@|$(HAS_SLEEF)|'
# the module, where this Python, which is asked once, looks below the prefix; a link to the library stands beside it
PYTHON_LOOKS = import site, sys; dirs = [d for d in site.getsitepackages() if d.startswith("$(PREFIX)/")]; \
               print(dirs[0] if dirs else "$(PREFIX)/lib/python%d.%d/site-packages" % sys.version_info[:2])
PYTHONDIR   = $(eval PYTHONDIR := $(shell $(PYTHON) -c '$(PYTHON_LOOKS)' 2>/dev/null))$(PYTHONDIR)
MODULE      = $(PYTHONDIR:$(PREFIX)/%=%)/tvi
MODULES     = $(if $(PYTHONDIR),$(patsubst src/python/tvi/%,$(MODULE)/%,$(wildcard src/python/tvi/*.py src/python/tvi/py.typed)))
TO_LIB      = $(shell echo $(MODULE) | sed 's|[^/]\+|..|g')/$(LIB)
INSTALLED   = $(HEADERS:%=include/%) $(LIB)/libtvi.a $(LIB)/libtvi.so.$(VERSION) $(LIB)/libtvi.so.$(SOVERSION) \
              $(LIB)/libtvi.so $(FILLED) $(PAGES:docs/%=$(SHARE)/%) \
              $(patsubst $(BUILD)/man/%,share/man/%,$(wildcard $(MAN)/*.3)) $(MODULES) \
              $(if $(PYTHONDIR),$(MODULE)/libtvi.so.$(SOVERSION))
.PHONY: install uninstall man

install: all
	@[ "$(LIB)" != "$(LIBDIR)" ] || { echo "LIBDIR=$(LIBDIR) is not below PREFIX=$(PREFIX)" >&2; exit 1; }
	@$(MAKE) --no-print-directory man
	install -d $(sort $(dir $(INSTALLED:%=$(ROOT)/%))) $(ROOT)/share/man/man3
	install -m 644 $(HEADERS:%=include/%) $(ROOT)/include
	install -m 644 $(BUILD)/libtvi.a $(ROOT)/$(LIB)
	install -m 755 $(BUILD)/libtvi.so $(ROOT)/$(LIB)/libtvi.so.$(VERSION)
	ln -sf libtvi.so.$(VERSION) $(ROOT)/$(LIB)/libtvi.so.$(SOVERSION)
	ln -sf libtvi.so.$(SOVERSION) $(ROOT)/$(LIB)/libtvi.so
	for file in $(FILLED); do \
	    sed $(FILL) src/packaging/$${file##*/}.in > $(ROOT)/$$file && chmod 644 $(ROOT)/$$file || exit 1; done
	for file in $(PAGES:docs/%=%); do install -m 644 docs/$$file $(ROOT)/$(SHARE)/$$file || exit 1; done
	install -m 644 $(MAN)/*.3 $(ROOT)/share/man/man3
	for file in $(MODULES:$(MODULE)/%=%); do install -m 644 src/python/tvi/$$file $(ROOT)/$(MODULE)/$$file || exit 1; done
	$(if $(PYTHONDIR),ln -sf $(TO_LIB)/libtvi.so.$(SOVERSION) $(ROOT)/$(MODULE)/libtvi.so.$(SOVERSION),@echo 'no Python: without its module')

# what install put there and nothing else; of the directories only the library's own
uninstall: man
	@$(MAKE) --no-print-directory remove-installed
remove-installed:
	@if [ -e $(ROOT)/include/tvi.h ]; then echo 'Removing tvi from $(ROOT), its libraries from $(ROOT)/$(LIB)'; \
	else echo 'No tvi is below $(ROOT): name the PREFIX, LIBDIR and DESTDIR of make install'; fi
	$(if $(V),,@)rm -f $(INSTALLED:%=$(ROOT)/%)
	$(if $(V),,@)$(if $(PYTHONDIR),rm -rf $(ROOT)/$(MODULE)/__pycache__)
	$(if $(V),,@)for folder in $(CMAKE) $(if $(PYTHONDIR),$(MODULE)) $(PAGE_DIRS) $(SHARE); do [ ! -d $(ROOT)/$$folder ] || \
	    rmdir --ignore-fail-on-non-empty $(ROOT)/$$folder; done
.PHONY: remove-installed

# the tarball of a release: what was committed last, with nothing of when or where it was made
dist:
	@[ -e .git ] || { echo 'make dist needs the checkout of git' >&2; exit 1; }
	@mkdir -p $(BUILD)
	git archive --prefix=tvi-$(VERSION)/ -o $(BUILD)/tvi-$(VERSION).tar.gz HEAD
.PHONY: dist

# tvi(3), of tvi.h and the headers beside it, and jet(3), and a page for each function that refers to one of them
man: $(MAN)/tvi.3 $(MAN)/jet.3 ; @:
$(MAN)/tvi.3: EXAMPLE := docs/examples/pendulum.c
$(MAN)/tvi.3: $(filter-out include/tvi.h,$(wildcard include/tvi*.h))
$(MAN)/jet.3: EXAMPLE := docs/examples/vortices.c
$(MAN)/%.3: include/%.h docs/man.awk docs/examples/pendulum.c docs/examples/vortices.c
	@mkdir -p $(@D)
	$(call SAY,MAN $@)for name in $$(awk -v names=1 -f docs/man.awk $(filter %.h,$^)); do echo '.so man3/$*.3' > $(@D)/$$name.3; done
	$(if $(V),,@)awk -v version=$(VERSION) -v date="$$(date -r $< +%Y-%m-%d)" -v example=$(EXAMPLE) -f docs/man.awk \
	    $(filter %.h,$^) > $@
