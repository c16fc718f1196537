// Cages as a user would draw them, for the tests of the loop.
#pragma once
#include <array>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <random>
#include <vector>

#include "core/mesh/cage.hpp"

namespace flowcage::test {

inline void add_face(Cage& cage, std::initializer_list<Index> vertices) {
  cage.faces.push_row(std::vector<Index>(vertices));
  cage.face_patch.push_back(0);
}

inline void add_crease(Cage& cage, Index a, Index b) {
  cage.creases.push_back({a, b, infinitely_sharp});
}

inline Cage empty_cage() {
  Cage cage;
  cage.patch_names = {""};
  return cage;
}

/// The box's 8 corners (number x + 2 y + 4 z) and 6 quads.
inline Cage box_cage(const Vec3& low, const Vec3& high, bool creases) {
  Cage cage = empty_cage();
  for (Index i = 0; i < 8; ++i) {
    cage.points.emplace_back((i & 1) != 0 ? high.x() : low.x(), (i & 2) != 0 ? high.y() : low.y(),
                             (i & 4) != 0 ? high.z() : low.z());
  }
  add_face(cage, {0, 4, 6, 2});
  add_face(cage, {1, 3, 7, 5});
  add_face(cage, {0, 1, 5, 4});
  add_face(cage, {2, 6, 7, 3});
  add_face(cage, {0, 2, 3, 1});
  add_face(cage, {4, 5, 7, 6});
  if (creases) {
    for (Index a = 0; a < 8; ++a) {
      for (const Index bit : {1, 2, 4}) {
        if ((a & bit) == 0) add_crease(cage, a, a | bit);
      }
    }
  }
  return cage;
}

/// n around the axis times m around the tube.
inline Cage torus_cage(double major, double minor, Index n, Index m) {
  Cage cage = empty_cage();
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      const double a = 2 * std::numbers::pi * i / n;
      const double b = 2 * std::numbers::pi * j / m;
      const double r = major + minor * std::cos(b);
      cage.points.emplace_back(r * std::cos(a), r * std::sin(a), minor * std::sin(b));
    }
  }
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < m; ++j) {
      const Index i1 = (i + 1) % n;
      const Index j1 = (j + 1) % m;
      add_face(cage, {i * m + j, i1 * m + j, i1 * m + j1, i * m + j1});
    }
  }
  return cage;
}

/// The half x >= 0 of the cube of half size `half`, open in the plane x = 0: 8 vertices, 5 quads.
inline Cage half_box_cage(double half) {
  Cage cage = box_cage(Vec3(0, -half, -half), Vec3::Constant(half), false);
  Cage open = empty_cage();
  open.points = cage.points;
  for (Index f = 1; f < cage.faces.size(); ++f) {  // face 0 lies in the plane
    open.faces.push_row(cage.faces[f]);
    open.face_patch.push_back(0);
  }
  return open;
}

/// The half y >= 0 of torus_cage (n even).
inline Cage half_torus_cage(double major, double minor, Index n, Index m) {
  const Cage whole = torus_cage(major, minor, n, m);
  Cage cage = empty_cage();
  cage.points.assign(whole.points.begin(), whole.points.begin() + (n / 2 + 1) * m);
  for (Index j = 0; j < m; ++j) {
    for (const Index i : {Index{0}, n / 2}) cage.points[i * m + j].y() = 0;
  }
  for (Index f = 0; f < n / 2 * m; ++f) {
    cage.faces.push_row(whole.faces[f]);
    cage.face_patch.push_back(0);
  }
  return cage;
}

/// A cylinder about z from 0 to height: rims of 8 crease vertices, caps with an O-grid (a 2 x 2 core and a
/// ring).
inline Cage cylinder_cage(double radius, double height) {
  Cage cage = empty_cage();
  for (int end = 0; end < 2; ++end) {
    const double z = end * height;
    for (Index i = 0; i < 8; ++i) {
      const double a = 2 * std::numbers::pi * i / 8;
      cage.points.emplace_back(radius * std::cos(a), radius * std::sin(a), z);
    }
    for (Index i = 0; i < 8; ++i) {
      const double a = 2 * std::numbers::pi * i / 8;
      cage.points.emplace_back(0.5 * radius * std::cos(a), 0.5 * radius * std::sin(a), z);
    }
    cage.points.emplace_back(0, 0, z);
  }
  const auto rim = [](Index end, Index i) { return 17 * end + i % 8; };
  const auto ring = [](Index end, Index i) { return 17 * end + 8 + i % 8; };
  for (Index i = 0; i < 8; ++i) {
    add_face(cage, {rim(0, i), rim(0, i + 1), rim(1, i + 1), rim(1, i)});
    add_face(cage, {rim(1, i), rim(1, i + 1), ring(1, i + 1), ring(1, i)});
    add_face(cage, {rim(0, i + 1), rim(0, i), ring(0, i), ring(0, i + 1)});
    add_crease(cage, rim(0, i), rim(0, i + 1));
    add_crease(cage, rim(1, i), rim(1, i + 1));
  }
  for (Index i = 1; i < 8; i += 2) {
    add_face(cage, {33, ring(1, i), ring(1, i + 1), ring(1, i + 2)});
    add_face(cage, {16, ring(0, i + 2), ring(0, i + 1), ring(0, i)});
  }
  return cage;
}

