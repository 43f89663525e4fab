"""Nearest point on the triangles of some cells of a height field."""

from __future__ import annotations

from ompl_risk._kernels.jit import kernel


@kernel
def _segment(px, py, pz, ux, uy, uz, best, qx, qy, qz, ox, oy, oz):
    """Nearest point on the segment from the origin ``o`` along ``u``, if nearer than ``best``."""
    rx, ry, rz = px - ox, py - oy, pz - oz
    along, length = rx * ux + ry * uy + rz * uz, ux * ux + uy * uy + uz * uz
    if along > 0.0:
        if along >= length:
            rx, ry, rz = rx - ux, ry - uy, rz - uz
            ox, oy, oz = ox + ux, oy + uy, oz + uz
        elif (rx * rx + ry * ry + rz * rz - best) * length < along * along:
            s = along / length
            rx, ry, rz = rx - s * ux, ry - s * uy, rz - s * uz
            ox, oy, oz = ox + s * ux, oy + s * uy, oz + s * uz
        else:
            return best, qx, qy, qz
    distance = rx * rx + ry * ry + rz * rz
    if distance < best:
        return distance, ox, oy, oz
    return best, qx, qy, qz


@kernel
def _lower(x, y, z, dx, dy, sw, se, ne, best, qx, qy, qz, x0, y0, fx, fy, step):
    """Nearest point on the triangle SW, SE, NE, if nearer than ``best`` (squared).

    The foot (fx, fy) of the perpendicular on the plane either lies in the triangle, or the nearest
    point lies on an edge that is visible from the foot.
    """
    if fx <= dx and fy >= 0.0 and fy * dx <= fx * dy:
        return 0.0, x0 + fx, y0 + fy, z - step
    if fy < 0.0:
        best, qx, qy, qz = _segment(x, y, z, dx, 0.0, se - sw, best, qx, qy, qz, x0, y0, sw)
    if fx > dx:
        best, qx, qy, qz = _segment(x, y, z, 0.0, dy, ne - se, best, qx, qy, qz, x0 + dx, y0, se)
    if fy * dx > fx * dy:
        best, qx, qy, qz = _segment(x, y, z, dx, dy, ne - sw, best, qx, qy, qz, x0, y0, sw)
    return best, qx, qy, qz


@kernel
def _upper(x, y, z, dx, dy, sw, nw, ne, best, qx, qy, qz, x0, y0, fx, fy, step):
    """Nearest point on the triangle SW, NE, NW, if nearer than ``best`` (squared)."""
    if fx >= 0.0 and fy <= dy and fy * dx >= fx * dy:
        return 0.0, x0 + fx, y0 + fy, z - step
    if fx < 0.0:
        best, qx, qy, qz = _segment(x, y, z, 0.0, dy, nw - sw, best, qx, qy, qz, x0, y0, sw)
    if fy > dy:
        best, qx, qy, qz = _segment(x, y, z, dx, 0.0, ne - nw, best, qx, qy, qz, x0, y0 + dy, nw)
    if fy * dx < fx * dy:
        best, qx, qy, qz = _segment(x, y, z, dx, dy, ne - sw, best, qx, qy, qz, x0, y0, sw)
    return best, qx, qy, qz


@kernel
def nearest_in_cells(heights, i0, i1, j0, j1, known, dx, dy, x, y, z, best, qx, qy, qz):
    """Nearest point on the cells of rows i0 to i1, columns j0 to j1 (exclusive) but ``known``.

    Most cells are dismissed by their bounding box, most triangles by their plane.
    """
    per_dx, per_dy = 1.0 / dx, 1.0 / dy
    for i in range(i0, i1):
        y0 = i * dy
        py = y - y0
        v = max(-py, py - dy, 0.0)
        if v * v >= best:
            continue
        sw, nw = heights[i, j0], heights[i + 1, j0]
        for j in range(j0, j1):
            se, ne = heights[i, j + 1], heights[i + 1, j + 1]
            x0 = j * dx
            px = x - x0
            u = max(-px, px - dx, 0.0)
            w = max(z - max(max(sw, se), max(nw, ne)), min(min(sw, se), min(nw, ne)) - z, 0.0)
            if u * u + v * v + w * w >= best or i * (heights.shape[1]) + j == known:
                sw, nw = se, ne
                continue
            gx, gy = (se - sw) * per_dx, (ne - se) * per_dy
            over = z - (sw + gx * px + gy * py)
            n2 = 1.0 + gx * gx + gy * gy
            if over * over < best * n2:
                step = over / n2
                near, qx, qy, qz = _lower(
                    x, y, z, dx, dy, sw, se, ne, best, qx, qy, qz,
                    x0, y0, px + gx * step, py + gy * step, step,
                )  # fmt: skip
                best = near if near > 0.0 else over * step
            gx, gy = (ne - nw) * per_dx, (nw - sw) * per_dy
            over = z - (sw + gx * px + gy * py)
            n2 = 1.0 + gx * gx + gy * gy
            if over * over < best * n2:
                step = over / n2
                near, qx, qy, qz = _upper(
                    x, y, z, dx, dy, sw, nw, ne, best, qx, qy, qz,
                    x0, y0, px + gx * step, py + gy * step, step,
                )  # fmt: skip
                best = near if near > 0.0 else over * step
            sw, nw = se, ne
    return best, qx, qy, qz
