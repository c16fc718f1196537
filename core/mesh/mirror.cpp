#include "core/mesh/mirror.hpp"

#include <bit>
#include <cassert>
#include <unordered_map>

namespace flowcage {
namespace {

// Reflections as a set: bit a for the plane of axis a.
using Reflections = unsigned;

// Numbers of the images of one kind of element. An element lying in some of the planes is its own image
// there.
class Images {
 public:
  explicit Images(Index own_count) : next_(own_count) {}
  // The image's number, and whether it is new.
  std::pair<Index, bool> number(Index element, Reflections lies_in, Reflections reflections) {
    reflections &= ~lies_in;
    if (reflections == 0) return {element, false};
    const auto [at, is_new] = numbers_.try_emplace(8 * Offset{element} + reflections, next_);
    if (is_new) ++next_;
    return {at->second, is_new};
  }
  // Precondition: it has a number.
  Index find(Index element, Reflections lies_in, Reflections reflections) const {
    reflections &= ~lies_in;
    return reflections == 0 ? element : numbers_.at(8 * Offset{element} + reflections);
  }

 private:
  std::unordered_map<Offset, Index> numbers_;
  Index next_;
};

class Extender {
 public:
  Extender(const SurfaceLevel& own, SurfaceLevel& extended, MirrorFold& fold)
      : own_(own),
        extended_(extended),
        fold_(fold),
        vertices_(own.vertex_count()),
        edges_(own.edge_count()),
        faces_(own.face_count()) {}

  void run() {
    fold_.planes = own_.mirrors;
    fold_.in_planes.assign(static_cast<std::size_t>(own_.vertex_count()), 0);
    for (Index e = 0; e < own_.edge_count(); ++e) {
      for (const Index v : own_.edge_vertices[e]) {
        fold_.in_planes[v] = static_cast<std::uint8_t>(fold_.in_planes[v] | edge_planes(e));
      }
    }
    extended_.face_vertices = own_.face_vertices;
    extended_.face_edges = own_.face_edges;
    extended_.edge_vertices = own_.edge_vertices;
    extended_.edge_faces = own_.edge_faces;
    extended_.edge_sharpness = own_.edge_sharpness;
    extended_.vertex_sharpness = own_.vertex_sharpness;
    extended_.face_patch = own_.face_patch;
    extended_.depth = own_.depth;
    add_faces();
    for (Index v = 0; v < own_.vertex_count(); ++v) add_ring(v);
    const auto all = extended_.vertex_sharpness.size() + 1;
    extended_.vertex_edges.offsets.resize(all, extended_.vertex_edges.offsets.back());
    extended_.vertex_faces.offsets.resize(all, extended_.vertex_faces.offsets.back());
  }

 private:
  Reflections edge_planes(Index e) const {
    const int axis = own_.edge_mirror_axis[e];
    return axis < 0 ? 0U : 1U << axis;
  }

  // The images of every face that complete the ring of one of its vertices.
  void add_faces() {
    for (Index f = 0; f < own_.face_count(); ++f) {
      std::array<bool, 8> wanted{};
      for (const Index v : own_.face_vertices[f]) {
        for (Reflections r = 1; r < 8; ++r) {
          if ((r & ~Reflections{fold_.in_planes[v]}) == 0) wanted[r] = true;
        }
      }
      for (Reflections r = 1; r < 8; ++r) {
        if (wanted[r]) add_face(f, r);
      }
    }
  }

  void add_face(Index f, Reflections r) {
    const bool reversed = std::popcount(r) % 2 == 1;
    const auto vertices = own_.face_vertices[f];
    const auto edges = own_.face_edges[f];
    const auto size = vertices.size();
    const Index image = faces_.number(f, 0, r).first;
    for (std::size_t i = 0; i < size; ++i) {
      // Backward from corner 0: corner -i, and the edge from there to corner -i - 1.
      const Index v = vertices[reversed ? (size - i) % size : i];
      const Index e = edges[reversed ? size - 1 - i : i];
      extended_.face_vertices.values.push_back(image_of_vertex(v, r));
      extended_.face_edges.values.push_back(image_of_edge(e, r));
      auto& beside = extended_.edge_faces[extended_.face_edges.values.back()];
      beside[beside[0] == no_index ? 0 : 1] = image;
    }
    const auto end = static_cast<Offset>(extended_.face_vertices.values.size());
    extended_.face_vertices.offsets.push_back(end);
    extended_.face_edges.offsets.push_back(end);
    extended_.face_patch.push_back(own_.face_patch[f]);
  }

  Index image_of_vertex(Index v, Reflections r) {
    const Reflections lies_in = fold_.in_planes[v];
    const auto [image, is_new] = vertices_.number(v, lies_in, r);
    if (is_new) {
      extended_.vertex_sharpness.push_back(own_.vertex_sharpness[v]);
      fold_.original.push_back(v);
      fold_.reflected.push_back(static_cast<std::uint8_t>(r & ~lies_in));
    }
    return image;
  }

  Index image_of_edge(Index e, Reflections r) {
    const auto [image, is_new] = edges_.number(e, edge_planes(e), r);
    if (is_new) {
      const auto [a, b] = own_.edge_vertices[e];
      extended_.edge_vertices.push_back({image_of_vertex(a, r), image_of_vertex(b, r)});
      extended_.edge_faces.push_back({no_index, no_index});
      extended_.edge_sharpness.push_back(own_.edge_sharpness[e]);
    }
    return image;
  }

