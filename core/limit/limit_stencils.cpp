#include "core/limit/limit_stencils.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/limit/limit_masks.hpp"
#include "core/mesh/mirror.hpp"
#include "core/mesh/stencil_builder.hpp"
#include "core/subdivide/refine.hpp"

namespace flowcage {
namespace {

// Sharpness after `levels` refinements.
double decayed(double sharpness, int levels) {
  return sharpness >= infinitely_sharp ? sharpness : std::max(0.0, sharpness - levels);
}

// The ring of one vertex, refined symbolically until all its faces are quads and all sharpness is none or
// infinite. The ring of a child vertex depends on the parent's ring alone, so one vertex needs no mesh.
class VertexRing {
 public:
  explicit VertexRing(const SurfaceLevel& level) : level_(level) {}

  void visit(Index v) {
    vertex_ = v;
    levels_ = 0;
    edge_sharpness_.clear();
    for (const Index e : level_.vertex_edges[v]) edge_sharpness_.push_back(level_.edge_sharpness[e]);
    for (const Index f : level_.vertex_faces[v]) {
      if (level_.face_vertices.row_size(f) != 4) levels_ = 1;
    }
    wait_for(level_.vertex_sharpness[v]);
    for (const double s : edge_sharpness_) wait_for(s);

    sharp_edges_.clear();
    for (std::size_t i = 0; i < edge_sharpness_.size(); ++i) {
      if (edge_sharpness_[i] >= infinitely_sharp) sharp_edges_.push_back(static_cast<int>(i));
    }
    final_sharpness_ = edge_sharpness_;
    for (double& s : final_sharpness_) s = decayed(s, levels_);
    ring_.rule = vertex_rule(decayed(level_.vertex_sharpness[v], levels_), final_sharpness_);
    ring_.edge_count = static_cast<int>(edge_sharpness_.size());
    ring_.face_count = static_cast<int>(level_.vertex_faces.row_size(v));
    ring_.sharp_edges = sharp_edges_;
  }

  const LimitRing& ring() const { return ring_; }
  Index number() const { return vertex_; }

  // Ends the row that writes `weights` of the last ring in the points of this level. Changes `weights`.
  // `lies_in`: as in StencilWriter::end_row.
  void write(RingWeights& weights, StencilWriter& out, unsigned lies_in = 0) {
    for (int k = levels_ - 1; k >= 0; --k) {
      for (std::size_t i = 0; i < edge_sharpness_.size(); ++i) {
        final_sharpness_[i] = decayed(edge_sharpness_[i], k);
      }
      pull_back_to_centroids(decayed(level_.vertex_sharpness[vertex_], k), final_sharpness_, weights);
      if (k > 0) spread_centroids_of_quads(weights);
    }
    const auto edges = level_.vertex_edges[vertex_];
    const auto faces = level_.vertex_faces[vertex_];
    out.add(vertex_, weights.vertex);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto& ends = level_.edge_vertices[edges[i]];
      out.add(ends[ends[0] == vertex_ ? 1 : 0], weights.edges[i]);
    }
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (weights.faces[i] == 0) continue;
      const auto row = level_.face_vertices[faces[i]];
      if (levels_ == 0) {
        const auto corner = std::find(row.begin(), row.end(), vertex_) - row.begin();
        out.add(row[(corner + 2) % 4], weights.faces[i]);
      } else {
        for (const Index v : row) out.add(v, weights.faces[i] / static_cast<double>(row.size()));
      }
    }
    out.end_row(lies_in);
  }

 private:
  void wait_for(double sharpness) {
    if (sharpness < infinitely_sharp) levels_ = std::max(levels_, static_cast<int>(std::ceil(sharpness)));
  }

  const SurfaceLevel& level_;
  Index vertex_ = 0;
  int levels_ = 0;  // refinements until the mask holds
  LimitRing ring_;
  std::vector<double> edge_sharpness_, final_sharpness_;
  std::vector<int> sharp_edges_;
};

// Masks of smooth vertices by valence: nearly all vertices share a few of them.
class SmoothMasks {
 public:
  struct Masks {
    RingWeights position, u, v;
  };
  const Masks& of(int valence) {
    if (static_cast<std::size_t>(valence) >= masks_.size())
      masks_.resize(static_cast<std::size_t>(valence) + 1);
    std::optional<Masks>& entry = masks_[valence];
    if (!entry) {
      entry.emplace();
      const LimitRing ring{VertexRule::smooth, valence, valence, {}};
      limit_position_mask(ring, entry->position);
      limit_tangent_masks(ring, {0, valence}, entry->u, entry->v);
    }
    return *entry;
  }

 private:
  std::vector<std::optional<Masks>> masks_;
};

