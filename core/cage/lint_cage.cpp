#include "core/cage/lint_cage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/error.hpp"
#include "core/mesh/surface_level.hpp"

namespace flowcage {
namespace {

using Severity = LintFinding::Severity;

struct Measured {
  double value = 0;  ///< the larger, the worse
  Vec3 place = Vec3::Zero();
  Index element = no_index;
};

/// Adds a finding for what was measured, the worst first. `message` gets the number and the worst one.
template <typename Message>
void add(LintReport& report, const char* rule, std::vector<Measured> found, const char* remedy,
         const Message& message) {
  if (found.empty()) return;
  std::stable_sort(found.begin(), found.end(),
                   [](const Measured& a, const Measured& b) { return a.value > b.value; });
  LintFinding finding{rule, Severity::warning, message(found.size(), found.front()), remedy, {}};
  for (const Measured& m : found) finding.places.push_back(m.place);
  report.push_back(std::move(finding));
}

bool is_crease(const SurfaceLevel& level, Index e) {
  return level.edge_sharpness[e] >= infinitely_sharp;
}

double length_of(const SurfaceLevel& level, const std::vector<Vec3>& points, Index e) {
  return (points[level.edge_vertices[e][0]] - points[level.edge_vertices[e][1]]).norm();
}

/// Pairs of edges that follow each other along a line through vertex v: opposite ones at a regular vertex,
/// the two of a crease or of the boundary. Across a crease nothing goes on.
std::vector<std::pair<Index, Index>> lines_through(const SurfaceLevel& level, Index v) {
  if (level.vertex_sharpness[v] >= infinitely_sharp) return {};
  const auto ring = level.vertex_edges[v];
  std::vector<Index> creases;
  for (const Index e : ring) {
    if (is_crease(level, e)) creases.push_back(e);
  }
  if (creases.size() == 2) return {{creases[0], creases[1]}};
  if (!creases.empty() || ring.size() != 4) return {};
  return {{ring[0], ring[2]}, {ring[1], ring[3]}};
}

void lint_lengths(const SurfaceLevel& level, const Cage& cage, double limit, LintReport& report) {
  std::vector<Measured> found;
  for (Index v = 0; v < level.vertex_count(); ++v) {
    double worst = 0;
    for (const auto& [e, f] : lines_through(level, v)) {
      const double a = length_of(level, cage.points, e), b = length_of(level, cage.points, f);
      worst = std::max(worst, std::max(a, b) / std::min(a, b));
    }
    if (worst > limit) found.push_back({worst, cage.points[v], v});
  }
  add(report, "edge_lengths", std::move(found),
      "let the lengths of neighbouring edges change gradually: move vertices, or split the long edges",
      [&](std::size_t count, const Measured& worst) {
        return fmt::format(
            "the lengths of neighbouring edges jump at {} vertices by more than a factor {:g} "
            "(the worst by {:.3g}, at vertex {} at {})",
            count, limit, worst.value, worst.element + 1, place(worst.place));
      });
}

void lint_close_vertices(const SurfaceLevel& level, const Cage& cage, double limit, LintReport& report) {
  std::vector<Index> by_x(cage.points.size());
  std::vector<double> scale(cage.points.size(), 0);
  for (Index v = 0; v < level.vertex_count(); ++v) {
    by_x[v] = v;
    for (const Index e : level.vertex_edges[v]) {
      scale[v] += length_of(level, cage.points, e) / level.vertex_edges.row_size(v);
    }
  }
  std::sort(by_x.begin(), by_x.end(), [&](Index a, Index b) {
    return std::pair(cage.points[a].x(), a) < std::pair(cage.points[b].x(), b);
  });
  const double widest = limit * *std::max_element(scale.begin(), scale.end());
  const auto joined = [&](Index a, Index b) {
    const auto ring = level.vertex_edges[a];
    return std::any_of(ring.begin(), ring.end(), [&](Index e) {
      return level.edge_vertices[e][0] + level.edge_vertices[e][1] - a == b;
    });
  };
  std::vector<Measured> found;
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    const Vec3& p = cage.points[by_x[i]];
    for (std::size_t k = i + 1; k < by_x.size() && cage.points[by_x[k]].x() - p.x() <= widest; ++k) {
      const Index a = by_x[i], b = by_x[k];
      const double apart = (cage.points[b] - p).norm() / std::min(scale[a], scale[b]);
      if (apart <= limit && !joined(a, b)) found.push_back({-apart, p, std::min(a, b)});
    }
  }
  add(report, "close_vertices", std::move(found),
      "merge the vertices that belong together (\"merge by distance\" of a modeller)",
      [](std::size_t count, const Measured& worst) {
        return fmt::format(
            "{} pairs of vertices lie almost in one place and no edge joins them (vertex {} at "
            "{}): the cage is slit there",
            count, worst.element + 1, place(worst.place));
      });
}

void lint_faces(const SurfaceLevel& level, const Cage& cage, const CageLintSettings& settings,
                LintReport& report) {
  std::vector<Measured> flat, folded, many;
  for (Index f = 0; f < level.face_count(); ++f) {
    const auto face = level.face_vertices[f];
    const std::size_t n = face.size();
    Vec3 centre = Vec3::Zero(), area = Vec3::Zero();
    double perimeter = 0;
    for (std::size_t i = 0; i < n; ++i) centre += cage.points[face[i]] / static_cast<double>(n);
    std::vector<Vec3> corners;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 &p = cage.points[face[i]], &next = cage.points[face[(i + 1) % n]],
                 &before = cage.points[face[(i + n - 1) % n]];
      area += 0.5 * (p - centre).cross(next - centre);
      perimeter += (next - p).norm();
      corners.push_back((next - p).cross(before - p));
    }
    if (static_cast<Index>(n) > settings.face_corners) many.push_back({static_cast<double>(n), centre, f});
    const double shape = 4 * area.norm() / (perimeter * perimeter);
    if (!(shape > settings.flat_face)) {
      flat.push_back({-shape, centre, f});
      continue;
    }
    double worst = 0;
    for (const Vec3& corner : corners) {
      const double size = corner.norm();
      if (size > 0) worst = std::min(worst, corner.dot(area) / (size * area.norm()));
    }
    if (worst < -0.1) folded.push_back({-worst, centre, f});
  }
  const auto text = [](const char* what) {
    return [what](std::size_t count, const Measured& worst) {
      return fmt::format("{} face{} {} (face {} at {})", count, count > 1 ? "s" : "", what, worst.element + 1,
                         place(worst.place));
    };
  };
  add(report, "flat_face", std::move(flat), "remove the face, or move its vertices apart",
      text("with almost no area"));
  add(report, "folded_face", std::move(folded),
      "move its vertices so that it is convex, or split it into convex faces",
      text("not convex or folded: the surface starts with a fold there"));
  add(report, "face_corners", std::move(many), "split it into quads",
      [](std::size_t count, const Measured& worst) {
        return fmt::format("{} face{} with more corners than the fit resolves well (face {} at {} has {:g})",
                           count, count > 1 ? "s" : "", worst.element + 1, place(worst.place), worst.value);
      });
}

