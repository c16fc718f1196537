#pragma once
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// A C1 cubic through the points of a line, by chord length (Hermite, slopes from the parabola through three
/// neighbours; Bessel's). Precondition: at least two points.
class LineCurve {
 public:
  explicit LineCurve(std::vector<Vec3> points);
  /// Leaves the first point with the given slope (unit length: by arc length).
  LineCurve(std::vector<Vec3> points, const Vec3& slope) : LineCurve(std::move(points)) {
    slopes_.front() = slope;
  }
  double length() const { return lengths_.back(); }
  const std::vector<double>& lengths() const { return lengths_; }  ///< #points, from the first on
  /// The point at length s, 0 <= s <= length().
  Vec3 at(double s) const;

 private:
  Vec3 secant(std::size_t k) const;
  std::vector<Vec3> points_;
  std::vector<double> lengths_;
  std::vector<Vec3> slopes_;
};

}  // namespace flowcage
