// Cages as a user would draw them, for the tests of the loop.
#pragma once
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

/// A half wing with chord along x, span along y from the open root at y = 0, thickness along z (occ_bridge's
/// HalfWing): sections of 6 points (7 with a blunt trailing edge) at each station and a flat tip cap of
/// strips along the chord line with a kite at the trailing edge and two triangles at the leading edge.
struct WingCageShape {
  double root_chord = 1, tip_chord = 0.6, semi_span = 2, sweep_degrees = 25;
  double half_base = 0;                           ///< of the chord; 0: sharp trailing edge
  std::vector<double> stations{0, 0.35, 0.7, 1};  ///< of the span
  double thickness = 0.12;
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
  for (Index i = 0; i < n; ++i) add_crease(cage, tip + i, tip + (i + 1) % n);
  const Index front = static_cast<Index>(cage.points.size());
  cage.points.push_back(at(1, 0.2, 0));
  const Index back = front + 1;
  cage.points.push_back(at(1, 0.6, 0));
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
