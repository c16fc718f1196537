#include "core/volume/wall_normals.hpp"

#include <cmath>

#include "core/base/parallel.hpp"
#include "core/volume/corner_fan.hpp"
#include "core/volume/wall_columns.hpp"

namespace flowcage {
namespace {

class LineTurner {
 public:
  LineTurner(BlockMesh& mesh, const WallBlocks& blocks, const NormalSettings& settings)
      : mesh_(mesh), blocks_(blocks), settings_(settings), columns_(wall_columns(mesh, blocks)) {
    const auto n = static_cast<Offset>(columns_.lines.size());
    start_.assign(mesh.points().begin(), mesh.points().end());
    turn_.assign(n, Vec3::Zero());
    Box3 box;
    for (const WallLine& line : columns_.lines) box.extend(start_[point(line, 0)]);
    diagonal_ = box.diagonal().norm();
    find_turns();
  }

  NormalReport run() {
    NormalReport report;
    std::tie(report.min_cosine_before, report.mean_cosine_before) = cosines();
    const std::vector<float> before = column_values(mesh_, blocks_, columns_);
    std::vector<float> now = before;
    const double full = settings_.reach * diagonal_;
    std::vector<double> reach(columns_.lines.size(), full);
    std::vector<double> weight(columns_.lines.size(), 1);
    std::vector<double> placed_reach, placed_weight;  // that the points are placed with
    std::vector<char> moved(columns_.lines.size(), 1);
    bool settled = false;
    for (; report.passes < settings_.max_passes && !settled; ++report.passes) {
      if (report.passes > 0) {
        for (std::size_t l = 0; l < moved.size(); ++l) {
          moved[l] = reach[l] != placed_reach[l] || weight[l] != placed_weight[l] ? 1 : 0;
        }
      }
      place(weight, reach, moved);
      placed_reach = reach;
      placed_weight = weight;
      update_column_values(mesh_, blocks_, columns_, moved, now);
      const std::vector<char> bad = bad_lines(before, now);
      settled = std::find(bad.begin(), bad.end(), 1) == bad.end();
      if (settled) break;
      for (std::size_t l = 0; l < bad.size(); ++l) {
        if (bad[l] == 0) continue;
        // First nearer to the wall; where nothing is left of that, less.
        const bool out_of_reach = reach[l] < 2 * first_cell_[l];
        if (out_of_reach) weight[l] = report.passes < settings_.max_passes * 3 / 4 ? 0.67 * weight[l] : 0;
        reach[l] = std::max(0.6 * reach[l], first_cell_[l]);
      }
      bound_slope(reach, [](Index, Index) { return 0.5; });
      bound_slope(weight, [&](Index a, Index b) { return 0.5 / std::max(reach[a], reach[b]); });
    }
    if (!settled) {  // the lines as they were
      std::fill(weight.begin(), weight.end(), 0.0);
      place(weight, reach, std::vector<char>(columns_.lines.size(), 1));
    }
    flatten_symmetry(mesh_, blocks_);
    for (std::size_t l = 0; l < reach.size(); ++l)
      report.mean_reach += weight[l] * reach[l] / (static_cast<double>(reach.size()) * diagonal_);
    std::tie(report.min_cosine, report.mean_cosine) = cosines();
    return report;
  }

 private:
  Index point(const WallLine& line, Index k) const { return line_point(mesh_, blocks_, line, k); }

  void find_turns() {
    normal_ = line_normals(mesh_, blocks_, columns_);
    for (std::size_t l = 0; l < normal_.size(); ++l) {
      const Vec3 along = start_[point(columns_.lines[l], 1)] - start_[point(columns_.lines[l], 0)];
      first_cell_.push_back(along.norm());
      if (columns_.rim[l] != 0) continue;  // blocks beside the wall's share it
      if (normal_[l].norm() > 0 && along.norm() > 0) turn_[l] = normal_[l] - along.normalized();
    }
  }

  /// Only the lines to be moved.
  void place(const std::vector<double>& weight, const std::vector<double>& reach,
             const std::vector<char>& moved) {
    std::vector<Vec3>& points = mesh_.mutable_points();
    parallel_for(static_cast<Offset>(columns_.lines.size()), 64, [&](Offset begin, Offset end) {
      for (Offset l = begin; l < end; ++l) {
        if (moved[l] == 0) continue;
        const PointRow row = line_points(mesh_, blocks_, columns_.lines[l]);
        double length = 0;
        for (Index k = 1; k <= columns_.layers; ++k) length += (start_[row[k]] - start_[row[k - 1]]).norm();
        double r = 0;
        for (Index k = 1; k < columns_.layers; ++k) {
          const Index at = row[k];
          r += (start_[at] - start_[row[k - 1]]).norm();
          const double ratio = r / reach[l];
          points[at] = start_[at] + weight[l] * r / (1 + ratio * ratio) * (1 - r / length) * turn_[l];
        }
      }
    });
  }

