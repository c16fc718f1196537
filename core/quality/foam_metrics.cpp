#include "core/quality/foam_metrics.hpp"

#include <algorithm>
#include <cmath>

namespace flowcage {
namespace {

constexpr double root_very_small = 1e-150;  // OpenFOAM's guard against division by zero
constexpr double very_small = 1e-300;

// s = c - ((area . c) / (area . d)) d, normalised by the larger of `reach` and the face's extent along s.
double skewness(const std::array<Vec3, 4>& quad, const FaceGeometry& face, const Vec3& c, const Vec3& d,
                double reach) {
  const Vec3 s = c - (face.area.dot(c) / (face.area.dot(d) + root_very_small)) * d;
  const double length = s.norm();
  const Vec3 direction = s / (length + root_very_small);
  reach += root_very_small;
  for (const Vec3& p : quad) reach = std::max(reach, std::abs(direction.dot(p - face.centre)));
  return length / reach;
}

}  // namespace

FaceGeometry face_geometry(const std::array<Vec3, 4>& quad) {
  // Relative to the middle m, the triangle (a, b, m) has twice the area vector a x b and its centre at
  // (a + b) / 3.
  const Vec3 middle = (quad[0] + quad[1] + quad[2] + quad[3]) / 4;
  const Vec3 a = quad[0] - middle, b = quad[1] - middle, c = quad[2] - middle, d = quad[3] - middle;
  const Vec3 ab = a.cross(b), bc = b.cross(c), cd = c.cross(d), da = d.cross(a);
  const double area_ab = ab.norm(), area_bc = bc.norm(), area_cd = cd.norm(), area_da = da.norm();
  const double sum_area = (area_ab + area_bc) + (area_cd + area_da);
  const Vec3 sum_normal = (ab + bc) + (cd + da);
  const Vec3 sum_centre = area_ab * (a + b) + area_bc * (b + c) + area_cd * (c + d) + area_da * (d + a);
  if (sum_area < root_very_small) return {middle, Vec3::Zero()};
  return {middle + sum_centre / (3 * sum_area), sum_normal / 2};
}

CellGeometry cell_geometry(const HexCorners& hex) {
  std::array<FaceGeometry, 6> faces;
  Vec3 apex = Vec3::Zero();
  CellGeometry cell;
  for (int f = 0; f < 6; ++f) {
    const auto& c = hex_faces[f];
    faces[f] = face_geometry({hex[c[0]], hex[c[1]], hex[c[2]], hex[c[3]]});
    apex += faces[f].centre;
    cell.sum_area += faces[f].area;
    cell.sum_mag_area += faces[f].area.cwiseAbs();
  }
  apex /= 6;
  for (const FaceGeometry& face : faces) {
    const double three_volumes = face.area.dot(face.centre - apex);
    cell.centre += three_volumes * (0.75 * face.centre + 0.25 * apex);
    cell.volume += three_volumes;
  }
  cell.centre = std::abs(cell.volume) > very_small ? Vec3(cell.centre / cell.volume) : apex;
  cell.volume /= 3;
  return cell;
}

double cell_openness(const CellGeometry& cell) {
  double worst = 0;
  for (int d = 0; d < 3; ++d) {
    worst = std::max(worst, std::abs(cell.sum_area[d]) / (cell.sum_mag_area[d] + root_very_small));
  }
  return worst;
}

double cell_aspect_ratio(const CellGeometry& cell) {
  const double by_direction = cell.sum_mag_area.maxCoeff() / (cell.sum_mag_area.minCoeff() + root_very_small);
  const double volume = std::max(root_very_small, cell.volume);
  return std::max(by_direction, cell.sum_mag_area.sum() / 6 / std::pow(volume, 2.0 / 3.0));
}

double face_orthogonality(const Vec3& area, const Vec3& owner_centre, const Vec3& neighbour_centre) {
  const Vec3 d = neighbour_centre - owner_centre;
  return d.dot(area) / (d.norm() * area.norm() + root_very_small);
}

double face_skewness(const std::array<Vec3, 4>& quad, const FaceGeometry& face,
                     const std::array<Vec3, 2>& centres) {
  const Vec3 d = centres[1] - centres[0];
  return skewness(quad, face, face.centre - centres[0], d, 0.2 * d.norm());
}

double boundary_face_skewness(const std::array<Vec3, 4>& quad, const FaceGeometry& face,
                              const Vec3& owner_centre) {
  const Vec3 c = face.centre - owner_centre;
  const Vec3 normal = face.area / (face.area.norm() + root_very_small);
  const Vec3 d = normal * normal.dot(c);
  return skewness(quad, face, c, d, 0.4 * d.norm());
}

}  // namespace flowcage
