"""The report: pure functions that assemble its results, and the rendering of its pages.

Only numpy, netCDF4 and jinja2 are imported, so that the report is built in about a second.
"""