/// A cone about z with its base in z = 0: eight vertices on the rim, which is a crease, and on a ring above
/// it and one inside of it; the apex, of four quads, is a corner.
inline Cage cone_cage(double radius, double height) {
  Cage cage = empty_cage();
  constexpr Index n = 8;
  const auto add_ring = [&](double r, double z) {
    for (Index i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n;
      cage.points.emplace_back(r * std::cos(a), r * std::sin(a), z);
    }
  };
  add_ring(radius, 0);
  add_ring(0.5 * radius, 0.5 * height);
  add_ring(0.5 * radius, 0);
  const Index apex = 3 * n, centre = apex + 1;
  cage.points.emplace_back(0, 0, height);
  cage.points.emplace_back(0, 0, 0);
  for (Index i = 0; i < n; ++i) {
    const Index j = (i + 1) % n;
    add_face(cage, {i, j, n + j, n + i});
    add_face(cage, {j, i, 2 * n + i, 2 * n + j});
    add_crease(cage, i, j);
    if (i % 2 == 1) continue;
    const Index k = (i + 2) % n;
    add_face(cage, {apex, n + i, n + j, n + k});
    add_face(cage, {centre, 2 * n + k, 2 * n + j, 2 * n + i});
  }
  cage.corners.push_back({apex, infinitely_sharp});
  return cage;
}

/// The box [0, 2] x [-1, 1] x [0, 1] with a crease on its top from (0, 0, 1) that ends in a dart at x = dart.
inline Cage ridge_cage(double dart) {
  Cage cage = empty_cage();
  const std::array<double, 4> x{0, dart, 1, 2};
  const auto vertex = [](Index i, Index j, Index k) { return i + 4 * (j + 3 * k); };
  for (const Index k : {0, 1}) {
    for (const Index j : {0, 1, 2}) {
      for (const double at : x) cage.points.emplace_back(at, j - 1, k);
    }
  }
  for (Index i = 0; i < 3; ++i) {
    for (Index j = 0; j < 2; ++j) {
      add_face(cage, {vertex(i, j, 0), vertex(i, j + 1, 0), vertex(i + 1, j + 1, 0), vertex(i + 1, j, 0)});
      add_face(cage, {vertex(i, j, 1), vertex(i + 1, j, 1), vertex(i + 1, j + 1, 1), vertex(i, j + 1, 1)});
    }
    add_face(cage, {vertex(i, 0, 0), vertex(i + 1, 0, 0), vertex(i + 1, 0, 1), vertex(i, 0, 1)});
    add_face(cage, {vertex(i, 2, 0), vertex(i, 2, 1), vertex(i + 1, 2, 1), vertex(i + 1, 2, 0)});
    for (const Index j : {0, 2}) {
      for (const Index k : {0, 1}) add_crease(cage, vertex(i, j, k), vertex(i + 1, j, k));
    }
  }
  for (Index j = 0; j < 2; ++j) {
    add_face(cage, {vertex(0, j, 0), vertex(0, j, 1), vertex(0, j + 1, 1), vertex(0, j + 1, 0)});
    add_face(cage, {vertex(3, j, 0), vertex(3, j + 1, 0), vertex(3, j + 1, 1), vertex(3, j, 1)});
    for (const Index i : {0, 3}) {
      for (const Index k : {0, 1}) add_crease(cage, vertex(i, j, k), vertex(i, j + 1, k));
    }
  }
  for (const Index i : {0, 3}) {
    for (const Index j : {0, 2}) add_crease(cage, vertex(i, j, 0), vertex(i, j, 1));
  }
  add_crease(cage, vertex(0, 1, 1), vertex(1, 1, 1));
  return cage;
}

