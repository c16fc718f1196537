// Cages that tests of blocks and volume share.
#pragma once
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/mesh/cage.hpp"

namespace flowcage::sample {

inline Cage make_cage(std::vector<Vec3> points, const std::vector<std::vector<Index>>& faces) {
  Cage cage;
  cage.points = std::move(points);
  for (const auto& f : faces) cage.faces.push_row(f);
  cage.face_patch.assign(faces.size(), 0);
  cage.patch_names = {""};
  return cage;
}

/// A box about the origin; without the side at y-min when `open`.
inline Cage box_cage(const Vec3& half, bool open = false) {
  std::vector<Vec3> points;
  for (int n = 0; n < 8; ++n) {
    points.emplace_back((n & 1 ? 1 : -1) * half.x(), (n & 2 ? 1 : -1) * half.y(),
                        (n & 4 ? 1 : -1) * half.z());
  }
  std::vector<std::vector<Index>> faces{{0, 2, 3, 1}, {4, 5, 7, 6}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  if (!open) faces.push_back({0, 1, 5, 4});
  return make_cage(points, faces);
}

/// A closed box about the origin with its 12 edges sharp.
inline Cage sharp_box_cage(const Vec3& half) {
  Cage cage = box_cage(half);
  for (Index a = 0; a < 8; ++a) {
    for (const Index bit : {1, 2, 4}) {
      if ((a & bit) == 0) cage.creases.push_back({a, a | bit, infinitely_sharp});
    }
  }
  return cage;
}

/// n sections of m vertices about the z axis.
inline Cage torus_cage(int n, int m, double major, double minor) {
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> faces;
  const double turn = 2 * 3.14159265358979;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < m; ++j) {
      const double r = major + minor * std::cos(turn * j / m);
      points.emplace_back(r * std::cos(turn * i / n), r * std::sin(turn * i / n),
                          minor * std::sin(turn * j / m));
      const auto at = [&](int a, int b) { return static_cast<Index>((a % n) * m + b % m); };
      faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return make_cage(points, faces);
}

/// A prism over a regular n-gon: caps with n sides.
inline Cage prism_cage(int n, double radius, double half_height) {
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> faces(2);
  for (int i = 0; i < n; ++i) {
    const double a = 2 * 3.14159265358979 * i / n;
    points.emplace_back(radius * std::cos(a), radius * std::sin(a), -half_height);
    points.emplace_back(radius * std::cos(a), radius * std::sin(a), half_height);
    const int next = (i + 1) % n;
    faces.push_back({2 * i, 2 * next, 2 * next + 1, 2 * i + 1});
    faces[0].insert(faces[0].begin(), 2 * i);
    faces[1].push_back(2 * i + 1);
  }
  return make_cage(points, faces);
}

/// A swept, tapered half wing like the ONERA M6: `sections` rings of six vertices along y from the root plane
/// y = 0 (open), two vertices on the tip; triangles at the tip's ends.
inline Cage wing_cage(int sections = 4, double sweep = 0.58) {
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> faces;
  for (int s = 0; s < sections; ++s) {
    const double y = 1.2 * s / (sections - 1);
    const double chord = 0.8 - 0.3 * y;
    const double profile[6][2] = {{0, 0}, {0.2, 0.05}, {0.65, 0.04}, {0.2, -0.05}, {0.65, -0.04}, {1, 0}};
    for (const auto& [x, z] : profile) points.emplace_back(sweep * y + chord * x, y, chord * z);
  }
  const int loop[6] = {0, 1, 2, 5, 4, 3};
  for (int s = 0; s + 1 < sections; ++s) {
    for (int n = 0; n < 6; ++n) {
      const Index a = 6 * s + loop[n];
      const Index b = 6 * s + loop[(n + 1) % 6];
      faces.push_back({a, b, b + 6, a + 6});
    }
  }
  const Index r = 6 * (sections - 1);
  const auto front = static_cast<Index>(points.size());
  points.emplace_back(0.5 * (points[r + 1] + points[r + 3]) + Vec3(0, 0.02, 0));
  points.emplace_back(0.5 * (points[r + 2] + points[r + 4]) + Vec3(0, 0.02, 0));
  const Index back = front + 1;
  faces.push_back({r, r + 1, front});
  faces.push_back({r, front, r + 3});
  faces.push_back({r + 1, r + 2, back, front});
  faces.push_back({r + 4, r + 3, front, back});
  faces.push_back({r + 2, r + 5, r + 4, back});
  Cage cage = make_cage(points, faces);
  for (int s = 0; s + 1 < sections; ++s) cage.creases.push_back({6 * s + 5, 6 * s + 11, 10});
  cage.corners = {{r + 5, 10}};
  return cage;
}

inline Cage scaled(Cage cage, double factor) {
  for (Vec3& p : cage.points) p *= factor;
  return cage;
}

/// The same polyhedron with vertices, faces and the first corner of each face in another order.
inline Cage renumbered(const Cage& cage, std::mt19937& random) {
  std::vector<Index> vertex(cage.points.size());
  std::iota(vertex.begin(), vertex.end(), 0);
  std::shuffle(vertex.begin(), vertex.end(), random);
  std::vector<Index> face(cage.faces.size());
  std::iota(face.begin(), face.end(), 0);
  std::shuffle(face.begin(), face.end(), random);
  Cage result = cage;
  for (std::size_t v = 0; v < vertex.size(); ++v) result.points[vertex[v]] = cage.points[v];
  result.faces = {};
  result.face_patch.clear();
  for (const Index f : face) {
    std::vector<Index> row(cage.faces[f].begin(), cage.faces[f].end());
    for (Index& v : row) v = vertex[v];
    std::rotate(row.begin(), row.begin() + static_cast<long>(random() % row.size()), row.end());
    result.faces.push_row(row);
    result.face_patch.push_back(cage.face_patch[f]);
  }
  for (Cage::Crease& c : result.creases) {
    c.a = vertex[c.a];
    c.b = vertex[c.b];
  }
  for (Cage::Corner& c : result.corners) c.vertex = vertex[c.vertex];
  return result;
}

}  // namespace flowcage::sample
