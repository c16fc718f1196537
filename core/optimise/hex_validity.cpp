#include "core/optimise/hex_validity.hpp"

#include "core/base/parallel.hpp"
#include "core/mesh/visit_cells.hpp"
#include "core/optimise/jacobian_bound.hpp"

namespace flowcage {

CellProof prove_cells(const HexView& mesh) {
  const auto body = [&](Offset begin, Offset end) {
    CellProof part;
    visit_cells(mesh, begin, end, [&](Offset, const HexPoints& cell) {
      const HexCornerPoints p = corner_points(mesh.points(), cell);
      if (positive_near_affine(p)) return;
      if (!(min_scaled_jacobian(p) > 0)) {
        ++part.inverted;
      } else if (jacobian_sign(p) != JacobianSign::positive) {
        ++part.uncertified;
      }
    });
    return part;
  };
  return parallel_reduce(mesh.cell_count(), cell_grain, CellProof{}, body,
                         [](CellProof a, const CellProof& b) {
                           return CellProof{a.inverted + b.inverted, a.uncertified + b.uncertified};
                         });
}

HexValidity measure_validity(std::span<const HexPoints> cells, std::span<const Vec3> points) {
  struct Sums {
    Offset inverted = 0, uncertified = 0;
    double least = std::numeric_limits<double>::infinity();
    double sum = 0;
  };
  const auto count = static_cast<Offset>(cells.size());
  if (count == 0) return {};
  const auto body = [&](Offset begin, Offset end) {
    Sums part;
    for (Offset n = begin; n < end; ++n) {
      const HexCornerPoints p = corner_points(points, cells[n]);
      const double value = min_scaled_jacobian(p);
      if (!(value > 0)) {
        ++part.inverted;
      } else if (jacobian_sign(p) != JacobianSign::positive) {
        ++part.uncertified;
      }
      // A cell without a value (coordinates not finite) counts as the worst there is.
      part.least = std::min(part.least, std::isnan(value) ? -1 : value);
      part.sum += std::isnan(value) ? -1 : value;
    }
    return part;
  };
  const Sums all = parallel_reduce(count, 1024, Sums{}, body, [](const Sums& a, const Sums& b) {
    return Sums{a.inverted + b.inverted, a.uncertified + b.uncertified, std::min(a.least, b.least),
                a.sum + b.sum};
  });
  return {all.inverted, all.uncertified, all.least, all.sum / static_cast<double>(count)};
}

}  // namespace flowcage
