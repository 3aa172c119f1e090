# SPDX-License-Identifier: MIT
# Sphinx, for the source that website.py writes.
project = 'sagitta'
author = copyright = 'the authors of sagitta'
extensions = ['myst_parser']
source_suffix = {'.md': 'markdown'}
root_doc = 'index'
myst_heading_anchors = 5
myst_enable_extensions = ['html_image']
suppress_warnings = ['misc.highlighting_failure',  # a block of code may leave out what is not shown
                     'myst.header']                # a header may have declarations before its first section
language = 'en'
html_theme = 'alabaster'
html_theme_options = {'description': 'Where does a ray meet a surface, and how sure is the answer?', 'fixed_sidebar': False,
                      'page_width': '72rem', 'sidebar_width': '16rem', 'show_powered_by': False}
html_sidebars = {'**': ['about.html', 'searchbox.html', 'navigation.html']}
html_static_path = ['style']
html_css_files = ['site.css']
html_copy_source = False
html_show_sourcelink = False
html_show_copyright = False
pygments_style = 'friendly'
