"""Figures of the paper, one module each, drawn from result files as SVG.

What a figure shows is computed in :mod:`jointwear.publishing.figures.curves`, which the report reads too; the drawing
modules import matplotlib and nothing else that is heavy.
"""
