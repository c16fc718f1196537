#include "core/blocks/wall_features.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/error.hpp"
#include "core/blocks/closest_triangle.hpp"
#include "core/project/box_tree.hpp"

namespace flowcage {
namespace {

std::array<Index, 2> ordered(Index a, Index b) {
  return {std::min(a, b), std::max(a, b)};
}

const BorderPoint* nearest_border(const std::vector<BorderPoint>& border, const Vec3& p) {
  const BorderPoint* best = nullptr;
  double least = 1e300;
  for (const BorderPoint& b : border) {
    const double squared = (b.mapped - p).squaredNorm();
    if (squared >= least) continue;
    least = squared;
    best = &b;
  }
  return best;
}

/// Places of wall vertices on the CAD, by the charts that meet there.
class Places {
 public:
  Places(const LabelledWall& labelled, const SurfaceCharts& charts, const ChartBorders& borders)
      : labelled_(labelled), borders_(borders), of_chart_(charts.charts.size()) {
    for (Index t = 0; t < static_cast<Index>(labelled.triangle_chart.size()); ++t) {
      if (labelled.triangle_chart[t] != no_index) of_chart_[labelled.triangle_chart[t]].push_back(t);
    }
    for (const std::vector<Index>& triangles : of_chart_) {
      std::vector<Box3> boxes;
      for (const Index t : triangles) {
        Box3 box;
        for (const Index v : labelled.body.triangles[t]) box.extend(labelled.mapped[v]);
        boxes.push_back(box);
      }
      trees_.push_back(build_box_tree(boxes));
    }
  }

  Vec3 of(const Vec3& p, const std::set<Index>& charts) const {
    if (charts.size() > 2) {
      const ChartBorders::Corner* best = nullptr;
      double least = 1e300;
      std::size_t most = 2;
      for (const ChartBorders::Corner& corner : borders_.corners) {
        const auto common = static_cast<std::size_t>(std::count_if(
            corner.charts.begin(), corner.charts.end(), [&](Index c) { return charts.count(c) > 0; }));
        const double squared = (corner.mapped - p).squaredNorm();
        if (common < most + (most == 2 ? 1 : 0) || (common == most && squared >= least)) continue;
        most = common;
        least = squared;
        best = &corner;
      }
      if (best != nullptr) return best->position;
    }
    if (charts.size() > 1) {
      const BorderPoint* best = nullptr;
      for (const Index a : charts) {
        for (const Index b : charts) {
          const auto found = a < b ? borders_.between.find({a, b}) : borders_.between.end();
          if (found == borders_.between.end()) continue;
          const BorderPoint* near = nearest_border(found->second, p);
          if (best == nullptr || (near->mapped - p).squaredNorm() < (best->mapped - p).squaredNorm())
            best = near;
        }
      }
      if (best != nullptr) return best->position;
    }
    Vec3 place = p;
    double least = 1e300;
    for (const Index c : charts) {
      const auto& [t, w, squared] = nearest(p, c);
      if (squared >= least) continue;
      least = squared;
      const auto& v = labelled_.body.triangles[t];
      const auto& x = labelled_.body.points;
      place = w[0] * x[v[0]] + w[1] * x[v[1]] + w[2] * x[v[2]];
    }
    return place;
  }

  /// The triangle of the target's tessellation nearest to p in a chart.
  Index triangle(const Vec3& p, Index chart) const {
    return labelled_.body.parent[nearest(p, chart).triangle];
  }

 private:
  struct Nearest {
    Index triangle = no_index;  ///< of the body
    Vec3 weights = Vec3::Zero();
    double squared = 1e300;
  };
  Nearest nearest(const Vec3& p, Index chart) const {
    Nearest best;
    const auto& m = labelled_.mapped;
    visit_near(
        trees_[chart], p, [&] { return std::sqrt(best.squared); },
        [&](Index n) {
          const Index t = of_chart_[chart][n];
          const auto& v = labelled_.body.triangles[t];
          const Vec3 w = nearest_barycentric(p, m[v[0]], m[v[1]], m[v[2]]);
          const double squared = (w[0] * m[v[0]] + w[1] * m[v[1]] + w[2] * m[v[2]] - p).squaredNorm();
          if (squared < best.squared) best = {t, w, squared};
        });
    return best;
  }

