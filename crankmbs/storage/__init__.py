"""Files that appear together or not at all, and netCDF that is not believed when it is read.

What a result holds belongs in `crankmbs.result`; tables of a scene in `scene`.
"""
