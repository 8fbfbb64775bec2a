"""Opens a grid with meshio and says what is in it, as JSON: volume_read.py FILE."""

import json
import sys

import meshio
import numpy

mesh = meshio.read(sys.argv[1])
finite = {}
for name, blocks in mesh.cell_data.items():
    counts = {}
    for block, values in zip(mesh.cells, blocks):
        values = numpy.asarray(values).reshape(len(block.data), -1)
        number = int(numpy.isfinite(values).all(axis=1).sum())
        if number:
            counts[block.type] = counts.get(block.type, 0) + number
    finite[name] = counts
total = sum(float(numpy.nansum(values)) for values in mesh.cell_data.get("form1", []))
cells = {block.type: len(block.data) for block in mesh.cells}
print(json.dumps({"points": len(mesh.points), "cells": cells, "finite": finite, "sum": total}))
