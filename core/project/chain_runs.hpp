#pragma once
#include <span>
#include <vector>

#include "core/project/edge_path.hpp"

namespace flowcage {

/// An end of a feature chain at a corner of the target.
struct ChainEnd {
  Index chain = no_index;
  bool at_start = true;
};

/// #corners rows: the chain ends that meet in each corner of a feature graph; a loop through one corner is
/// there twice.
Csr<ChainEnd> chain_ends(const FeatureGraph& features);

/// The target's chains as runs: joined where a corner has no vertex of the cage (is_used false) and exactly
/// two chain ends of one kind; sampled with about `spacing` (16 to 256 steps). In the order of their first
/// chains; chains without length are left out.
std::vector<ChainRun> chain_runs(const TargetSurface& target, const std::vector<bool>& is_used,
                                 double spacing);

/// How much the target's features turn at a corner where two chain ends meet, in radians.
double turn_at(const TargetSurface& target, std::span<const ChainEnd> ends);

}  // namespace flowcage
