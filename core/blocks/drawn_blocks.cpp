#include "core/blocks/drawn_blocks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "core/base/error.hpp"
#include "core/blocks/pillow.hpp"

namespace flowcage {
namespace {

using Edge = std::array<Index, 2>;

Edge edge_of(const BoundaryQuad& quad, int n) {
  const Index a = quad.corners[n], b = quad.corners[(n + 1) % 4];
  return {std::min(a, b), std::max(a, b)};
}

/// Which connected part of the boundary each quad belongs to.
std::vector<Index> boundary_parts(const BlockDraft& draft) {
  std::vector<Index> root(draft.points.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](Index v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const BoundaryQuad& quad : draft.boundary) {
    for (int n = 1; n < 4; ++n) root[find(quad.corners[n])] = find(quad.corners[0]);
  }
  std::vector<Index> part;
  for (const BoundaryQuad& quad : draft.boundary) part.push_back(find(quad.corners[0]));
  return part;
}

/// The largest part of a boundary of walls only is the far field.
void find_far_field(DrawnBlocks& blocks, const std::string& source) {
  const std::vector<Index> part = boundary_parts(blocks.draft);
  std::map<Index, Box3> boxes;
  for (std::size_t b = 0; b < part.size(); ++b) {
    for (const Index v : blocks.draft.boundary[b].corners) boxes[part[b]].extend(blocks.draft.points[v]);
  }
  if (boxes.size() < 2) {
    throw input_error(source, 0, "all of the blocks' boundary is wall",
                      "name the patches of the far field and of symmetry planes in the file, or say --flow "
                      "internal");
  }
  const auto largest = std::max_element(boxes.begin(), boxes.end(), [](const auto& a, const auto& b) {
    return a.second.diagonal().norm() < b.second.diagonal().norm();
  });
  const auto far = static_cast<Index>(blocks.patches.size());
  blocks.patches.push_back({"farfield", PatchType::farfield});
  for (std::size_t b = 0; b < part.size(); ++b) {
    if (part[b] == largest->first) blocks.draft.boundary[b].patch = far;
  }
}

/// Whether a block has two faces of the wall, or a wall vertex more than one line.
bool needs_layer(const BlockDraft& draft, std::span<const char> is_wall) {
  std::vector<char> on_wall(draft.points.size(), 0);
  std::set<std::array<Index, 4>> wall;
  for (std::size_t b = 0; b < draft.boundary.size(); ++b) {
    if (is_wall[b] == 0) continue;
    std::array<Index, 4> key = draft.boundary[b].corners;
    for (const Index v : key) on_wall[v] = 1;
    std::sort(key.begin(), key.end());
    wall.insert(key);
  }
  // With one face of the wall, a block has four points on it; any other touches it with an edge or a point.
  for (const HexPoints& hex : draft.hexes) {
    int faces = 0;
    for (const auto& face : hex_faces) {
      std::array<Index, 4> key{};
      for (int n = 0; n < 4; ++n) key[n] = hex[face[n]];
      std::sort(key.begin(), key.end());
      faces += static_cast<int>(wall.count(key));
    }
    const auto touching = std::count_if(hex.begin(), hex.end(), [&](Index v) { return on_wall[v] != 0; });
    if (faces > 1 || touching != 4 * faces) return true;
  }
  return false;
}

/// Edges off the wall between patches, or where the boundary turns.
std::vector<SharpEdge> sharp_outer_edges(const DrawnBlocks& blocks) {
  constexpr double smooth = 0.5;  // cosine of 60 degrees
  const auto normal = [&](const BoundaryQuad& quad) -> Vec3 {
    const auto& p = blocks.draft.points;
    const auto& c = quad.corners;
    return (p[c[2]] - p[c[0]]).cross(p[c[3]] - p[c[1]]).normalized();
  };
  std::map<Edge, const BoundaryQuad*> seen;
  std::vector<SharpEdge> sharp;
  for (const BoundaryQuad& quad : blocks.draft.boundary) {
    if (blocks.patches[quad.patch].type == PatchType::wall) continue;
    for (int n = 0; n < 4; ++n) {
      const auto [other, first] = seen.try_emplace(edge_of(quad, n), &quad);
      if (!first && (other->second->patch != quad.patch || normal(*other->second).dot(normal(quad)) < smooth))
        sharp.push_back({edge_of(quad, n)[0], edge_of(quad, n)[1]});
    }
  }
  return sharp;
}

}  // namespace

DrawnBlocks sort_out_blocks(const HexView& mesh, bool internal, const std::string& source) {
  constexpr Offset most_blocks = 200000;
  if (mesh.cell_count() > most_blocks) {
    throw input_error(source, 0, fmt::format("has {} cells: too many for blocks", mesh.cell_count()),
                      fmt::format("give a coarse mesh of at most {} hexes, one a block", most_blocks));
  }
  DrawnBlocks blocks;
  blocks.draft.points.assign(mesh.points().begin(), mesh.points().end());
  blocks.draft.hexes.resize(static_cast<std::size_t>(mesh.cell_count()));
  mesh.read_cells(0, blocks.draft.hexes);
  for (const BoundaryPatch& patch : mesh.patches()) {
    const auto number = static_cast<Index>(blocks.patches.size());
    // Inlets and outlets of a duct are faces of its CAD; of a far field they are not.
    const bool opening = patch.type == PatchType::inlet || patch.type == PatchType::outlet;
    blocks.patches.push_back({patch.name, internal && opening ? PatchType::wall : patch.type});
    for (const auto& quad : patch.quads) blocks.draft.boundary.push_back({quad, number});
  }
  const auto type = [&](const BoundaryQuad& quad) { return blocks.patches[quad.patch].type; };
  const auto all_wall = std::all_of(blocks.draft.boundary.begin(), blocks.draft.boundary.end(),
                                    [&](const BoundaryQuad& q) { return type(q) == PatchType::wall; });
  if (all_wall && !internal) find_far_field(blocks, source);
  const auto walls = [&] {
    std::vector<char> is_wall;
    for (const BoundaryQuad& q : blocks.draft.boundary) is_wall.push_back(type(q) == PatchType::wall ? 1 : 0);
    return is_wall;
  };
  std::vector<char> is_wall = walls();
  if (std::find(is_wall.begin(), is_wall.end(), 1) == is_wall.end()) {
    throw input_error(source, 0, "no patch of the blocks is a wall: nothing is fitted to the CAD",
                      "give the patch that lies on the CAD another name than inlet, outlet, farfield or "
                      "symmetry");
  }
  if (needs_layer(blocks.draft, is_wall)) {
    blocks.draft =
        pillow(blocks.draft, std::vector<char>(blocks.draft.hexes.size(), 1), [&](const BoundaryQuad& q) {
          return type(q) == PatchType::wall;
        }).draft;
    blocks.pillowed = true;
    is_wall = walls();
  }
  blocks.wall = cage_of_blocks(blocks.draft, is_wall, true);
  Cage& cage = blocks.wall.cage;
  cage.source = source;
  cage.patch_names.clear();
  std::vector<Index> number(blocks.patches.size(), no_index);
  for (std::size_t f = 0; f < blocks.wall.face_boundary.size(); ++f) {
    const Index patch = blocks.draft.boundary[blocks.wall.face_boundary[f]].patch;
    if (number[patch] == no_index) {
      number[patch] = static_cast<Index>(cage.patch_names.size());
      cage.patch_names.push_back(blocks.patches[patch].name);
    }
    cage.face_patch[f] = number[patch];
  }
  blocks.sharp = sharp_outer_edges(blocks);
  return blocks;
}

}  // namespace flowcage
