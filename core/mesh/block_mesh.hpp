#pragma once
#include <memory>
#include <vector>

#include "core/mesh/hex_complex.hpp"

namespace flowcage {

/// The lattice of a coarse quad as one of its blocks sees it: the quad's (u,v), u along its first side and v
/// along its last, is (i,j,k) = origin + u du + v dv of the block.
struct QuadLattice {
  Index block = no_index;
  std::array<Index, 3> origin{}, du{}, dv{};
  Index nu = 1, nv = 1;  ///< divisions
};

/// The points of a block's lattice along one of its axes: the two ends, and between them numbers of one
/// stride, because they are owned by one edge, quad or hex.
struct PointRow {
  Index cells = 1;  ///< point t is at 0 <= t <= cells
  Index first = no_index, last = no_index;
  Index base = 0, stride = 0;  ///< 0 < t < cells: base + stride t

  Index operator[](Index t) const { return t == 0 ? first : t == cells ? last : base + stride * t; }
  /// The same points from the other end on.
  PointRow reversed() const { return {cells, last, first, base + stride * cells, -stride}; }
};

/// A HexComplex whose block b is divided into dims(b) cells; chords carry the divisions, so blocks fit by
/// construction.
///
/// Points are stored once, each owned by the coarse corner, edge, quad or hex they lie in, in that order:
/// first the corners, then per edge its interior points from edges[e][0] on, then per quad (rows along its
/// first side), then per hex (i fastest). point_number gives the number of a block's (i,j,k) in closed form:
/// no connectivity is stored. Cells are numbered block by block, i fastest; (i,j,k) run along the block's
/// corners 0->1, 0->3, 0->4.
class BlockMesh final : public HexView {
 public:
  /// Precondition: chord_divisions[c] >= 1 for each chord; point_count points in the order above.
  BlockMesh(std::shared_ptr<const HexComplex> complex, std::vector<Index> chord_divisions,
            std::vector<Vec3> points);
  /// One cell a block: the points are the complex's corners.
  explicit BlockMesh(std::shared_ptr<const HexComplex> complex);

  /// How many points a mesh of these divisions has. Throws Error(input) when they are more than Index holds.
  static Index point_count(const HexComplex& complex, const std::vector<Index>& chord_divisions);

  const HexComplex& complex() const { return *complex_; }
  std::shared_ptr<const HexComplex> shared_complex() const { return complex_; }
  const std::vector<Index>& chord_divisions() const { return chord_divisions_; }
  std::array<Index, 3> dims(Index block) const;
  Index point_number(Index block, Index i, Index j, Index k) const;
  /// The row of points along `axis` through lattice place `at` of a block; at[axis] is not read.
  PointRow point_row(Index block, int axis, std::array<Index, 3> at) const;
  QuadLattice quad_lattice(Index quad) const;
  Index point_number(const QuadLattice& at, Index u, Index v) const {
    return point_number(at.block, at.origin[0] + u * at.du[0] + v * at.dv[0],
                        at.origin[1] + u * at.du[1] + v * at.dv[1],
                        at.origin[2] + u * at.du[2] + v * at.dv[2]);
  }
  std::vector<Vec3>& mutable_points() { return points_; }

  /// First point owned by an edge (1 <= t < divisions: edge_points(e) + t - 1), quad or hex.
  Index edge_points(Index edge) const { return edge_offset_[edge]; }
  Index quad_points(Index quad) const { return quad_offset_[quad]; }
  Index hex_points(Index hex) const { return hex_offset_[hex]; }

  Offset cell_count() const override { return cell_offset_.back(); }
  std::span<const Vec3> points() const override { return points_; }
  void read_cells(Offset begin, std::span<HexPoints> out) const override;
  Index block_count() const override { return static_cast<Index>(complex_->hexes.size()); }
  Index block_of(Offset cell) const override;
  const std::vector<BoundaryPatch>& patches() const override { return patches_; }
  void set_patch_type(std::size_t patch, PatchType type) { patches_[patch].type = type; }
  /// First cell of a block.
  Offset block_begin(Index block) const { return cell_offset_[block]; }

 private:
  /// How a block sees the points that its edges and faces own: number = base + sum stride * position.
  struct Frame {
    std::array<Index, 3> dims;
    std::array<std::array<Index, 2>, 12> edges;  ///< base, stride
    std::array<std::array<Index, 3>, 6> faces;   ///< base, strides along the lower and the higher axis
    Index interior;                              ///< base; strides follow from dims
  };
  Frame make_frame(Index block) const;
  void build_patches();

  std::shared_ptr<const HexComplex> complex_;
  std::vector<Index> chord_divisions_;
  std::vector<Vec3> points_;
  std::vector<Index> edge_offset_, quad_offset_, hex_offset_;
  std::vector<Offset> cell_offset_;
  std::vector<Frame> frames_;
  std::vector<BoundaryPatch> patches_;
};

}  // namespace flowcage