/// A half wing with chord along x, span along y from the open root at y = 0, thickness along z (occ_bridge's
/// HalfWing): sections of 6 points (7 with a blunt trailing edge) at each station and a flat tip cap of
/// strips along the chord line with a kite at the trailing edge and two triangles at the leading edge.
struct WingCageShape {
  double root_chord = 1, tip_chord = 0.6, semi_span = 2, sweep_degrees = 25;
  double half_base = 0;                           ///< of the chord; 0: sharp trailing edge
  std::vector<double> stations{0, 0.35, 0.7, 1};  ///< of the span
  double thickness = 0.12;
  bool rounded_tip = false;  ///< a cap that bulges outboard and goes on smoothly, but for a blunt base's end
};

inline double naca_half_thickness(double x, double thickness, double half_base) {
  const double sharp =
      5 * thickness *
      (0.2969 * std::sqrt(x) - 0.1260 * x - 0.3516 * x * x + 0.2843 * x * x * x - 0.1036 * x * x * x * x);
  return sharp + half_base * x;
}

inline Cage wing_cage(const WingCageShape& wing) {
  Cage cage = empty_cage();
  const bool blunt = wing.half_base > 0;
  // Round the section from the upper trailing edge over the leading edge to the lower side.
  struct Station {
    double x, side;
  };
  std::vector<Station> section{{1, 1}, {0.65, 1}, {0.2, 1}, {0, 0}, {0.2, -1}, {0.65, -1}};
  if (blunt) section.push_back({1, -1});
  const Index n = static_cast<Index>(section.size());
  const auto at = [&](double span, double x, double z) {
    const double chord = wing.root_chord + span * (wing.tip_chord - wing.root_chord);
    const double y = span * wing.semi_span;
    return Vec3(y * std::tan(wing.sweep_degrees * std::numbers::pi / 180) + chord * x, y, chord * z);
  };
  for (const double span : wing.stations) {
    for (const Station& s : section) {
      cage.points.push_back(at(span, s.x, s.side * naca_half_thickness(s.x, wing.thickness, wing.half_base)));
    }
  }
  const Index rings = static_cast<Index>(wing.stations.size());
  for (Index r = 0; r + 1 < rings; ++r) {
    for (Index i = 0; i < n; ++i) {
      const Index j = (i + 1) % n;
      add_face(cage, {n * r + i, n * (r + 1) + i, n * (r + 1) + j, n * r + j});
    }
    add_crease(cage, n * r, n * (r + 1));
    if (blunt) add_crease(cage, n * r + n - 1, n * (r + 1) + n - 1);
  }
  const Index tip = n * (rings - 1);
  for (Index i = 0; i < n; ++i) {
    if (!wing.rounded_tip || (blunt && i == n - 1)) add_crease(cage, tip + i, tip + (i + 1) % n);
  }
  if (wing.rounded_tip && !blunt) cage.corners.push_back({tip, infinitely_sharp});
  const Index front = static_cast<Index>(cage.points.size());
  const Index back = front + 1;
  for (const double along : {0.2, 0.6}) {
    cage.points.push_back(at(1, along, 0));
    if (wing.rounded_tip) {
      cage.points.back().y() += wing.tip_chord * naca_half_thickness(along, wing.thickness, wing.half_base);
    }
  }
  if (blunt) {
    add_face(cage, {tip + 6, tip + 5, back, tip + 1, tip});
  } else {
    add_face(cage, {tip + 5, back, tip + 1, tip});
  }
  add_face(cage, {back, front, tip + 2, tip + 1});
  add_face(cage, {front, back, tip + 5, tip + 4});
  add_face(cage, {front, tip + 3, tip + 2});
  add_face(cage, {front, tip + 4, tip + 3});
  return cage;
}

/// Half of a fuselage (an ellipsoid about x, cut by y = 0) with a wing at half height (occ_bridge's HalfWing,
/// its root's leading edge at wing_x): open in the plane y = 0, a crease where the wing leaves the fuselage.
struct WingedFuselageShape {
  double half_length = 2, radius = 0.4;
  double wing_x = -0.7, root_chord = 1, tip_chord = 0.6, semi_span = 1.8, sweep_degrees = 25;
  double thickness = 0.12;
};

