"""The normal state of every axis: quantities of windows, conditions of operation, regression, dispersion."""
