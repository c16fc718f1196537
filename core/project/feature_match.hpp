#pragma once
#include <span>
#include <string>
#include <vector>

#include "core/project/crease_chains.hpp"
#include "core/target/target_surface.hpp"

namespace flowcage {

/// A part of one target chain, run from s_begin to s_end (against the chain when s_end < s_begin). On a
/// closed chain s may go beyond its length: it wraps.
struct FeaturePiece {
  Index chain = no_index;
  double s_begin = 0, s_end = 0;
};

/// A run along the target's feature chains, end to end.
struct FeaturePath {
  std::vector<FeaturePiece> pieces;
  std::vector<double> offsets{0};  ///< #pieces + 1: path length at the start of each piece, then the total
  bool closed = false;
  double length() const { return offsets.back(); }
};

/// The exact point at path length s (clamped; wrapped on closed paths); tangent and s of the result are the
/// path's.
CurvePoint point_on_path(const TargetSurface& target, const FeaturePath& path, double s);
/// The target's chain at path length s.
Index chain_on_path(const FeaturePath& path, double s);

/// Which run of the target's features a crease chain of the cage follows, and where each cage vertex lies on
/// it.
struct ChainMatch {
  bool matched = false;
  FeaturePath path;
  std::vector<double> s;  ///< #segments + 1, ascending path lengths of the chain's vertices; on a loop the
                          ///< last is the first plus the path's length
  double cost = 0;        ///< root mean square distance in mean edge lengths of the chain
  bool turns = false;     ///< the path turns corners of the target: vertices there are pinned to them
  std::vector<double> pinned;  ///< places, ascending, of inner vertices that belong to corners or sharp bends
  std::vector<double> kept;    ///< pairs of `pinned` at the ends of a short edge: split_at_bends.hpp
  /// Between the vertices places follow w, the path length weighted with w'(s) = 1 + (curvature x mean edge
  /// length)^(3/4): a cubic spline of spacing h misses a curve by about h^4 times its fourth derivative,
  /// which grows as the third power of the curvature, so even steps of w share the error evenly (de Boor
  /// 1974). A leading edge gets points this way.
  std::vector<double> w;                                ///< #segments + 1
  std::vector<double> slope;                            ///< #segments + 1: dw/dt, t the vertex number
  std::vector<double> table_s, table_w, table_density;  ///< w(s) and w'(s), ascending, from s.front() on
};

/// Path length at t in [0, #segments] (t the position along the chain in cage edges): w is a monotone cubic
/// of t, C2 where monotony allows, so that the fitted curve keeps its order.
double parameter_at(const ChainMatch& match, double t);

struct FeatureMatchSettings {
  double cost_limit = 0.5;         ///< largest root mean square distance of a match, in mean edge lengths
  double kink_angle_degrees = 15;  ///< turns on a path that cage vertices are pinned to
};

struct FeatureMatch {
  std::vector<ChainMatch> chains;  ///< one per crease chain
  std::vector<bool> end_is_fixed;  ///< #V: a chain end (corner, dart) whose place on the features is known,
                                   ///< or a corner at a tip
  std::vector<Vec3> end_position;  ///< #V: that place
  std::vector<Index> end_corner;   ///< #V: the target's corner there, or no_index
  std::vector<Index> unmatched_chains;  ///< target chains followed over less than half of their length
  std::vector<std::string> warnings;    ///< for the user: demoted creases, pinned corners; with places
};

/// Matches crease chains of the cage to runs along the target's feature chains (sharp ones for creases, open
/// boundaries for open edges; the other kind only if nothing of its own kind lies there), exclusively and
/// with a cost limit: never simply the nearest edge. A run may be a part of a chain or go over several.
///
/// Map matching by a hidden Markov model (Newson & Krumm 2009): the states of a cage vertex are places on
/// the sampled feature graph, emissions are distances, transitions compare the length along the features with
/// the cage's; Viterbi's algorithm finds the best run, which may not turn back. Corners are assigned one to
/// one first, so that chains that meet in the cage meet on the target.
/// points: #V control points of the cage's level.
FeatureMatch match_features(const SurfaceLevel& level, std::span<const Vec3> points,
                            std::span<const CreaseChain> chains, const TargetSurface& target,
                            const FeatureMatchSettings& settings = {});

}  // namespace flowcage
