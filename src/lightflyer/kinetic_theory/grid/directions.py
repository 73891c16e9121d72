"""Quadrature over the directions from which molecules reach a point.

Directions point backwards along the ray, from the point to the origin of the molecule. Each has a
height m = |ω_z| and an azimuth φ about the vertical through the point; φ = 0 points away from the
disk's axis. The distribution function jumps at the cone of rays that hit the disk. Panels end
exactly on this cone and grow with the distance from it, which resolves a distant disk as well.
"""

import numpy as np

from lightflyer.kinetic_theory.grid.kernels import inner_kernel, kernel

_GROWTH = 3.0  # of panel widths away from a cone
_MOST_EDGES = 64
_QUARTER_TURN = 0.5 * np.pi


@kernel
def graded_edges(low, high, at_low, at_high, edges):
    """Fill the edges of panels between two ends, whose widths grow from given ones at each end."""
    left, right = low, high
    lefts, rights = 0, 0
    buffer = np.empty(_MOST_EDGES)
    while right - left > at_low + at_high and lefts + rights < _MOST_EDGES - 4:
        if at_low <= at_high:
            left += at_low
            edges[1 + lefts] = left
            lefts += 1
            at_low *= _GROWTH
        else:
            right -= at_high
            buffer[rights] = right
            rights += 1
            at_high *= _GROWTH
    edges[0] = low
    for k in range(rights):
        edges[1 + lefts + k] = buffer[rights - 1 - k]
    count = 2 + lefts + rights
    edges[count - 1] = high
    return count


@inner_kernel
def _push_ring(directions, count, height, weight, edges, edge_count, nodes, weights):
    horizontal = np.sqrt(max(0.0, (1.0 - height) * (1.0 + height)))
    for panel in range(edge_count - 1):
        low, width = edges[panel], edges[panel + 1] - edges[panel]
        for k in range(nodes.size):
            azimuth = low + width * nodes[k]
            directions[count, 0] = horizontal * np.cos(azimuth)
            directions[count, 1] = horizontal * np.sin(azimuth)
            directions[count, 2] = height
            directions[count, 3] = weight * width * weights[k]
            count += 1
    return count


@inner_kernel
def _push_interval(
    directions, count, sign, ends, scales, ring, ring_count, gauss_height, gauss_azimuth
):
    """Full rings of directions with heights in an interval graded towards its ends."""
    edges = np.empty(_MOST_EDGES)
    if ends[1] <= ends[0]:
        return count
    number = graded_edges(ends[0], ends[1], scales[0], scales[1], edges)
    for panel in range(number - 1):
        width = edges[panel + 1] - edges[panel]
        for k in range(gauss_height.shape[1]):
            height = edges[panel] + width * gauss_height[0, k]
            count = _push_ring(
                directions,
                count,
                sign * height,
                width * gauss_height[1, k],
                ring,
                ring_count,
                gauss_azimuth[0],
                gauss_azimuth[1],
            )
    return count


@inner_kernel
def _ring_edges(end, at_end, edges):
    """Panels in azimuth from 0, graded towards the end, none wider than a quarter turn."""
    if end <= _QUARTER_TURN:
        return graded_edges(0.0, end, end, at_end, edges)
    count = graded_edges(_QUARTER_TURN, end, end, at_end, edges[1:])
    edges[0] = 0.0
    return count + 1


@inner_kernel
def _push_cone(directions, count, point, near, far, gauss_height, gauss_azimuth):
    """Rings of directions that hit the disk in part, split where they do."""
    radius, height = point
    low, high = height / np.hypot(height, far), height / np.hypot(height, near)
    if high <= low:
        return count
    span = np.log(high / low)
    panels = 2 + int(span / 1.5)
    ring = np.empty(_MOST_EDGES)
    for panel in range(panels):
        for k in range(gauss_height.shape[1]):
            t = (panel + gauss_height[0, k]) / panels
            # the azimuth of the edge has a square root at both ends, which this map removes
            m = low * np.exp(span * t * t * (3.0 - 2.0 * t))
            weight = m * span * 6.0 * t * (1.0 - t) * gauss_height[1, k] / panels
            reach = height * np.sqrt((1.0 - m) * (1.0 + m)) / m
            cosine = (1.0 - radius * radius - reach * reach) / (2.0 * radius * reach)
            edge = np.arccos(min(1.0, max(-1.0, cosine)))
            width = np.pi - edge
            number = _ring_edges(edge, max(0.5 * width, 0.02), ring)
            count = _push_ring(
                directions, count, -m, weight, ring, number, gauss_azimuth[0], gauss_azimuth[1]
            )
            ring[0], ring[1], number = edge, np.pi, 2
            if width > _QUARTER_TURN:
                ring[1], ring[2], number = edge + 0.5 * width, np.pi, 3
            count = _push_ring(
                directions, count, -m, weight, ring, number, gauss_azimuth[0], gauss_azimuth[1]
            )
    return count


@kernel
def node_directions(radius, height, layer, gauss_height, gauss_azimuth, directions):
    """Fill the directions for a point above the disk's plane; the azimuth covers half a turn."""
    ring = np.empty(_MOST_EDGES)
    if radius > 1.0:
        half_angle = np.arcsin(1.0 / radius)
        ring_count = _ring_edges(np.pi, max(0.7 * half_angle, 1e-3), ring)
    else:
        ring[0], ring[1], ring[2] = 0.0, _QUARTER_TURN, np.pi
        ring_count = 3
    ends, scales = np.empty(2), np.empty(2)
    if height == 0.0:
        ends[0], ends[1], scales[0], scales[1] = 0.0, 1.0, layer, 1.0
        count = _push_interval(
            directions, 0, 1.0, ends, scales, ring, ring_count, gauss_height, gauss_azimuth
        )
        if radius <= 1.0:
            return count
        return _push_interval(
            directions, count, -1.0, ends, scales, ring, ring_count, gauss_height, gauss_azimuth
        )
    near, far = abs(1.0 - radius), 1.0 + radius
    low, high = height / np.hypot(height, far), height / np.hypot(height, near)
    cone = max(high - low, 1e-3)
    count = 0
    # above the cone (nearer to straight down), below it, and upwards
    ends[0], ends[1], scales[0], scales[1] = high, 1.0, cone if radius > 1.0 else high, 1.0
    count = _push_interval(
        directions, count, -1.0, ends, scales, ring, ring_count, gauss_height, gauss_azimuth
    )
    point = (radius, height)
    count = _push_cone(directions, count, point, near, far, gauss_height, gauss_azimuth)
    ends[0], ends[1], scales[0], scales[1] = 0.0, low, max(low, layer), cone
    count = _push_interval(
        directions, count, -1.0, ends, scales, ring, ring_count, gauss_height, gauss_azimuth
    )
    ends[0], ends[1], scales[0], scales[1] = 0.0, 1.0, max(layer, min(high, 0.5)), 1.0
    return _push_interval(
        directions, count, 1.0, ends, scales, ring, ring_count, gauss_height, gauss_azimuth
    )
