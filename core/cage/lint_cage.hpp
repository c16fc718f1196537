#pragma once
#include <span>

#include "core/cage/lint_report.hpp"
#include "core/mesh/cage.hpp"

namespace flowcage {

/// Bounds beyond which a cage's shape is measured to cost accuracy or quality (docs/cages.md has the
/// figures).
struct CageLintSettings {
  double length_ratio = 10;      ///< of neighbouring edges along a line of the cage
  double close_vertices = 1e-3;  ///< nearest vertices without a common edge, in their mean edge lengths
  double flat_face = 1e-4;       ///< four areas of a face over its squared perimeter; a square has 1/4
  Index face_corners = 6;        ///< of a face
  Index valence = 6;             ///< edges at a vertex
};

/// What in the cage alone will make a poor surface, as warnings:
///   edge_lengths      edges that follow each other along a line differ in length by more than length_ratio
///   close_vertices    vertices almost in one place that no edge joins: a seam that was not merged
///   flat_face         a face with (almost) no area
///   folded_face       a face that is not convex or folds: a corner turns against the face's normal
///   face_corners      a face with many corners
///   valence           a vertex with many edges
/// Precondition: a manifold (manifold_check.hpp).
LintReport lint_cage_shape(const Cage& cage, const CageLintSettings& settings = {});

struct SplitSectors {
  Cage cage;
  LintReport findings;  ///< rule "crease_sector", at most one; empty where every sector has two faces
};

/// A smooth crease vertex with a single face on one side makes cells that degenerate level by level: the
/// corner of that face opens to 180 degrees. With `mend` each such face gets a ring of quads inside (its
/// corners joined to points half-way to its centre), which gives every corner a second face and leaves its
/// neighbours as they are; otherwise the places are only reported. corners_of_cad: vertices that the fit
/// makes corners (split_at_bends.hpp). Precondition: a manifold.
SplitSectors split_crease_sectors(const Cage& cage, bool mend, std::span<const Index> corners_of_cad = {});

}  // namespace flowcage
