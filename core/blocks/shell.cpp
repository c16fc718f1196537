#include "core/blocks/shell.hpp"

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/blocks/enclosure.hpp"
#include "core/blocks/match_polyhedra.hpp"
#include "core/mesh/hex_numbering.hpp"
#include "core/subdivide/refine.hpp"

namespace flowcage {
namespace {

std::string name_or(const Cage& cage, const char* what) {
  return cage.source.empty() ? what : cage.source;
}

std::string counts(const SurfaceLevel& s) {
  const Topology t = topology_of(s);
  return fmt::format("{} vertices, {} faces, genus {}, {} boundary loops", s.vertex_count(), s.face_count(),
                     t.genus, t.boundary_loops);
}

bool all_quads(const SurfaceLevel& s) {
  for (Index f = 0; f < s.face_count(); ++f) {
    if (s.face_vertices.row_size(f) != 4) return false;
  }
  return true;
}

Cage turned_inside_out(Cage cage) {
  for (Index f = 0; f < cage.faces.size(); ++f) {
    auto row = cage.faces[f];
    std::reverse(row.begin(), row.end());
  }
  return cage;
}

double enclosed_volume(const SurfaceLevel& level, std::span<const Vec3> points,
                       const std::optional<SymmetryPlane>& plane) {
  return signed_volume(closed_triangles({level, points}, plane));
}

void require_one_component(const SurfaceLevel& level, const std::string& source) {
  const Topology t = topology_of(level);
  if (t.components != 1) {
    throw input_error(
        source, 0,
        fmt::format("{} separate parts; a shell of blocks needs one connected surface", t.components),
        "mesh one body at a time, or join the parts");
  }
}

void flatten_rim(const SurfaceLevel& level, const std::optional<SymmetryPlane>& plane,
                 std::vector<Vec3>& points) {
  if (!plane) return;
  for (const Index v : boundary_vertices(level)) plane->flatten(points[v]);
}

/// Side i of block f's foot (corners i, i+1) is this face of the hex.
constexpr std::array<int, 4> hex_face_over_side{2, 1, 3, 0};

}  // namespace

ShellParts prepare_inner(const Cage& cage) {
  const std::string source = name_or(cage, "cage");
  ShellParts parts;
  parts.inner = build_surface_level(cage);
  parts.inner_points = cage.points;
  parts.patch_names = cage.patch_names;
  parts.source = source;
  require_one_component(parts.inner, source);
  parts.symmetry = find_symmetry_plane(parts.inner, cage.points, source);
  flatten_rim(parts.inner, parts.symmetry, parts.inner_points);
  const double volume = enclosed_volume(parts.inner, parts.inner_points, parts.symmetry);
  if (!(volume > 0)) {
    throw input_error(source, 0, fmt::format("the cage is inside out (it encloses {:.4g} m^3)", volume),
                      "reverse its faces: they are counter-clockwise seen from the fluid");
  }
  return parts;
}

void make_quads(ShellParts& parts) {
  if (all_quads(parts.inner)) return;
  parts.inner_points = apply_stencils(refinement_stencils(parts.inner), parts.inner_points);
  parts.inner = build_child_level(parts.inner);
  parts.cage_level = 1;
  flatten_rim(parts.inner, parts.symmetry, parts.inner_points);
}

Shell join(ShellParts parts) {
  const SurfaceLevel& s = parts.inner;
  const Index n = s.vertex_count();
  std::vector<HexComplex::Patch> patches;
  std::vector<Index> patch_of_name(std::max<std::size_t>(1, parts.patch_names.size()), no_index);
  const auto add_patch = [&](const std::string& name, PatchType type) {
    for (const HexComplex::Patch& p : patches) {
      if (p.name == name) {
        throw input_error(
            parts.source, 0, fmt::format("the name \"{}\" stands for two patches", name),
            "\"farfield\" and \"symmetry\" are the names of the outer boundary and of the symmetry "
            "plane, \"wall\" that of faces without a group: rename the cage's group");
      }
    }
    patches.push_back({name, type});
    return static_cast<Index>(patches.size()) - 1;
  };
  std::vector<HexPoints> hexes;
  std::vector<BoundaryQuad> boundary;
  std::vector<char> used(patch_of_name.size(), 0);
  for (Index f = 0; f < s.face_count(); ++f) used[s.face_patch.empty() ? 0 : s.face_patch[f]] = 1;
  for (std::size_t p = 0; p < used.size(); ++p) {
    if (used[p] == 0) continue;
    const bool unnamed = parts.patch_names.empty() || parts.patch_names[p].empty();
    patch_of_name[p] = add_patch(unnamed ? "wall" : parts.patch_names[p], PatchType::wall);
  }
  const Index farfield = add_patch("farfield", PatchType::farfield);
  const Index symmetry = parts.symmetry ? add_patch("symmetry", PatchType::symmetry) : no_index;
  for (Index f = 0; f < s.face_count(); ++f) {
    const auto v = s.face_vertices[f];
    const HexPoints hex{v[0], v[1], v[2], v[3], v[0] + n, v[1] + n, v[2] + n, v[3] + n};
    hexes.push_back(hex);
    const auto add = [&](int face, Index patch) {
      const auto& c = hex_faces[face];
      boundary.push_back({{hex[c[0]], hex[c[1]], hex[c[2]], hex[c[3]]}, patch});
    };
    add(4, patch_of_name[s.face_patch.empty() ? 0 : s.face_patch[f]]);
    add(5, farfield);
    for (int side = 0; side < 4; ++side) {
      if (s.is_boundary_edge(s.face_edges[f][side])) add(hex_face_over_side[side], symmetry);
    }
  }
  std::vector<Vec3> points = parts.inner_points;
  points.insert(points.end(), parts.outer_points.begin(), parts.outer_points.end());
  HexComplex complex =
      build_hex_complex(std::move(points), std::move(hexes), std::move(patches), boundary, {});

  Shell shell;
  shell.outer = s;
  if (!parts.outer_edge_sharpness.empty()) shell.outer.edge_sharpness = parts.outer_edge_sharpness;
  if (!parts.outer_vertex_sharpness.empty()) shell.outer.vertex_sharpness = parts.outer_vertex_sharpness;
  for (Index e = 0; e < s.edge_count(); ++e) {
    if (s.is_boundary_edge(e)) continue;
    if (parts.outer_edge_sharpness.empty()) shell.outer.edge_sharpness[e] = 0;
  }
  for (Index v = 0; v < n && parts.outer_vertex_sharpness.empty(); ++v) {
    const bool rim_corner = s.vertex_faces.row_size(v) == 1;
    shell.outer.vertex_sharpness[v] = rim_corner ? infinitely_sharp : 0;
  }
  for (Index f = 0; f < s.face_count(); ++f) {
    for (int side = 0; side < 4; ++side) {
      const Index e = s.face_edges[f][side];
      // Along i at (j,k): edges 0 and 1; along j at (i,k): 5 and 4; the outer ones are 2 further on.
      constexpr std::array<int, 4> over_side{0, 5, 1, 4};
      complex.edge_sharpness[complex.hex_edges[f][over_side[side]]] = s.edge_sharpness[e];
      complex.edge_sharpness[complex.hex_edges[f][over_side[side] + 2]] = shell.outer.edge_sharpness[e];
    }
  }
  for (Index v = 0; v < n; ++v) {
    complex.corner_sharpness[v] = s.vertex_sharpness[v];
    complex.corner_sharpness[v + n] = shell.outer.vertex_sharpness[v];
  }
  shell.k_chord = complex.edge_chord[complex.hex_edges[0][8]];
  shell.complex = std::make_shared<const HexComplex>(std::move(complex));
  for (Index f = 0; f < s.face_count(); ++f) shell.seats.push_back({f});
  shell.wall = std::move(parts.inner);
  shell.wall_points = std::move(parts.inner_points);
  shell.outer_points = std::move(parts.outer_points);
  shell.cage_level = parts.cage_level;
  shell.symmetry = parts.symmetry;
  return shell;
}

Shell build_shell(const Cage& inner, const Cage& outer) {
  const std::string outer_name = name_or(outer, "outer polyhedron");
  ShellParts parts = prepare_inner(inner);

  Cage outside = outer;
  SurfaceLevel around = build_surface_level(outside);
  require_one_component(around, outer_name);
  const Topology t_in = topology_of(parts.inner);
  const Topology t_out = topology_of(around);
  const std::string both =
      fmt::format("{}: {}; {}: {}", parts.source, counts(parts.inner), outer_name, counts(around));
  const char* remedy =
      "draw the outer polyhedron as a copy of the cage's faces around it, in any numbering, or leave it "
      "out and use a far field (--farfield)";
  if (t_in.genus != t_out.genus || t_in.boundary_loops != t_out.boundary_loops ||
      parts.inner.vertex_count() != around.vertex_count() ||
      parts.inner.face_count() != around.face_count()) {
    throw input_error(outer_name, 0, fmt::format("not of the cage's topology ({})", both), remedy);
  }
  if (parts.symmetry) {
    const auto plane = find_symmetry_plane(around, outside.points, outer_name);
    Box3 box;
    for (const Vec3& p : outside.points) box.extend(p);
    double worst = 0;
    for (const Index v : boundary_vertices(around)) {
      worst = std::max(worst, std::abs(parts.symmetry->distance(outside.points[v])));
    }
    if (worst > 1e-3 * box.diagonal().norm() || plane->normal.dot(parts.symmetry->normal) < 0.99) {
      throw input_error(
          outer_name, 0,
          fmt::format("its open boundary does not lie in the cage's symmetry plane (up to {:.4g} m off)",
                      worst),
          "put the boundaries of both polyhedra into one plane, both bodies on the same side");
    }
    flatten_rim(around, parts.symmetry, outside.points);
  }
  if (enclosed_volume(around, outside.points, parts.symmetry) < 0) {
    outside = turned_inside_out(std::move(outside));
    around = build_surface_level(outside);
  }
  const std::vector<Index> image =
      match_vertices({parts.inner, parts.inner_points}, {around, outside.points});
  if (image.empty()) {
    throw input_error(
        outer_name, 0,
        fmt::format("its faces are connected differently from the cage's, although the counts agree ({})",
                    both),
        remedy);
  }
  // The outer surface in the cage's numbering, with its own creases and corners.
  std::vector<Index> preimage(image.size());
  parts.outer_points.resize(image.size());
  for (std::size_t v = 0; v < image.size(); ++v) {
    preimage[image[v]] = static_cast<Index>(v);
    parts.outer_points[v] = outside.points[image[v]];
  }
  if (const auto defect = enclosure_defect({parts.inner, parts.inner_points},
                                           {parts.inner, parts.outer_points}, parts.symmetry)) {
    throw input_error(
        outer_name, 0, fmt::format("the outer polyhedron does not enclose the cage: {}", *defect),
        "draw it around the cage at a distance of some of the body's lengths; check its unit (--cage-unit)");
  }
  SurfaceLevel outer_level = parts.inner;
  for (Index e = 0; e < around.edge_count(); ++e) {
    const Index a = preimage[around.edge_vertices[e][0]];
    const Index b = preimage[around.edge_vertices[e][1]];
    for (const Index mine : outer_level.vertex_edges[a]) {
      const auto& ends = outer_level.edge_vertices[mine];
      if (ends[0] == b || ends[1] == b) outer_level.edge_sharpness[mine] = around.edge_sharpness[e];
    }
  }
  for (Index v = 0; v < outer_level.vertex_count(); ++v) {
    outer_level.vertex_sharpness[v] = around.vertex_sharpness[image[v]];
  }
  if (!all_quads(parts.inner)) {
    parts.outer_points = apply_stencils(refinement_stencils(outer_level), parts.outer_points);
    outer_level = build_child_level(outer_level);
    flatten_rim(outer_level, parts.symmetry, parts.outer_points);
    make_quads(parts);
  }
  parts.outer_edge_sharpness = outer_level.edge_sharpness;
  parts.outer_vertex_sharpness = outer_level.vertex_sharpness;
  return join(std::move(parts));
}

BlockMesh start_volume(const Shell& shell, std::span<const Vec3> inner_points, Index layers) {
  std::vector<Index> divisions(shell.complex->chord_count, 1);
  divisions[shell.k_chord] = layers;
  std::vector<Vec3> points(BlockMesh::point_count(*shell.complex, divisions));
  BlockMesh mesh(shell.complex, divisions, std::move(points));
  std::vector<Vec3>& out = mesh.mutable_points();
  for (Index f = 0; f < shell.wall.face_count(); ++f) {
    for (int c = 0; c < 4; ++c) {
      const Index v = shell.wall.face_vertices[f][c];
      Vec3 from = inner_points[v];
      if (shell.symmetry && shell.wall.vertex_faces.row_size(v) < shell.wall.vertex_edges.row_size(v)) {
        shell.symmetry->flatten(from);
      }
      const Vec3& to = shell.outer_points[v];
      const auto& ij = hex_corner_ijk[c];
      for (Index k = 0; k <= layers; ++k) {
        out[mesh.point_number(f, ij[0], ij[1], k)] =
            k == layers ? to : Vec3(from + (to - from) * (static_cast<double>(k) / layers));
      }
    }
  }
  return mesh;
}

}  // namespace flowcage
