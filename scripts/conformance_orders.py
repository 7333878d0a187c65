# SPDX-License-Identifier: MIT
"""Orders of points across surfaces (metrics/orders.h), by loops over points in Python."""

import numpy as np

DRAWS, MARGIN = 4000, 0.05


def numbers():
    """Knuth's MMIX generator from 0, its upper 31 bits."""
    state = 0
    while True:
        state = (state * 6364136223846793005 + 1442695040888963407) % 2**64
        yield state >> 33


def order_percent(surfaces, found, pixels, size):
    """surfaces, found: depth maps, nearest first, 0: none. pixels: which count."""
    points = [(k, y, x) for k, z in enumerate(surfaces)
              for y, x in np.argwhere((z > 0) & (surfaces[1] > 0) & pixels)]
    number = numbers()
    right = count = 0
    for _ in range(DRAWS):
        drawn = sorted((points[next(number) % len(points)] for _ in range(size)),
                       key=lambda p: float(surfaces[p[0]][p[1:]]))
        true = [float(surfaces[p[0]][p[1:]]) for p in drawn]
        if any(b < (1 + MARGIN) * a for a, b in zip(true, true[1:])):
            continue
        z = [0.0] + [float(found[k][y, x]) for k, y, x in drawn]
        count += 1
        right += all(b > a for a, b in zip(z, z[1:]))
    return 100 * right / count


def order_vectors(vector, surfaces, found, pixels, where):
    for size, name in [(2, "pairs"), (3, "triplets"), (4, "quadruplets")]:
        vector(f"order-{name}", order_percent(surfaces, found, pixels, size),
               f"{where}; of {DRAWS} draws those with depths 5 % apart")