// Sectors of the extended level's vertex that have a face of the level itself.
void list_own_sectors(const MirrorExtension& extension, const VertexRing& vertex,
                      std::vector<SmoothSector>& sectors) {
  list_sectors(vertex.ring(), sectors);
  if (extension.planes_of(vertex.number()) == 0) return;
  const auto faces = extension.level().vertex_faces[vertex.number()];
  std::erase_if(sectors, [&](const SmoothSector& sector) {
    for (int k = 0; k < sector.face_count; ++k) {
      if (extension.is_own_face(faces[(sector.first_edge + k) % vertex.ring().edge_count])) return false;
    }
    return true;
  });
}

// Rows of both tangents: of each vertex's first sector or of all its sectors.
TangentStencils tangent_rows(const SurfaceLevel& level, bool all_sectors) {
  const MirrorExtension extension(level);
  auto tables = build_stencil_tables<2>(
      level.vertex_count(), level.vertex_count(),
      [&](Index begin, Index end, std::span<StencilWriter, 2> out) {
        VertexRing vertex(extension.level());
        SmoothMasks smooth;
        RingWeights u, v;
        std::vector<SmoothSector> sectors;
        for (Index i = begin; i < end; ++i) {
          vertex.visit(i);
          list_own_sectors(extension, vertex, sectors);
          if (!all_sectors) sectors.resize(1);
          for (const SmoothSector& sector : sectors) {
            if (vertex.ring().rule == VertexRule::smooth) {
              u = smooth.of(sector.face_count).u;
              v = smooth.of(sector.face_count).v;
            } else {
              limit_tangent_masks(vertex.ring(), sector, u, v);
            }
            vertex.write(u, out[0]);
            vertex.write(v, out[1]);
          }
        }
      },
      extension.fold());
  for (StencilTable& table : tables) table.of_vectors = true;
  return {std::move(tables[0]), std::move(tables[1])};
}

}  // namespace

StencilTable limit_stencils(const SurfaceLevel& level) {
  const MirrorExtension extension(level);
  return build_stencils(
      level.vertex_count(), level.vertex_count(),
      [&](Index begin, Index end, StencilWriter& out) {
        VertexRing vertex(extension.level());
        SmoothMasks smooth;
        RingWeights position;
        for (Index v = begin; v < end; ++v) {
          vertex.visit(v);
          if (vertex.ring().rule == VertexRule::smooth) {
            position = smooth.of(vertex.ring().edge_count).position;
          } else {
            limit_position_mask(vertex.ring(), position);
          }
          vertex.write(position, out, extension.planes_of(v));
        }
      },
      extension.fold());
}

TangentStencils tangent_stencils(const SurfaceLevel& level) {
  return tangent_rows(level, false);
}

SectorTangents sector_tangent_stencils(const SurfaceLevel& level) {
  SectorTangents result;
  result.first_sector.push_back(0);
  const MirrorExtension extension(level);
  VertexRing vertex(extension.level());
  std::vector<SmoothSector> sectors;
  for (Index v = 0; v < level.vertex_count(); ++v) {
    vertex.visit(v);
    list_own_sectors(extension, vertex, sectors);
    const auto faces = extension.level().vertex_faces[v];
    for (const SmoothSector& sector : sectors) {
      for (int k = 0; k < sector.face_count; ++k) {
        const Index f = faces[(sector.first_edge + k) % vertex.ring().edge_count];
        if (extension.is_own_face(f)) result.faces.values.push_back(f);
      }
      result.faces.offsets.push_back(static_cast<Offset>(result.faces.values.size()));
    }
    result.first_sector.push_back(result.faces.size());
  }
  TangentStencils tangents = tangent_rows(level, true);
  result.u = std::move(tangents.u);
  result.v = std::move(tangents.v);
  return result;
}

LimitSamples oversampled_limit_stencils(const SurfaceLevel& level) {
  const SurfaceLevel child = build_child_level(level);
  StencilTable refinement = refinement_stencils(level);
  StencilTable position = compose(limit_stencils(child), refinement);
  return {std::move(position), std::move(refinement), tangent_stencils(child)};
}

std::vector<Vec3> sample_normals(const LimitSamples& samples, std::span<const Vec3> points) {
  const std::vector<Vec3> finer = apply_stencils(samples.refinement, points);
  std::vector<Vec3> normals = apply_stencils(samples.tangents.u, finer);
  const std::vector<Vec3> v = apply_stencils(samples.tangents.v, finer);
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = normals[i].cross(v[i]);
  return normals;
}

std::vector<Vec3> oversampled_limit_points(const SurfaceLevel& level, std::span<const Vec3> points) {
  return apply_stencils(limit_stencils(build_child_level(level)),
                        apply_stencils(refinement_stencils(level), points));
}

}  // namespace flowcage
