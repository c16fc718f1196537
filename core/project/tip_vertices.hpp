#pragma once
#include <span>
#include <vector>

#include "core/mesh/surface_level.hpp"

namespace flowcage {

/// For each tip (FeatureGraph::tips) the vertex of the cage that belongs there: the nearest within half of
/// its mean edge length, one to one, nearest pairs first; no_index where there is none. points: #V.
std::vector<Index> tip_vertices(const SurfaceLevel& level, std::span<const Vec3> points,
                                std::span<const Vec3> tips);

}  // namespace flowcage
