#include "core/mesh/manifold_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/base/error.hpp"

namespace flowcage {
namespace {

using Kind = CageDefect::Kind;
using Element = CageDefect::Element;

/// A face's use of an edge, from the vertex at `corner` (a position in faces.values) to the next one.
struct HalfEdge {
  Index low, high;  // end vertices in ascending order
  bool ascending;   // runs from low to high
  Index face;
  Offset corner, next;  // positions in faces.values of the start and the end
};

/// Disjoint sets with path halving: joins the corners that share an edge.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), Offset{0});
  }
  Offset root(Offset i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void join(Offset a, Offset b) { parent_[root(b)] = root(a); }

 private:
  std::vector<Offset> parent_;
};

std::string vertex_text(const Cage& cage, Index v) {
  return fmt::format("vertex {} at {}", v + 1, place(cage.points[v]));
}

std::string edge_text(const Cage& cage, Index a, Index b) {
  return fmt::format("edge {}-{} at {}", a + 1, b + 1, place(0.5 * cage.points[a] + 0.5 * cage.points[b]));
}

bool is_vertex(const Cage& cage, Index v) {
  return v >= 0 && static_cast<std::size_t>(v) < cage.points.size();
}

std::optional<CageDefect> find_bad_table(const Cage& cage) {
  if (cage.faces.size() == 0) {
    return CageDefect{Kind::empty, Element::cage, no_index, "the cage has no faces",
                      "draw the polyhedron as faces (`f` lines)"};
  }
  const bool has_patches = !cage.face_patch.empty();
  if (has_patches && cage.face_patch.size() != static_cast<std::size_t>(cage.faces.size())) {
    return CageDefect{Kind::bad_patch, Element::cage, no_index,
                      fmt::format("{} faces but {} patch numbers", cage.faces.size(), cage.face_patch.size()),
                      "give each face one patch"};
  }
  for (Index f = 0; has_patches && f < cage.faces.size(); ++f) {
    const Index patch = cage.face_patch[f];
    if (patch < 0 || static_cast<std::size_t>(patch) >= cage.patch_names.size()) {
      return CageDefect{Kind::bad_patch, Element::face, f,
                        fmt::format("face {} has patch number {}, but there are {} patches", f + 1, patch,
                                    cage.patch_names.size()),
                        "give each face a patch that exists"};
    }
  }
  for (Index v = 0; is_vertex(cage, v); ++v) {
    if (!cage.points[v].allFinite()) {
      return CageDefect{Kind::point_not_finite, Element::vertex, v,
                        fmt::format("vertex {} is not finite: {}", v + 1, place(cage.points[v])),
                        "write finite coordinates"};
    }
  }
  return std::nullopt;
}

std::optional<CageDefect> find_bad_face(const Cage& cage) {
  std::vector<Index> seen_in(cage.points.size(), no_index);
  for (Index f = 0; f < cage.faces.size(); ++f) {
    if (cage.faces.row_size(f) < 3) {
      return CageDefect{Kind::face_too_small, Element::face, f,
                        fmt::format("face {} has {} vertices", f + 1, cage.faces.row_size(f)),
                        "a face needs at least three"};
    }
    for (const Index v : cage.faces[f]) {
      if (!is_vertex(cage, v)) {
        return CageDefect{Kind::index_out_of_range, Element::face, f,
                          fmt::format("face {} names vertex {}, but there are {} vertices", f + 1,
                                      static_cast<Offset>(v) + 1, cage.points.size()),
                          "correct the face, or add the missing vertex"};
      }
      if (seen_in[v] == f) {
        return CageDefect{Kind::face_repeats_vertex, Element::face, f,
                          fmt::format("face {} has {} twice", f + 1, vertex_text(cage, v)),
                          "split the face, or remove the repeated vertex"};
      }
      seen_in[v] = f;
    }
  }
  return std::nullopt;
}

/// Sorted by edge, then by face: uses of one edge are neighbours.
std::vector<HalfEdge> sorted_half_edges(const Cage& cage) {
  std::vector<HalfEdge> half_edges;
  half_edges.reserve(cage.faces.values.size());
  for (Index f = 0; f < cage.faces.size(); ++f) {
    const Offset begin = cage.faces.offsets[f], end = cage.faces.offsets[f + 1];
    for (Offset corner = begin; corner < end; ++corner) {
      const Offset next = corner + 1 < end ? corner + 1 : begin;
      const Index a = cage.faces.values[corner], b = cage.faces.values[next];
      half_edges.push_back({std::min(a, b), std::max(a, b), a < b, f, corner, next});
    }
  }
  std::sort(half_edges.begin(), half_edges.end(), [](const HalfEdge& x, const HalfEdge& y) {
    return std::tie(x.low, x.high, x.corner) < std::tie(y.low, y.high, y.corner);
  });
  return half_edges;
}

bool same_edge(const HalfEdge& x, const HalfEdge& y) {
  return x.low == y.low && x.high == y.high;
}

std::optional<CageDefect> find_bad_edge(const Cage& cage, const std::vector<HalfEdge>& half_edges) {
  for (std::size_t i = 2; i < half_edges.size(); ++i) {
    const HalfEdge& h = half_edges[i];
    if (!same_edge(half_edges[i - 2], h)) continue;
    return CageDefect{
        Kind::edge_overused, Element::face, h.face,
        fmt::format("{} belongs to more than two faces ({}, {}, {})", edge_text(cage, h.low, h.high),
                    half_edges[i - 2].face + 1, half_edges[i - 1].face + 1, h.face + 1),
        "an edge may have two faces at most: remove inner faces, or separate the parts"};
  }
  for (std::size_t i = 1; i < half_edges.size(); ++i) {
    const HalfEdge &g = half_edges[i - 1], &h = half_edges[i];
    if (!same_edge(g, h) || g.ascending != h.ascending) continue;
    return CageDefect{Kind::inconsistent_faces, Element::face, h.face,
                      fmt::format("faces {} and {} run along {} in the same direction", g.face + 1,
                                  h.face + 1, edge_text(cage, h.low, h.high)),
                      "reverse one of them, so that all faces are counter-clockwise seen from outside"};
  }
  return std::nullopt;
}

std::optional<CageDefect> find_bad_vertex(const Cage& cage, const std::vector<HalfEdge>& half_edges) {
  std::vector<Offset> first_corner(cage.points.size(), -1);
  for (std::size_t corner = cage.faces.values.size(); corner-- > 0;) {
    first_corner[cage.faces.values[corner]] = static_cast<Offset>(corner);
  }
  for (Index v = 0; is_vertex(cage, v); ++v) {
    if (first_corner[v] < 0) {
      return CageDefect{Kind::unused_vertex, Element::vertex, v,
                        fmt::format("{} belongs to no face", vertex_text(cage, v)),
                        "remove it, or use it in a face"};
    }
  }

  std::vector<Index> order(cage.points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](Index v) {
    return std::make_tuple(cage.points[v].x(), cage.points[v].y(), cage.points[v].z());
  };
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::tuple_cat(key(a), std::tie(a)) < std::tuple_cat(key(b), std::tie(b));
  });
  const auto twin =
      std::adjacent_find(order.begin(), order.end(), [&](Index a, Index b) { return key(a) == key(b); });
  if (twin != order.end()) {
    return CageDefect{Kind::repeated_point, Element::vertex, twin[1],
                      fmt::format("{} repeats vertex {}", vertex_text(cage, twin[1]), twin[0] + 1),
                      "merge the vertices that lie at one place (\"merge by distance\" of a modeller)"};
  }

  // Two faces that share an edge are neighbours in the fans of both its ends.
  DisjointSets fans(cage.faces.values.size());
  for (std::size_t i = 1; i < half_edges.size(); ++i) {
    const HalfEdge &g = half_edges[i - 1], &h = half_edges[i];
    if (!same_edge(g, h)) continue;
    fans.join(g.corner, h.next);
    fans.join(g.next, h.corner);
  }
  for (Index f = 0; f < cage.faces.size(); ++f) {
    for (Offset corner = cage.faces.offsets[f]; corner < cage.faces.offsets[f + 1]; ++corner) {
      const Index v = cage.faces.values[corner];
      if (fans.root(corner) == fans.root(first_corner[v])) continue;
      return CageDefect{Kind::several_fans, Element::vertex, v,
                        fmt::format("the faces at {} are not one fan: parts touch in a point (face {})",
                                    vertex_text(cage, v), f + 1),
                        "give each part a vertex of its own, apart from the other"};
    }
  }
  return std::nullopt;
}