void lint_valence(const SurfaceLevel& level, const Cage& cage, Index limit, LintReport& report) {
  std::vector<Measured> found;
  for (Index v = 0; v < level.vertex_count(); ++v) {
    const Index valence = level.vertex_edges.row_size(v);
    if (valence > limit) found.push_back({static_cast<double>(valence), cage.points[v], v});
  }
  add(report, "valence", std::move(found), "let fewer edges meet: put a ring of quads round the vertex",
      [](std::size_t count, const Measured& worst) {
        return fmt::format("{} vert{} with many edges (vertex {} at {} has {:g})", count,
                           count > 1 ? "ices" : "ex", worst.element + 1, place(worst.place), worst.value);
      });
}

/// The corner of a face at a smooth crease vertex that is alone between the two crease edges.
struct LoneCorner {
  Index vertex = no_index, face = no_index;
};

std::vector<LoneCorner> lone_corners(const SurfaceLevel& level) {
  std::vector<LoneCorner> corners;
  for (Index v = 0; v < level.vertex_count(); ++v) {
    if (level.vertex_sharpness[v] >= infinitely_sharp) continue;
    const auto ring = level.vertex_edges[v];
    const auto faces = level.vertex_faces[v];
    if (ring.size() != faces.size()) continue;  // open: a single face makes a corner by itself
    if (std::count_if(ring.begin(), ring.end(), [&](Index e) { return is_crease(level, e); }) != 2) continue;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (is_crease(level, ring[i]) && is_crease(level, ring[(i + 1) % ring.size()])) {
        corners.push_back({v, faces[i]});
      }
    }
  }
  return corners;
}

