#pragma once
#include <span>
#include <vector>

#include "core/grade/line_cells.hpp"
#include "core/volume/wall_columns.hpp"

namespace flowcage {

/// The line whose lengths are the lines' geometric means, its new cells, and how they are carried to a line.
class MeanLine {
 public:
  /// Cells are the same on all lines as long as they are thinner than this part of the mesh's own first cell.
  /// Where neighbouring lines differ in growth, a cell's centre moves along the wall from layer to layer; in
  /// cells of aspect ratio a that tilts the line between centres by about a / 12 times the difference.
  static constexpr double thin = 1.0 / 30;
  /// From so many of the mesh's own layers on, each line keeps its own.
  static constexpr Index blended = 3;

  MeanLine(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns,
           const LayerSettings& settings);

  Index cells() const { return static_cast<Index>(sigma_.size()) - 1; }

  /// Lengths of a line's new points, the exact ones times `lean`; `own`: of its old ones, from 0.
  std::vector<double> carried(std::span<const double> own, double lean) const;

 private:
  std::vector<double> lengths_, sigma_;
  Index exact_ = 0, end_ = 0;  ///< cells that are the same on all lines; where they follow their own
};

}  // namespace flowcage