  const LabelledWall& labelled_;
  const ChartBorders& borders_;
  std::vector<std::vector<Index>> of_chart_;
  std::vector<BoxTree> trees_;  ///< per chart, over its triangles
};

/// Vertices that were given one place (the map is squeezed there) move apart: halfway to the mean of their
/// neighbours' places, at last to where the voxels lie.
void separate(const Cage& wall, std::span<const Vec3> pulled_back, std::vector<Vec3>& places) {
  constexpr int most_rounds = 10;
  std::vector<std::set<Index>> beside(places.size());
  for (Index f = 0; f < wall.faces.size(); ++f) {
    for (int n = 0; n < 4; ++n) {
      beside[wall.faces[f][n]].insert(wall.faces[f][(n + 1) % 4]);
      beside[wall.faces[f][(n + 1) % 4]].insert(wall.faces[f][n]);
    }
  }
  for (int round = 0; round < most_rounds; ++round) {
    std::map<std::array<double, 3>, Index> first;
    std::vector<Index> moving;
    for (Index v = 0; v < static_cast<Index>(places.size()); ++v) {
      const auto [it, fresh] = first.try_emplace({places[v].x(), places[v].y(), places[v].z()}, v);
      if (!fresh) moving.push_back(v);
    }
    if (moving.empty()) return;
    if (round == most_rounds - 1) {
      for (const Index v : moving) places[v] = pulled_back[v];
      return;
    }
    const std::vector<Vec3> before = places;
    for (const Index v : moving) {
      Vec3 mean = Vec3::Zero();
      for (const Index n : beside[v]) mean += before[n] / static_cast<double>(beside[v].size());
      places[v] = (before[v] + mean) / 2;
    }
  }
}

std::string chain_text(const TargetSurface& target, Index c) {
  const FeatureChain& chain = target.features().chains[c];
  return fmt::format("sharp edges of {:.4g} m from {} over {} to {}", chain.length,
                     place(chain.polyline.front()), place(chain.polyline[chain.polyline.size() / 2]),
                     place(chain.polyline.back()));
}

}  // namespace

WallFeatures wall_features(const LabelledWall& labelled, const TargetSurface& target,
                           const SurfaceCharts& charts, const ChartBorders& borders) {
  WallFeatures result;
  const Cage& wall = labelled.wall;
  std::vector<std::set<Index>> at(wall.points.size());
  std::map<std::array<Index, 2>, Index> open;
  std::map<Index, std::vector<Index>> chains_at;  // vertex: chain of each crease edge there
  std::set<Index> followed;
  for (Index f = 0; f < wall.faces.size(); ++f) {
    for (int n = 0; n < 4; ++n) {
      const Index a = wall.faces[f][n], b = wall.faces[f][(n + 1) % 4];
      at[a].insert(labelled.label[f]);
      const auto [it, fresh] = open.try_emplace(ordered(a, b), f);
      const Index other = labelled.label[it->second];
      if (fresh || other == labelled.label[f]) continue;
      const Vec3 middle = (wall.points[a] + wall.points[b]) / 2;
      const auto border = borders.between.find(ordered(other, labelled.label[f]));
      if (border == borders.between.end()) {
        const Vec3& p = charts.charts[other].place;
        const Vec3& q = charts.charts[labelled.label[f]].place;
        result.findings.push_back(
            {"border",
             fmt::format(
                 "quads of the surface round {} and of that round {} are neighbours, but these do not meet",
                 place(p), place(q)),
             p});
        continue;
      }
      const Index chain = nearest_border(border->second, middle)->chain;
      if (chain == no_index) continue;
      result.creases.push_back({a, b});
      result.crease_chain.push_back(chain);
      followed.insert(chain);
      chains_at[a].push_back(chain);
      chains_at[b].push_back(chain);
    }
  }
  const Places places(labelled, charts, borders);
  for (Index f = 0; f < wall.faces.size(); ++f) {
    Vec3 centre = Vec3::Zero();
    for (const Index v : wall.faces[f]) centre += wall.points[v] / 4;
    result.face_region.push_back(
        target.tessellation().triangle_face[places.triangle(centre, labelled.label[f])]);
  }
  for (std::size_t v = 0; v < wall.points.size(); ++v)
    result.places.push_back(places.of(wall.points[v], at[v]));
  separate(wall, labelled.pulled_back, result.places);

  for (const auto& [v, chains] : chains_at) {
    const bool turns = chains.size() == 2 && chains[0] != chains[1];
    if (chains.size() == 1 || turns || chains.size() > 2) result.corners.push_back({v});
  }
  // A chart may go to its smooth neighbours; a whole smooth part of the surface is a lost feature.
  std::vector<char> has_quad(static_cast<std::size_t>(charts.group_count), 0);
  for (const Index l : labelled.label) has_quad[charts.charts[l].group] = 1;
  std::vector<Index> face_of_group(has_quad.size(), no_index);
  for (std::size_t t = 0; t < charts.chart.size(); ++t) {
    face_of_group[charts.charts[charts.chart[t]].group] = target.tessellation().triangle_face[t];
  }
  for (const SurfaceCharts::Chart& chart : charts.charts) {
    if (has_quad[chart.group] != 0) continue;
    has_quad[chart.group] = 1;
    result.lost_groups.push_back(chart.group);
    const Index face = face_of_group[chart.group];
    const std::string name = target.face_name(face);
    result.findings.push_back(
        {"region",
         fmt::format(
             "the CAD's face {}{} round {} ({:.3g} m2) has no quad of its own: it is smaller than a cell",
             face + 1, name.empty() ? "" : " (" + name + ")", place(chart.place), chart.area),
         chart.place});
  }
  const std::vector<FeatureChain>& chains = target.features().chains;
  for (Index c = 0; c < static_cast<Index>(chains.size()); ++c) {
    if (chains[c].kind != ChainKind::sharp) continue;
    ++result.chains;
    if (followed.count(c) > 0) {
      ++result.chains_followed;
      continue;
    }
    result.findings.push_back({"chain", "no crease follows " + chain_text(target, c),
                               chains[c].polyline[chains[c].polyline.size() / 2]});
  }
  return result;
}

}  // namespace flowcage
