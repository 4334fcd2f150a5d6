"""Converters of published data sets, one module each: ``convert(sources, folder)`` writes the files of the registry."""

WHOLE_PACKAGE = True
