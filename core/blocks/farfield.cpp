#include "core/blocks/farfield.hpp"

#include <fmt/format.h>

#include "core/base/error.hpp"
#include "core/blocks/box_edges.hpp"
#include "core/blocks/spherical_embedding.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/subdivide/refine.hpp"

namespace flowcage {
namespace {

OuterShape outer_shape(const FarField& settings, const Box3& body, const ShellParts& parts) {
  OuterShape shape;
  shape.kind = settings.kind;
  shape.centre = body.center();
  if (parts.symmetry) {
    const SymmetryPlane& plane = *parts.symmetry;
    plane.flatten(shape.centre);
    if (plane.axis == no_index) {
      // One axis across the plane; the first one, downstream, in it.
      const Vec3 along = Vec3::UnitX() - plane.normal * plane.normal.x();
      shape.axes.col(0) = along.norm() > 0.1 ? Vec3(along.normalized()) : plane.normal.unitOrthogonal();
      shape.axes.col(1) = plane.normal;
      shape.axes.col(2) = shape.axes.col(0).cross(shape.axes.col(1));
    }
  }
  const double length = body.sizes().maxCoeff();
  shape.radius = settings.body_lengths * length;
  double reach = 0;  // of the body, in the shape's own measure
  for (const Vec3& p : parts.inner_points) reach = std::max(reach, shape.reach(p));
  if (!(shape.radius > 1.2 * reach)) {
    throw Error(
        ErrorKind::usage,
        fmt::format(
            "a far field of {:.3g} body lengths ({:.4g} m) does not clear the body, which reaches {:.4g} m "
            "from its centre",
            settings.body_lengths, shape.radius, reach),
        fmt::format("use --farfield-size {:.2g} or more; 20 is usual", std::max(1.5 * reach / length, 2.0)));
  }
  return shape;
}

std::vector<Vec3> corner_normals(const ShellParts& parts) {
  std::vector<Vec3> normals;
  for (Index f = 0; f < parts.inner.face_count(); ++f) {
    const auto v = parts.inner.face_vertices[f];
    for (int c = 0; c < 4; ++c) {
      const Vec3& p = parts.inner_points[v[c]];
      normals.push_back((parts.inner_points[v[(c + 1) % 4]] - p)
                            .cross(parts.inner_points[v[(c + 3) % 4]] - p)
                            .normalized());
    }
  }
  return normals;
}

}  // namespace

Shell build_farfield_shell(const Cage& cage, const FarField& settings, const Box3& body) {
  ShellParts parts = prepare_inner(cage);
  const Topology topology = topology_of(parts.inner);
  if (topology.genus != 0) {
    throw input_error(
        parts.source, 0,
        fmt::format("the cage has genus {} (it has {}); a sphere or box far field has none", topology.genus,
                    topology.genus == 1 ? "a hole through it" : "holes through it"),
        "draw an outer polyhedron of the same genus around it (--outer)");
  }
  if (topology.boundary_loops > 1) {
    throw input_error(parts.source, 0,
                      fmt::format("the cage is open along {} loops; a far field can be grown from one",
                                  topology.boundary_loops),
                      "draw an outer polyhedron with the same openings (--outer), or close the others");
  }
  make_quads(parts);
  Box3 size = body;
  if (size.isEmpty()) {
    for (const Vec3& p : cage.points) size.extend(p);
  }
  const OuterShape shape = outer_shape(settings, size, parts);
  const SphericalEmbedding map =
      embed_on_sphere({parts.inner, parts.inner_points}, parts.symmetry, parts.source);
  bool sharp = false;
  if (shape.kind == OuterShape::Kind::box) {
    if (auto layout =
            lay_out_on_box(parts.inner, map.directions, shape, parts.symmetry, corner_normals(parts))) {
      parts.outer_points = std::move(layout->points);
      parts.outer_edge_sharpness = std::move(layout->edge_sharpness);
      parts.outer_vertex_sharpness = std::move(layout->vertex_sharpness);
      sharp = true;
    }
  }
  if (parts.outer_points.empty()) {
    for (const Vec3& d : map.directions) parts.outer_points.push_back(shape.project(shape.centre + d));
  }
  for (const Index v : boundary_vertices(parts.inner)) parts.symmetry->flatten(parts.outer_points[v]);
  Shell shell = join(std::move(parts));
  shell.outer_shape = shape;
  shell.box_edges_sharp = sharp;
  return shell;
}

std::vector<Vec3> outer_points(const Shell& shell, int depth, bool limit) {
  SurfaceLevel level = shell.outer;
  std::vector<Vec3> points = shell.outer_points;
  for (int d = 0; d < depth; ++d) {
    points = apply_stencils(refinement_stencils(level), points);
    level = build_child_level(level);
    if (shell.outer_shape) {
      for (Vec3& p : points) p = shell.outer_shape->project(p);
    }
  }
  if (limit && !shell.outer_shape) points = apply_stencils(limit_stencils(level), points);
  if (shell.symmetry) {
    for (const Index v : boundary_vertices(level)) shell.symmetry->flatten(points[v]);
  }
  return points;
}

void project_outer(BlockMesh& mesh, const Shell& shell) {
  if (!shell.outer_shape) return;
  for (const BoundaryPatch& patch : mesh.patches()) {
    if (patch.type != PatchType::farfield) continue;
    for (const auto& quad : patch.quads) {
      for (const Index p : quad) mesh.mutable_points()[p] = shell.outer_shape->project(mesh.points()[p]);
    }
  }
}

}  // namespace flowcage
