#pragma once
#include <array>
#include <span>
#include <vector>

#include "core/project/box_tree.hpp"

namespace flowcage {

/// Signed solid angle of the triangle a b c seen from the origin, in (-2 pi, 2 pi]: positive where it appears
/// clockwise, that is from behind (van Oosterom & Strackee 1983).
double solid_angle(const Vec3& a, const Vec3& b, const Vec3& c);

/// Triangles prepared for winding numbers: a box tree, and for each of its nodes the expansion of the
/// winding number of the node's triangles about their centroid up to the second order (Barill, Dickson,
/// Schmidt, Levin, Jacobson 2018, eq. 17). About 400 bytes a triangle.
struct WindingTree {
  struct Moments {
    Vec3 centre = Vec3::Zero();
    double radius = 0;                   ///< of the ball about the centre that holds the node's triangles
    Vec3 area = Vec3::Zero();            ///< integral of n
    Eigen::Matrix3d first;               ///< integral of n (x - centre)^T
    Eigen::Matrix<double, 3, 6> second;  ///< integral of n times xx, yy, zz, xy, xz, yz of x - centre
  };
  BoxTree boxes;                               ///< its items are triangles
  std::vector<std::array<Vec3, 3>> triangles;  ///< in the order of boxes.order
  std::vector<Moments> moments;                ///< one a node
};

WindingTree build_winding_tree(std::span<const Vec3> points, std::span<const std::array<Index, 3>> triangles);

/// The generalized winding number (Jacobson, Kavan, Sorkine-Hornung 2013): the triangles' solid angle seen
/// from p over 4 pi. Of a closed surface whose triangles are counter-clockwise from outside, 1 inside and 0
/// outside; 2 where two of them overlap; in between near the gaps of one that is not closed. Jumps by 1
/// across a triangle; on it, either side's value.
///
/// A node farther from p than `beta` of its radii is taken by its expansion: the error falls like beta^-4
/// (3e-4 at 2 on closed bodies, measured); an infinite beta gives the exact sum.
double winding_number(const WindingTree& tree, const Vec3& p, double beta = 2);

/// Closes the open rims of triangles that share points by index, with a fan from the centre of each connected
/// rim, so that the winding number is whole everywhere: what a body with gaps or an open end is taken to
/// enclose. Appends the centres to `points` and the fans to `triangles`.
void close_rims(std::vector<Vec3>& points, std::vector<std::array<Index, 3>>& triangles);

/// Winding numbers of many points, in parallel. Precondition: results.size() == points.size().
void winding_numbers(const WindingTree& tree, std::span<const Vec3> points, double beta,
                     std::span<double> results);

}  // namespace flowcage
