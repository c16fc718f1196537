#pragma once
#include <memory>
#include <vector>

#include "core/mesh/hex_complex.hpp"

namespace flowcage {

/// A HexComplex whose block b is divided into dims(b) cells; chords carry the divisions, so blocks fit by
/// construction.
///
/// Points are stored once, each owned by the coarse corner, edge, quad or hex it lies in, in that order:
/// first the corners, then per edge its interior points from edges[e][0] on, then per quad (rows along its
/// first side), then per hex (i fastest). point_number gives the number of a block's (i,j,k) in closed form:
/// no connectivity is stored. Cells are numbered block by block, i fastest.
class BlockMesh final : public HexView {
 public:
  /// Precondition: chord_divisions[c] >= 1 for each chord; points in the order above.
  BlockMesh(std::shared_ptr<const HexComplex> complex, std::vector<Index> chord_divisions,
            std::vector<Vec3> points);

  const HexComplex& complex() const { return *complex_; }
  const std::vector<Index>& chord_divisions() const { return chord_divisions_; }
  std::array<Index, 3> dims(Index block) const;
  Index point_number(Index block, Index i, Index j, Index k) const;
  std::vector<Vec3>& mutable_points() { return points_; }

  Offset cell_count() const override;
  std::span<const Vec3> points() const override { return points_; }
  void read_cells(Offset begin, std::span<HexPoints> out) const override;
  Index block_count() const override { return static_cast<Index>(complex_->hexes.size()); }
  Index block_of(Offset cell) const override;
  const std::vector<BoundaryPatch>& patches() const override;

 private:
  std::shared_ptr<const HexComplex> complex_;
  std::vector<Index> chord_divisions_;
  std::vector<Vec3> points_;
  std::vector<Index> edge_offset_, quad_offset_, hex_offset_;
  std::vector<Offset> cell_offset_;
  mutable std::vector<BoundaryPatch> patches_;
};

}  // namespace flowcage
