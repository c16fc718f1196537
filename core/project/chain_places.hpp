#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/project/feature_match.hpp"

namespace flowcage {

/// A crease chain as it is drawn.
struct DrawnChain {
  std::vector<Vec3> controls;   ///< its vertices in order; loops repeat their first
  std::vector<double> lengths;  ///< #controls - 1, edge lengths
  bool closed = false;
};
DrawnChain drawn_chain(const CreaseChain& chain, std::span<const Vec3> points);

/// The same way run from its end.
FeaturePath reversed(const FeaturePath& path);

/// Lays a matched chain's vertices on its path (match.path, with match.s the places that Viterbi's algorithm
/// gave): those nearest to corners within the path and to bends sharper than 60 degrees in a quarter of an
/// edge (the nose of a section) are pinned to them (both vertices of an edge far shorter than its neighbours,
/// the rim that ends a thin strip, to a quarter and three quarters of the turn: they are `kept`), the others
/// move to where distance and stretch against the cage are least squares. Fills s, w, slope, the tables and
/// `pinned` and sets `turns`. Returns warnings about corners.
std::vector<std::string> place_vertices(const TargetSurface& target, const DrawnChain& drawn,
                                        const FeatureMatchSettings& settings, ChainMatch& match);

/// Other places that the drawing may mean when it is rougher than the body is thin: each pinned place given
/// to the vertex before or after the one that has it; a loop run through the other way.
std::vector<ChainMatch> other_places(const TargetSurface& target, const DrawnChain& drawn,
                                     const FeatureMatchSettings& settings, const ChainMatch& match);

}  // namespace flowcage
