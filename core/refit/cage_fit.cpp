#include "core/refit/cage_fit.hpp"

#include <algorithm>
#include <limits>
#include <span>

#include "core/project/chain_places.hpp"
#include "core/project/split_at_bends.hpp"
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
      : cage_(cage), target_(target), settings_(settings) {
    SurfaceLevel topology = build_surface_level(cage);
    std::vector<CreaseChain> chains = crease_chains(topology);
    FeatureMatch match = match_features(topology, cage.points, chains, target);
    drawn_ = split_at_bends(std::move(topology), cage.points, std::move(chains), std::move(match), target);
  }

  CageFit run() const {
    CageFit best = fitted(drawn_.match);
    int trials = 0;
    for (bool improved = true; improved && trials < most_trials;) {
      improved = false;
      const FeatureMatch match = best.match;
      for (const Index c : chains_round(bad_faces(best))) {
        if (!match.chains[c].matched) continue;
        const DrawnChain drawn = drawn_chain(drawn_.chains[c], cage_.points);
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
    fit.planes = chain_planes(drawn_.chains, fit.match, target_);
    SurfaceLevel topology = drawn_.topology;
    if (settings_.mirror) {
      topology = symmetric_level(std::move(topology), drawn_.chains, fit.match, fit.planes, target_);
    }
    fit.level = std::make_unique<LevelSystem>(
        build_level_system(std::move(topology), drawn_.chains, cage_places(fit.match), fit.match));
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
    std::vector<bool> near(static_cast<std::size_t>(drawn_.topology.vertex_count()), false);
    for (const Index face : faces) {
      for (const Index corner : drawn_.topology.face_vertices[face]) {
        for (const Index f : drawn_.topology.vertex_faces[corner]) {
          for (const Index v : drawn_.topology.face_vertices[f]) near[v] = true;
        }
      }
    }
    std::vector<Index> found;
    for (std::size_t c = 0; c < drawn_.chains.size(); ++c) {
      const std::vector<Index>& vertices = drawn_.chains[c].vertices;
      if (std::any_of(vertices.begin(), vertices.end(), [&](Index v) { return near[v]; })) {
        found.push_back(static_cast<Index>(c));
      }
    }
    return found;
  }

  const Cage& cage_;
  const TargetSurface& target_;
  const FitSettings& settings_;
  SplitCreases drawn_;
};

}  // namespace

CageFit fit_cage(const Cage& cage, const TargetSurface& target, const FitSettings& settings) {
  return CageFitter(cage, target, settings).run();
}

}  // namespace flowcage