/// The cage with a ring of quads inside each of these faces; the inner faces keep the numbers.
Cage inset_faces(const Cage& cage, const std::set<Index>& which) {
  Cage result = cage;
  result.faces = {};
  Csr<Index> rings;
  std::vector<Index> ring_patch;
  for (Index f = 0; f < cage.faces.size(); ++f) {
    const auto face = cage.faces[f];
    if (which.count(f) == 0) {
      result.faces.push_row(face);
      continue;
    }
    const Index n = static_cast<Index>(face.size());
    Vec3 centre = Vec3::Zero();
    for (const Index v : face) centre += cage.points[v] / n;
    std::vector<Index> inner;
    for (const Index v : face) {
      inner.push_back(static_cast<Index>(result.points.size()));
      result.points.push_back(0.5 * (cage.points[v] + centre));
    }
    for (Index i = 0; i < n; ++i) {
      const Index k = (i + 1) % n;
      rings.push_row(std::array{face[i], face[k], inner[k], inner[i]});
      if (!cage.face_patch.empty()) ring_patch.push_back(cage.face_patch[f]);
    }
    result.faces.push_row(inner);
  }
  for (Index r = 0; r < rings.size(); ++r) result.faces.push_row(rings[r]);
  result.face_patch.insert(result.face_patch.end(), ring_patch.begin(), ring_patch.end());
  return result;
}

}  // namespace

LintReport lint_cage_shape(const Cage& cage, const CageLintSettings& settings) {
  const SurfaceLevel level = build_surface_level(cage);
  LintReport report;
  lint_lengths(level, cage, settings.length_ratio, report);
  lint_close_vertices(level, cage, settings.close_vertices, report);
  lint_faces(level, cage, settings, report);
  lint_valence(level, cage, settings.valence, report);
  return report;
}

SplitSectors split_crease_sectors(const Cage& cage, bool mend, std::span<const Index> corners_of_cad) {
  SurfaceLevel level = build_surface_level(cage);
  for (const Index v : corners_of_cad) level.vertex_sharpness[v] = infinitely_sharp;
  const std::vector<LoneCorner> corners = lone_corners(level);
  SplitSectors result{cage, {}};
  if (corners.empty()) return result;
  std::set<Index> faces;
  LintFinding finding{"crease_sector", mend ? Severity::mended : Severity::warning, {}, {}, {}};
  for (const LoneCorner& corner : corners) {
    faces.insert(corner.face);
    finding.places.push_back(cage.points[corner.vertex]);
  }
  finding.message =
      fmt::format("{} crease vert{} with a single face on one side (vertex {} at {})", corners.size(),
                  corners.size() > 1 ? "ices" : "ex", corners[0].vertex + 1, place(finding.places[0]));
  finding.message += mend ? fmt::format(": {} face{} split, a ring of quads inside each", faces.size(),
                                        faces.size() > 1 ? "s were" : " was")
                          : ": its cells degenerate level by level";
  finding.remedy =
      "split the face there, so that two faces meet on each side of the crease, or tag the vertex as a "
      "corner";
  result.findings.push_back(std::move(finding));
  if (mend) result.cage = inset_faces(cage, faces);
  return result;
}

}  // namespace flowcage
