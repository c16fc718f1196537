#include "core/refit/cage_fit.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "core/project/chain_places.hpp"
#include "core/refit/symmetric_level.hpp"

namespace flowcage {
namespace {

/// Other starts and matches have to win clearly: what a person drew means something.
constexpr double drawn_credit = 0.6;
/// No further round of trials after this many.
constexpr int most_trials = 40;
/// A face whose midpoint is left this far from the target, in its shortest edge's length, is in a wrong
/// place.
constexpr double astray = 0.1;

bool clearly_better(const LevelFitResult& a, const LevelFitResult& b) {
  return a.best.folds() != b.best.folds() ? a.best.folds() < b.best.folds()
                                          : a.best.score() < drawn_credit * b.best.score();
}

/// Vertices that hang together with one whose place is given, through edges.
std::vector<char> anchored_vertices(const LevelSystem& level) {
  const SurfaceLevel& t = level.topology;
  std::vector<char> anchored(t.vertex_count(), 0);
  std::vector<Index> front;
  for (Index v = 0; v < t.vertex_count(); ++v) {
    if (level.kind[v] == SampleKind::surface) continue;
    anchored[v] = 1;
    front.push_back(v);
  }
  while (!front.empty()) {
    const Index v = front.back();
    front.pop_back();
    for (const Index e : t.vertex_edges[v]) {
      for (const Index w : t.edge_vertices[e]) {
        if (anchored[w] != 0) continue;
        anchored[w] = 1;
        front.push_back(w);
      }
    }
  }
  return anchored;
}

/// The cage with crease vertices at their places and the others drawn to the mean of their neighbours in a
/// few sweeps: enough to bring vertices back that noise has thrown over a crease. Parts without a crease
/// stay: nothing would hold them from shrinking.
std::vector<Vec3> evened_points(const LevelFitInput& input, std::vector<Vec3> points) {
  constexpr int sweeps = 10;
  const LevelSystem& level = input.level;
  const SurfaceLevel& t = level.topology;
  const std::vector<char> anchored = anchored_vertices(level);
  std::vector<Index> free;
  for (Index v = 0; v < t.vertex_count(); ++v) {
    if (level.kind[v] == SampleKind::fixed) {
      points[v] = level.fixed_position[v];
    } else if (level.kind[v] == SampleKind::chain) {
      const Index c = level.sample_chain[v];
      const double s = level.places[c][level.sample_on_chain[v]];
      points[v] = point_on_path(input.target, input.match.chains[c].path, s).position;
    } else if (level.kind[v] == SampleKind::surface && anchored[v] != 0) {
      free.push_back(v);
    }
  }
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (const Index v : free) {
      Vec3 sum = Vec3::Zero();
      for (const Index e : t.vertex_edges[v]) {
        const auto& [a, b] = t.edge_vertices[e];
        sum += points[a == v ? b : a];
      }
      points[v] = sum / static_cast<double>(t.vertex_edges[v].size());
    }
  }
  return points;
}

class CageFitter {
 public:
  CageFitter(const Cage& cage, const TargetSurface& target, const FitSettings& settings)
      : cage_(cage),
        target_(target),
        settings_(settings),
        topology_(build_surface_level(cage)),
        chains_(crease_chains(topology_)) {}

  CageFit run() const {
    CageFit best = fitted(match_features(topology_, cage_.points, chains_, target_));
    int trials = 0;
    for (bool improved = true; improved && trials < most_trials;) {
      improved = false;
      const FeatureMatch match = best.match;
      for (const Index c : chains_round(bad_faces(best))) {
        if (!match.chains[c].matched) continue;
        const DrawnChain drawn = drawn_chain(chains_[c], cage_.points);
        for (ChainMatch& other : other_places(target_, drawn, {}, match.chains[c])) {
          FeatureMatch changed = match;
          changed.chains[c] = std::move(other);
          CageFit trial = fitted(std::move(changed));
          ++trials;
          if (!clearly_better(trial.fitted, best.fitted)) continue;
          best = std::move(trial);
          improved = true;
        }
      }
    }
    return best;
  }

 private:
  CageFit fitted(FeatureMatch match) const {
    CageFit fit;
    fit.match = std::move(match);
    fit.planes = chain_planes(chains_, fit.match, target_);
    SurfaceLevel topology = topology_;
    if (settings_.mirror) {
      topology = symmetric_level(std::move(topology), chains_, fit.match, fit.planes, target_);
    }
    fit.level = std::make_unique<LevelSystem>(
        build_level_system(std::move(topology), chains_, cage_places(fit.match), fit.match));
    const LevelFitInput input{*fit.level, fit.match, target_, fit.planes, settings_};
    fit.fitted = fit_level(input, interpolating_start(input, cage_.points));
    const bool has_creases = std::any_of(fit.match.chains.begin(), fit.match.chains.end(),
                                         [](const ChainMatch& chain) { return chain.matched; });
    if (!has_creases) return fit;
    LevelFitResult evened = fit_level(input, interpolating_start(input, evened_points(input, cage_.points)));
    if (clearly_better(evened, fit.fitted)) fit.fitted = std::move(evened);
    return fit;
  }

  /// Faces that fold, and those with a sample that is left far from the target.
  static std::vector<Index> bad_faces(const CageFit& fit) {
    const FitPass& pass = fit.fitted.best;
    const LevelSystem& level = *fit.level;
    std::vector<Index> bad = pass.folded;
    for (Index f = 0; f < level.topology.face_count(); ++f) {
      double shortest = std::numeric_limits<double>::infinity();
      for (const Index e : level.topology.face_edges[f]) {
        shortest = std::min(shortest, pass.limit.lengths[level.edge_sample(e)]);
      }
      const Index middle = level.face_sample(f);
      const double off = (pass.limit.points[middle] - pass.targets[middle]).norm();
      if (off > astray * shortest) bad.push_back(f);
    }
    return bad;
  }

  /// Chains with a vertex on one of the faces or beside it, ascending.
  std::vector<Index> chains_round(std::span<const Index> faces) const {
    std::vector<bool> near(static_cast<std::size_t>(topology_.vertex_count()), false);
    for (const Index face : faces) {
      for (const Index corner : topology_.face_vertices[face]) {
        for (const Index f : topology_.vertex_faces[corner]) {
          for (const Index v : topology_.face_vertices[f]) near[v] = true;
        }
      }
    }
    std::vector<Index> found;
    for (std::size_t c = 0; c < chains_.size(); ++c) {
      const std::vector<Index>& vertices = chains_[c].vertices;
      if (std::any_of(vertices.begin(), vertices.end(), [&](Index v) { return near[v]; })) {
        found.push_back(static_cast<Index>(c));
      }
    }
    return found;
  }

  const Cage& cage_;
  const TargetSurface& target_;
  const FitSettings& settings_;
  SurfaceLevel topology_;
  std::vector<CreaseChain> chains_;
};

}  // namespace

CageFit fit_cage(const Cage& cage, const TargetSurface& target, const FitSettings& settings) {
  return CageFitter(cage, target, settings).run();
}

}  // namespace flowcage
