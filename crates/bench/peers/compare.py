"""Prints how far pictures differ from the first: compare.py FIRST OTHER...

The mean difference of their light, averaged over blocks of pixels so that noise goes and what is in the picture stays,
relative to the mean of the first; one line each.
"""

import sys

import numpy as np
from PIL import Image

# Pixels along a side of a block.
BLOCK = 16


def blocks(picture):
    encoded = np.asarray(Image.open(picture).convert("RGB"), np.float64) / 255
    linear = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    rows, columns = (size // BLOCK for size in linear.shape[:2])
    whole = linear[: rows * BLOCK, : columns * BLOCK]
    return whole.reshape(rows, BLOCK, columns, BLOCK, 3).mean((1, 3))


first, *others = map(blocks, sys.argv[1:])
for other in others:
    print(f"{np.abs(first - other).mean() / first.mean():.1%}")
