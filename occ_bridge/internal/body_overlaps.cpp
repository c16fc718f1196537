#include "occ_bridge/internal/body_overlaps.hpp"

#include <TopoDS_Iterator.hxx>
#include <algorithm>
#include <array>
#include <numeric>

#include "occ_bridge/internal/face_edges.hpp"
#include "occ_bridge/internal/tessellate.hpp"

namespace flowcage::occ {

namespace {

using Triangle = std::array<Vec3, 3>;

struct SearchedBody {
  std::vector<Box3> boxes;  ///< of the triangles
  BoxTree tree;
  Box3 box;
};

Triangle triangle_of(const Tessellation& mesh, Index t) {
  const auto& corners = mesh.triangles[t];
  return {mesh.points[corners[0]], mesh.points[corners[1]], mesh.points[corners[2]]};
}

SearchedBody searched(const Tessellation& mesh) {
  SearchedBody result;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    Box3 box;
    for (const Vec3& corner : triangle_of(mesh, t)) box.extend(corner);
    result.boxes.push_back(box);
    result.box.extend(box);
  }
  result.tree = build_box_tree(result.boxes);
  return result;
}

/// All of b farther than reach on one side of a's plane.
bool beside_plane(const Triangle& a, const Triangle& b, double reach) {
  const Vec3 n = (a[1] - a[0]).cross(a[2] - a[0]);
  const double limit = reach * n.norm();
  std::array<double, 3> side{};
  for (int k = 0; k < 3; ++k) side[k] = n.dot(b[k] - a[0]);
  return std::ranges::min(side) > limit || std::ranges::max(side) < -limit;
}

bool encloses(const Tessellation& mesh) {
  constexpr double nearly_closed = 0.1;
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (Index t = 0; t < static_cast<Index>(mesh.triangles.size()); ++t) {
    const Triangle corners = triangle_of(mesh, t);
    const Vec3 twice = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    sum += twice;
    area += twice.norm();
  }
  return sum.norm() < nearly_closed * area;
}

Box3 grown(const Box3& box, double by) {
  return {box.min() - Vec3::Constant(by), box.max() + Vec3::Constant(by)};
}

class Finder {
 public:
  Finder(const std::vector<Body>& bodies, double reach) : bodies_(bodies), reach_(reach) {
    for (const Body& body : bodies) {
      searched_.push_back(searched(body.mesh));
      const auto& faces = body.mesh.triangle_face;
      near_.emplace_back(faces.empty() ? 0 : *std::ranges::max_element(faces) + 1, false);
    }
    parent_.resize(bodies.size());
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  std::vector<BodyGroup> find() {
    const auto count = static_cast<Index>(bodies_.size());
    for (Index a = 0; a < count; ++a) {
      for (Index b = a + 1; b < count; ++b) {
        if (!bodies_[a].encloses && !bodies_[b].encloses) continue;
        if (!grown(searched_[a].box, reach_).intersects(searched_[b].box)) continue;
        if (mark_near_faces(a, b) || contains(a, b) || contains(b, a)) parent_[root(b)] = root(a);
      }
    }
    std::vector<BodyGroup> groups;
    for (Index a = 0; a < count; ++a) {
      BodyGroup group;
      for (Index b = a; b < count; ++b) {
        if (root(b) == root(a)) group.bodies.push_back(b);
      }
      const bool first = std::ranges::none_of(
          groups, [&](const BodyGroup& known) { return root(known.bodies[0]) == root(a); });
      if (group.bodies.size() < 2 || !first) continue;
      for (const Index b : group.bodies) {
        std::vector<Index> faces;
        for (Index f = 0; f < static_cast<Index>(near_[b].size()); ++f) {
          if (near_[b][f]) faces.push_back(f);
        }
        group.near_faces.push_back(std::move(faces));
      }
      groups.push_back(std::move(group));
    }
    return groups;
  }

 private:
  Index root(Index i) const {
    while (parent_[i] != i) i = parent_[i];
    return i;
  }

  bool mark_near_faces(Index a, Index b) {
    bool any = false;
    const Box3 around = grown(searched_[b].box, reach_);
    for (Index t = 0; t < static_cast<Index>(searched_[a].boxes.size()); ++t) {
      const Box3 box = grown(searched_[a].boxes[t], reach_);
      if (!around.intersects(box)) continue;
      const Triangle triangle = triangle_of(bodies_[a].mesh, t);
      const double radius = 0.5 * box.diagonal().norm();
      visit_near(
          searched_[b].tree, box.center(), [&] { return radius; },
          [&](Index other) {
            const Index face = bodies_[a].mesh.triangle_face[t];
            const Index other_face = bodies_[b].mesh.triangle_face[other];
            if (near_[a][face] && near_[b][other_face] && any) return;
            if (!box.intersects(searched_[b].boxes[other])) return;
            const Triangle candidate = triangle_of(bodies_[b].mesh, other);
            if (beside_plane(triangle, candidate, reach_) || beside_plane(candidate, triangle, reach_)) {
              return;
            }
            near_[a][face] = near_[b][other_face] = any = true;
          });
    }
    return any;
  }

  /// Asked of bodies whose surfaces are apart: then one point decides.
  bool contains(Index outer, Index inner) const {
    if (bodies_[inner].mesh.points.empty()) return false;
    const Vec3& p = bodies_[inner].mesh.points.front();
    if (!searched_[outer].box.contains(p)) return false;
    Tessellation mesh = bodies_[outer].mesh;
    close_rims(mesh.points, mesh.triangles);
    return winding_number(build_winding_tree(mesh.points, mesh.triangles), p) > 0.5;
  }

  const std::vector<Body>& bodies_;
  double reach_;
  std::vector<SearchedBody> searched_;
  std::vector<std::vector<bool>> near_;
  std::vector<Index> parent_;
};

}  // namespace

std::vector<Body> bodies_of(const TopoDS_Shape& compound) {
  std::vector<Body> bodies;
  for (TopoDS_Iterator it(compound); it.More(); it.Next()) {
    const FaceEdges topology = face_edges_of(it.Value());
    Body body{.shape = it.Value(), .mesh = collect_triangles(topology, 1)};
    body.closed = topology.face_count() > 0 && topology.free_edge_count() == 0;
    body.encloses = body.closed || encloses(body.mesh);
    bodies.push_back(std::move(body));
  }
  return bodies;
}

std::vector<BodyGroup> interfering_bodies(const std::vector<Body>& bodies, double reach) {
  return Finder(bodies, reach).find();
}

}  // namespace flowcage::occ
