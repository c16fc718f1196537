#pragma once
#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

enum class PatchType : std::uint8_t { wall, farfield, symmetry, inlet, outlet };

/// A named part of a volume mesh's boundary.
struct BoundaryPatch {
  std::string name;
  PatchType type = PatchType::wall;
  std::vector<std::array<Index, 4>>
      quads;                 ///< point numbers, counter-clockwise seen from outside of the fluid
  std::vector<Index> owner;  ///< the cell of each quad
};

/// Eight point numbers of a hex in VTK order: 0-3 the bottom counter-clockwise seen from the top, 4-7 above
/// them.
using HexPoints = std::array<Index, 8>;

/// The faces of a hex as corners in VTK order, each counter-clockwise seen from outside of the hex:
/// i-min, i-max, j-min, j-max, k-min, k-max, where i runs 0->1, j runs 0->3, k runs 0->4.
inline constexpr std::array<std::array<int, 4>, 6> hex_faces{
    {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}}};

/// What quality, export and conversion need of a hex mesh, whether it stores its cells (HexMesh) or knows
/// them in closed form (BlockMesh). Thread-safe.
class HexView {
 public:
  virtual ~HexView() = default;
  virtual Offset cell_count() const = 0;
  virtual std::span<const Vec3> points() const = 0;
  /// Cells [begin, begin + out.size()).
  virtual void read_cells(Offset begin, std::span<HexPoints> out) const = 0;
  virtual Index block_count() const = 0;
  virtual Index block_of(Offset cell) const = 0;
  /// Every quad of the boundary once, in patch order.
  virtual const std::vector<BoundaryPatch>& patches() const = 0;
};

/// A hex mesh with explicit cells: what the readers make, one block.
class HexMesh final : public HexView {
 public:
  HexMesh(std::vector<Vec3> points, std::vector<HexPoints> cells, std::vector<BoundaryPatch> patches)
      : points_(std::move(points)), cells_(std::move(cells)), patches_(std::move(patches)) {}
  Offset cell_count() const override { return static_cast<Offset>(cells_.size()); }
  std::span<const Vec3> points() const override { return points_; }
  void read_cells(Offset begin, std::span<HexPoints> out) const override {
    std::copy_n(cells_.begin() + begin, out.size(), out.begin());
  }
  Index block_count() const override { return 1; }
  Index block_of(Offset) const override { return 0; }
  const std::vector<BoundaryPatch>& patches() const override { return patches_; }

 private:
  std::vector<Vec3> points_;
  std::vector<HexPoints> cells_;
  std::vector<BoundaryPatch> patches_;
};

}  // namespace flowcage