inline Cage winged_fuselage_cage(const WingedFuselageShape& body) {
  Cage cage = empty_cage();
  const auto radius_at = [&](double x) {
    return body.radius * std::sqrt(std::max(0.0, 1 - x * x / (body.half_length * body.half_length)));
  };
  const double sweep = std::tan(body.sweep_degrees * std::numbers::pi / 180);
  const auto wing_point = [&](double y, double along, double side) {
    const double part = y / body.semi_span;
    const double chord = body.root_chord + part * (body.tip_chord - body.root_chord);
    return Vec3(body.wing_x + y * sweep + along * chord, y,
                side * chord * naca_half_thickness(along, body.thickness, 0));
  };
  // Where a line of the wing meets the fuselage.
  const auto root_point = [&](double along, double side) {
    double y = body.radius;
    for (int i = 0; i < 20; ++i) {
      const Vec3 p = wing_point(y, along, side);
      y = std::sqrt(std::max(1e-6, std::pow(radius_at(p.x()), 2) - p.z() * p.z()));
    }
    return wing_point(y, along, side);
  };
  struct Station {
    double along, side;
  };
  const std::vector<Station> section{{1, 1}, {0.65, 1}, {0.2, 1}, {0, 0}, {0.2, -1}, {0.65, -1}};
  for (const Station& s : section) cage.points.push_back(root_point(s.along, s.side));
  for (const Station& s : section) cage.points.push_back(wing_point(body.semi_span, s.along, s.side));
  const Index front = 12, back = 13;
  cage.points.push_back(wing_point(body.semi_span, 0.2, 0));
  cage.points.push_back(wing_point(body.semi_span, 0.6, 0));
  for (Index i = 0; i < 6; ++i) {
    const Index j = (i + 1) % 6;
    add_face(cage, {i, 6 + i, 6 + j, j});
    add_crease(cage, i, j);
    add_crease(cage, 6 + i, 6 + j);
  }
  add_crease(cage, 0, 6);
  add_face(cage, {11, back, 7, 6});
  add_face(cage, {back, front, 8, 7});
  add_face(cage, {front, back, 11, 10});
  add_face(cage, {front, 9, 8});
  add_face(cage, {front, 10, 9});

  // Rings round the fuselage from the tail to the nose: top, upper, (wing or side), lower, bottom.
  struct Ring {
    double x;
    Index upper, lower;  // points at the side: the same, or the wing's two
  };
  const double tail = 0.72 * body.half_length;
  const auto side_point = [&](double x) {
    cage.points.emplace_back(x, radius_at(x), 0);
    return static_cast<Index>(cage.points.size()) - 1;
  };
  const Index tail_side = side_point(tail), nose_side = side_point(-tail);
  const std::vector<Ring> rings{{tail, tail_side, tail_side}, {cage.points[0].x(), 0, 0},
                                {cage.points[1].x(), 1, 5},   {cage.points[2].x(), 2, 4},
                                {cage.points[3].x(), 3, 3},   {-tail, nose_side, nose_side}};
  std::vector<std::array<Index, 6>> rows;
  for (const Ring& ring : rings) {
    const double r = radius_at(ring.x);
    const Index first = static_cast<Index>(cage.points.size());
    for (const double angle : {90.0, 45.0, -45.0, -90.0}) {
      const double a = angle * std::numbers::pi / 180;
      cage.points.emplace_back(ring.x, angle == 90 || angle == -90 ? 0 : r * std::cos(a), r * std::sin(a));
    }
    rows.push_back({first, first + 1, ring.upper, ring.lower, first + 2, first + 3});
  }
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    for (const std::size_t k : {0U, 1U, 3U, 4U}) {
      add_face(cage, {rows[i][k], rows[i][k + 1], rows[i + 1][k + 1], rows[i + 1][k]});
    }
  }
  for (const bool at_tail : {true, false}) {
    const auto& row = at_tail ? rows.front() : rows.back();
    const Index pole = static_cast<Index>(cage.points.size());
    cage.points.emplace_back(at_tail ? body.half_length : -body.half_length, 0, 0);
    if (at_tail) {
      add_face(cage, {pole, row[2], row[1], row[0]});
      add_face(cage, {pole, row[5], row[4], row[2]});
    } else {
      add_face(cage, {pole, row[0], row[1], row[2]});
      add_face(cage, {pole, row[2], row[4], row[5]});
    }
  }
  return cage;
}

/// Moves every vertex by up to `amount` in each direction; the same for the same seed.
inline Cage with_noise(Cage cage, double amount, unsigned seed) {
  std::mt19937 random(seed);
  for (Vec3& p : cage.points) {
    for (int k = 0; k < 3; ++k) {
      p[k] += amount * (2.0 * static_cast<double>(random()) / std::mt19937::max() - 1);
    }
  }
  return cage;
}

}  // namespace flowcage::test