  std::vector<char> bad_lines(const std::vector<float>& before, const std::vector<float>& now) const {
    const std::size_t faces = columns_.faces.size();
    std::vector<char> bad_face(faces, 0);
    parallel_for(static_cast<Offset>(faces), 256, [&](Offset begin, Offset end) {
      for (Index k = 0; k < columns_.layers; ++k) {
        for (Offset f = begin; f < end; ++f) {
          // An inverted cell may stay as it is, not get worse.
          const std::size_t n = f + faces * k;
          const double was = before[n];
          const double least = std::min(settings_.good_enough, was > 0 ? settings_.keep * was : was);
          if (now[n] < least) bad_face[f] = 1;
        }
      }
    });
    std::vector<char> bad(columns_.lines.size(), 0);
    for (std::size_t f = 0; f < faces; ++f) {
      if (bad_face[f] == 0) continue;
      for (const Index l : columns_.faces[f]) bad[l] = 1;
    }
    return bad;
  }

  /// Lowers values until neighbours differ by no more than slope times their distance. A point moves by at
  /// most half of weight times reach, so with slopes of 0.5 (of weights: over the reach) neighbouring lines
  /// do not run into each other.
  template <typename Slope>
  void bound_slope(std::vector<double>& value, const Slope& slope) const {
    constexpr int max_sweeps = 200;
    bool changed = true;
    for (int sweep = 0; sweep < max_sweeps && changed; ++sweep) {
      changed = false;
      const auto relax = [&](const std::array<Index, 2>& edge) {
        for (int side = 0; side < 2; ++side) {
          const Index a = edge[side];
          const Index b = edge[1 - side];
          const double distance =
              (start_[point(columns_.lines[a], 0)] - start_[point(columns_.lines[b], 0)]).norm();
          const double bound = value[b] + slope(a, b) * distance;
          if (value[a] > bound * (1 + 1e-12)) {
            value[a] = bound;
            changed = true;
          }
        }
      };
      if (sweep % 2 == 0) {
        for (const auto& edge : columns_.edges) relax(edge);
      } else {
        for (auto edge = columns_.edges.rbegin(); edge != columns_.edges.rend(); ++edge) relax(*edge);
      }
    }
  }

  std::pair<double, double> cosines() const {
    double least = 1;
    double sum = 0;
    for (std::size_t l = 0; l < columns_.lines.size(); ++l) {
      const WallLine& line = columns_.lines[l];
      const Vec3 along = mesh_.points()[point(line, 1)] - mesh_.points()[point(line, 0)];
      const double cosine = along.normalized().dot(normal_[l]);
      least = std::min(least, cosine);
      sum += cosine;
    }
    return {least, sum / static_cast<double>(columns_.lines.size())};
  }

  BlockMesh& mesh_;
  const WallBlocks& blocks_;
  const NormalSettings& settings_;
  WallColumns columns_;
  double diagonal_ = 1;
  std::vector<Vec3> start_;  ///< all points as they were
  std::vector<Vec3> turn_;   ///< #lines, n - t
  std::vector<Vec3> normal_;
  std::vector<double> first_cell_;  ///< #lines, lengths
};

}  // namespace

std::vector<Vec3> line_normals(const BlockMesh& mesh, const WallBlocks& blocks, const WallColumns& columns) {
  const auto foot = [&](Index l) -> const Vec3& {
    return mesh.points()[line_point(mesh, blocks, columns.lines[l], 0)];
  };
  // By line; neighbours are told by their lines' numbers.
  std::vector<std::vector<FanCorner>> fans(columns.lines.size());
  for (const auto& face : columns.faces) {
    for (int c = 0; c < 4; ++c) {
      const std::array<Vec3, 3> p{foot(face[c]), foot(face[(c + 1) % 4]), foot(face[(c + 3) % 4])};
      FanCorner corner = fan_corner(p, 0, 1, 2);
      corner.after = face[(c + 1) % 4];
      corner.before = face[(c + 3) % 4];
      if (corner.normal.norm() > 0) fans[face[c]].push_back(corner);
    }
  }
  std::vector<Vec3> out(columns.lines.size(), Vec3::Zero());
  for (std::size_t l = 0; l < out.size(); ++l) {
    const std::vector<FanCorner>& fan = fans[l];
    if (fan.empty()) continue;
    Vec3 mirror = Vec3::Zero();
    if (blocks.symmetry && std::abs(blocks.symmetry->distance(foot(static_cast<Index>(l)))) == 0) {
      mirror = blocks.symmetry->normal;
    }
    const std::vector<double> sines = best_sines(fan);
    std::vector<Vec3> hull;
    for (std::size_t i = 0; i < fan.size(); ++i) {
      hull.push_back(sines[i] * (fan[i].normal - mirror * mirror.dot(fan[i].normal)));
    }
    Vec3 normal = nearest_in_hull(hull);
    if (normal.norm() < 1e-3) continue;  // no direction sees all of the wall's faces there
    normal.normalize();
    out[l] = normal;
  }
  return out;
}

NormalReport turn_lines_to_wall(BlockMesh& mesh, const WallBlocks& blocks, const NormalSettings& settings) {
  return LineTurner(mesh, blocks, settings).run();
}

}  // namespace flowcage
