#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// A CAD shape built in code, for examples and tests: an opaque handle, lengths in metres. Faces point
/// outward.
class Shape {
 public:
  struct Rep;  // holds the kernel's shape; defined in occ_bridge/internal/shape_rep.hpp
  explicit Shape(std::shared_ptr<const Rep> rep) : rep_(std::move(rep)) {}
  const Rep& rep() const { return *rep_; }

 private:
  std::shared_ptr<const Rep> rep_;
};

/// Centred at the origin; torus and cylinder about the z axis, the cylinder from z = 0 to height.
Shape make_sphere(double radius);
Shape make_torus(double major_radius, double minor_radius);
Shape make_cylinder(double radius, double height);
/// About the z axis, its base in z = 0, its apex at z = height.
Shape make_cone(double radius, double height);
Shape make_box(const Vec3& size);
/// All twelve edges filleted. Precondition: 2 radius < the smallest size.
Shape make_rounded_box(const Vec3& size, double radius);
/// Both solids as they are, not united (parts that pass through each other), or as one body without inner
/// faces.
Shape make_compound(const Shape& a, const Shape& b);
Shape make_union(const Shape& a, const Shape& b);
Shape make_difference(const Shape& a, const Shape& b);
Shape translated(const Shape& shape, const Vec3& by);
/// Turned about an axis through the origin, right-handed.
Shape rotated(const Shape& shape, const Vec3& axis, double degrees);
/// A pipe's bend: the part of a torus about the z axis from angle 0 (in the x direction) to `degrees`.
Shape make_bend(double bend_radius, double pipe_radius, double degrees);
/// Body of revolution about the x axis.
Shape make_ellipsoid(double half_length, double radius);
/// The box [0, 2] x [-1, 1] x [0, 1] whose top sinks beside a ridge along y = 0 that fades out: the top is at
/// z = 1 - (1 - x)^3 |y| (1 - |y|) / 2 for x < 1 and flat beyond. The sides of the ridge differ by
/// 2 atan((1 - x)^3 / 2): 53 degrees at x = 0, 20 at x = .293, none from x = 1 on.
Shape make_fading_ridge();
/// The half of a solid where the coordinate `axis` (0 x, 1 y, 2 z) is positive, open in the plane where it is
/// 0. Throws Error(internal) when that plane does not cut the solid.
Shape make_half(const Shape& solid, int axis);

/// Half of a symmetric airfoil: x/c from 0 (leading edge) to 1, and the thickness above the chord line, y/c.
struct AirfoilHalf {
  std::vector<double> x, y;
};
/// NACA 4-digit symmetric section of thickness t (0.12 for NACA 0012), trailing edge closed by the
/// coefficient -0.1036 (Abbott & von Doenhoff), opened again to a half thickness `half_base` of the chord (0:
/// sharp).
AirfoilHalf naca_symmetric(double thickness, double half_base);
/// ONERA D section of the M6 wing as published in AGARD AR-138 (1979), table B1-1; its base of 0.14 % chord
/// is closed by extending the last straight part to the chord line and scaling back to unit chord, as is
/// usual for this test case.
AirfoilHalf onera_d();

enum class WingTip { flat, rounded };

/// A half wing: chord along x, span along y from the root at y = 0, thickness along z. Ruled between similar
/// sections.
struct HalfWing {
  AirfoilHalf airfoil;
  double root_chord = 1, tip_chord = 0.6, semi_span = 2;
  double leading_edge_sweep_degrees = 25;
  WingTip tip = WingTip::flat;  ///< rounded: half body of revolution of the tip section about its chord line
  bool closed_root = false;     ///< false: open in the plane y = 0 (half model)
};
/// Faces: upper, lower, (base when the section is blunt), tip (and its half disc when blunt and rounded),
/// (root).
Shape make_half_wing(const HalfWing& wing);
/// The ONERA M6 half wing (AGARD AR-138): semi-span 1.1963 m, root chord 0.8059 m, taper 0.562, leading-edge
/// sweep 30 degrees, rounded tip, sharp trailing edge, root open.
Shape make_onera_m6();

/// Writes by the file's extension: .step/.stp, .igs/.iges, .brep. `unit`: m, mm, in or ft (BREP has none:
/// metres). Throws Error(output) when the file cannot be written, Error(usage) for another extension or unit.
void write_cad(const Shape& shape, const std::string& file, const std::string& unit = "mm");

}  // namespace flowcage
