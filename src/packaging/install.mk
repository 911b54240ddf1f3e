# install.mk - make install and make uninstall below $(DESTDIR)$(PREFIX), manual pages. Included by the Makefile.

HEADERS    := tvi jet
MAN        := $(BUILD)/man/man3
ROOT        = $(DESTDIR)$(PREFIX)
FILLED     := lib/pkgconfig/tvi.pc lib/cmake/tvi/tvi-config.cmake lib/cmake/tvi/tvi-config-version.cmake
INSTALLED   = $(HEADERS:%=include/%.h) lib/libtvi.a lib/libtvi.so.$(VERSION) lib/libtvi.so.$(SOVERSION) lib/libtvi.so \
              $(FILLED) $(patsubst $(BUILD)/man/%,share/man/%,$(wildcard $(MAN)/*.3))
.PHONY: install uninstall man

install: all
	@$(MAKE) --no-print-directory man
	install -d $(ROOT)/include $(ROOT)/lib/pkgconfig $(ROOT)/lib/cmake/tvi $(ROOT)/share/man/man3
	install -m 644 $(HEADERS:%=include/%.h) $(ROOT)/include
	install -m 644 $(BUILD)/libtvi.a $(ROOT)/lib
	install -m 755 $(BUILD)/libtvi.so $(ROOT)/lib/libtvi.so.$(VERSION)
	ln -sf libtvi.so.$(VERSION) $(ROOT)/lib/libtvi.so.$(SOVERSION)
	ln -sf libtvi.so.$(SOVERSION) $(ROOT)/lib/libtvi.so
	for file in $(FILLED); do sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' -e 's|@SOVERSION@|$(SOVERSION)|' \
	    src/packaging/$${file##*/}.in > $(ROOT)/$$file && chmod 644 $(ROOT)/$$file || exit 1; done
	install -m 644 $(MAN)/*.3 $(ROOT)/share/man/man3

# what install put there and nothing else; of the directories only the library's own
uninstall: man
	@$(MAKE) --no-print-directory remove-installed
remove-installed:
	rm -f $(INSTALLED:%=$(ROOT)/%)
	[ ! -d $(ROOT)/lib/cmake/tvi ] || rmdir $(ROOT)/lib/cmake/tvi
.PHONY: remove-installed

# tvi(3) and jet(3), and a page for each function that refers to one of them
man: $(HEADERS:%=$(MAN)/%.3)
$(MAN)/%.3: include/%.h docs/man.awk
	@mkdir -p $(@D)
	for name in $$(awk -v names=1 -f docs/man.awk $<); do echo '.so man3/$*.3' > $(@D)/$$name.3; done
	awk -v version=$(VERSION) -v date="$$(date -r $< +%Y-%m-%d)" -f docs/man.awk $< > $@