std::optional<CageDefect> find_bad_tag(const Cage& cage, const std::vector<HalfEdge>& half_edges) {
  const auto out_of_range = [&](Element element, Index index, const char* name, Index v) {
    return CageDefect{Kind::index_out_of_range, element, index,
                      fmt::format("{} {} names vertex {}, but there are {} vertices (counted from 1)", name,
                                  index + 1, static_cast<Offset>(v) + 1, cage.points.size()),
                      "name vertices that exist"};
  };
  const auto bad_sharpness = [](Element element, Index index, const std::string& where, double sharpness) {
    return CageDefect{Kind::sharpness_not_positive, element, index,
                      fmt::format("sharpness {} of the {}", sharpness, where),
                      "give a sharpness of 0 or more; 10 is infinitely sharp"};
  };
  const auto is_edge = [&](Index a, Index b) {
    const std::pair<Index, Index> wanted = std::minmax(a, b);
    const auto found = std::lower_bound(half_edges.begin(), half_edges.end(), wanted,
                                        [](const HalfEdge& h, const std::pair<Index, Index>& w) {
                                          return std::tie(h.low, h.high) < std::tie(w.first, w.second);
                                        });
    return found != half_edges.end() && found->low == wanted.first && found->high == wanted.second;
  };
  for (Index c = 0; static_cast<std::size_t>(c) < cage.creases.size(); ++c) {
    const Cage::Crease& crease = cage.creases[c];
    for (const Index v : {crease.a, crease.b}) {
      if (!is_vertex(cage, v)) return out_of_range(Element::crease, c, "crease", v);
    }
    if (!is_edge(crease.a, crease.b)) {
      return CageDefect{Kind::crease_is_no_edge, Element::crease, c,
                        fmt::format("crease from {} to {} is no edge of a face", vertex_text(cage, crease.a),
                                    vertex_text(cage, crease.b)),
                        "let the crease follow edges of the cage, one after the other"};
    }
    if (!(crease.sharpness >= 0)) {
      return bad_sharpness(Element::crease, c, "crease on " + edge_text(cage, crease.a, crease.b),
                           crease.sharpness);
    }
  }
  for (Index c = 0; static_cast<std::size_t>(c) < cage.corners.size(); ++c) {
    const Cage::Corner& corner = cage.corners[c];
    if (!is_vertex(cage, corner.vertex)) return out_of_range(Element::corner, c, "corner", corner.vertex);
    if (!(corner.sharpness >= 0)) {
      return bad_sharpness(Element::corner, c, "corner at " + vertex_text(cage, corner.vertex),
                           corner.sharpness);
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<CageDefect> find_manifold_defect(const Cage& cage) {
  if (auto defect = find_bad_table(cage)) return defect;
  if (auto defect = find_bad_face(cage)) return defect;
  const std::vector<HalfEdge> half_edges = sorted_half_edges(cage);
  if (auto defect = find_bad_edge(cage, half_edges)) return defect;
  if (auto defect = find_bad_vertex(cage, half_edges)) return defect;
  return find_bad_tag(cage, half_edges);
}

void require_manifold(const Cage& cage) {
  const std::optional<CageDefect> defect = find_manifold_defect(cage);
  if (!defect) return;
  throw input_error(cage.source.empty() ? "cage" : cage.source, 0, defect->message, defect->remedy);
}

}  // namespace flowcage