  // A part of a ring: the vertex's own fan or an image of it, counter-clockwise. An odd number of reflections
  // turns the fan round. The edge that two parts share is left to the second.
  void add_part(Index v, Reflections r, bool backward) {
    const auto edges = own_.vertex_edges[v];
    const auto faces = own_.vertex_faces[v];
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const Index e = backward ? edges[edges.size() - 1 - i] : edges[i];
      const Index f = backward ? faces[faces.size() - 1 - i] : faces[i];
      extended_.vertex_edges.values.push_back(edges_.find(e, edge_planes(e), r));
      extended_.vertex_faces.values.push_back(r == 0 ? f : faces_.find(f, 0, r));
    }
  }

  void add_ring(Index v) {
    const auto edges = own_.vertex_edges[v];
    if (fold_.in_planes[v] == 0) {
      const auto faces = own_.vertex_faces[v];
      extended_.vertex_edges.values.insert(extended_.vertex_edges.values.end(), edges.begin(), edges.end());
      extended_.vertex_faces.values.insert(extended_.vertex_faces.values.end(), faces.begin(), faces.end());
    } else {
      const Reflections first = edge_planes(edges.front()), last = edge_planes(edges.back());
      if (last == 0) {  // open at the other end: the ring starts there
        add_part(v, first, true);
        add_part(v, 0, false);
        extended_.vertex_edges.values.push_back(edges.back());
      } else {
        add_part(v, 0, false);
        add_part(v, last, true);
        if (first == 0) {
          extended_.vertex_edges.values.push_back(edges_.find(edges.front(), 0, last));
        } else if (first != last) {  // two planes: four parts
          add_part(v, first | last, false);
          add_part(v, first, true);
        }
      }
    }
    extended_.vertex_edges.offsets.push_back(static_cast<Offset>(extended_.vertex_edges.values.size()));
    extended_.vertex_faces.offsets.push_back(static_cast<Offset>(extended_.vertex_faces.values.size()));
  }

  const SurfaceLevel& own_;
  SurfaceLevel& extended_;
  MirrorFold& fold_;
  Images vertices_, edges_, faces_;
};

}  // namespace

MirrorPlanes unite(const MirrorPlanes& a, const MirrorPlanes& b) {
  MirrorPlanes both = a;
  for (int axis = 0; axis < 3; ++axis) {
    if (!b.on[axis]) continue;
    assert(!a.on[axis] || a.value[axis] == b.value[axis]);
    both.on[axis] = true;
    both.value[axis] = b.value[axis];
  }
  return both;
}

Vec3 MirrorFold::factors(Index v) const {
  const unsigned lies_in = in_planes[original_of(v)];
  const unsigned turned = v < vertex_count() ? 0U : reflected[v - vertex_count()];
  Vec3 by_axis = Vec3::Ones();
  for (int axis = 0; axis < 3; ++axis) {
    if ((turned >> axis & 1U) != 0) by_axis[axis] = -1;
    if ((lies_in >> axis & 1U) != 0) by_axis[axis] = 0;
  }
  return by_axis;
}

void put_into_planes(unsigned axes, const Vec3& values, Vec3& point) {
  for (int axis = 0; axis < 3; ++axis) {
    if ((axes >> axis & 1U) != 0) point[axis] = values[axis];
  }
}

SurfaceLevel mirrored(SurfaceLevel level, int axis, double value, std::span<const Index> edges) {
  assert(axis >= 0 && axis < 3 && !level.mirrors.on[axis]);
  level.mirrors.on[axis] = true;
  level.mirrors.value[axis] = value;
  level.edge_mirror_axis.resize(level.edge_vertices.size(), -1);
  for (const Index e : edges) {
    assert(level.is_boundary_edge(e) && level.edge_mirror_axis[e] < 0);
    level.edge_mirror_axis[e] = static_cast<std::int8_t>(axis);
    level.edge_sharpness[e] = 0;
    for (const Index v : level.edge_vertices[e]) {
      if (level.vertex_faces.row_size(v) == 1) level.vertex_sharpness[v] = 0;
    }
  }
  return level;
}

MirrorExtension::MirrorExtension(const SurfaceLevel& level) : own_(level) {
  if (!level.mirrors.any()) return;
  extended_.emplace();
  Extender(own_, *extended_, fold_).run();
}

unsigned MirrorExtension::planes_of_edge(Index e) const {
  return extended_ && own_.edge_mirror_axis[e] >= 0 ? 1U << own_.edge_mirror_axis[e] : 0;
}

std::vector<Vec3> MirrorExtension::extend(std::span<const Vec3> points) const {
  assert(static_cast<Index>(points.size()) == fold_.vertex_count());
  const Vec3& origin = fold_.planes.value;
  std::vector<Vec3> all(points.begin(), points.end());
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (fold_.in_planes[v] != 0) put_into_planes(fold_.in_planes[v], origin, all[v]);
  }
  for (std::size_t i = 0; i < fold_.original.size(); ++i) {
    Vec3 image = all[fold_.original[i]];
    for (int axis = 0; axis < 3; ++axis) {
      if ((fold_.reflected[i] >> axis & 1U) != 0) image[axis] = 2 * origin[axis] - image[axis];
    }
    all.push_back(image);
  }
  return all;
}

}  // namespace flowcage
