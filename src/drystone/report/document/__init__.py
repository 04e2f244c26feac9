"""The report to hand over: one page, of figures, words and a template."""
