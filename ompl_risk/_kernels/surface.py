"""Height of a triangulated height field: cells split from the south-west to the north-east post."""

from __future__ import annotations

from ompl_risk._kernels.jit import kernel


@kernel
def height_at(heights, x0, y0, dx, dy, x, y):
    """Height of the surface at (x, y), which must lie within the extent.

    With fx, fy in [0, 1] the offset within the cell, in barycentric form, exact at the posts:
    (1 - fx) SW + (fx - fy) SE + fy NE where fx >= fy, else (1 - fy) SW + (fy - fx) NW + fx NE.
    """
    ny, nx = heights.shape
    u = (x - x0) / dx
    v = (y - y0) / dy
    i = min(max(int(u), 0), nx - 2)  # the last post belongs to the last cell
    j = min(max(int(v), 0), ny - 2)
    fx = min(max(u - i, 0.0), 1.0)  # rounding may leave the cell by one unit in the last place
    fy = min(max(v - j, 0.0), 1.0)
    sw = heights[j, i]
    ne = heights[j + 1, i + 1]
    if fx >= fy:
        return (1.0 - fx) * sw + (fx - fy) * heights[j, i + 1] + fy * ne
    return (1.0 - fy) * sw + (fy - fx) * heights[j + 1, i] + fx * ne


@kernel
def heights_at(heights, x0, y0, dx, dy, xs, ys, out):
    """Write the height at each (xs[k], ys[k]) to out[k]; all of one length, within the extent."""
    for k in range(xs.shape[0]):
        out[k] = height_at(heights, x0, y0, dx, dy, xs[k], ys[k])
