"""Settings of the documentation: built without network, figures drawn by the gallery's scripts."""

import comminute

project = "comminute"
author = "The comminute developers"
version = release = comminute.__version__

extensions = ["myst_parser", "sphinx.ext.mathjax", "sphinx_gallery.gen_gallery"]
myst_enable_extensions = ["amsmath", "dollarmath"]
exclude_patterns = ["_build", "gallery", "validation", "benchmarks.md"]  # these last are read in the source
html_theme = "alabaster"
html_theme_options = {"description": "Confined comminution with grainsize fabric", "fixed_sidebar": True}
suppress_warnings = ["config.cache"]

sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "_gallery",
    "filename_pattern": "plot_",
    "ignore_pattern": "run_all",
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "write_computation_times": False,
}
