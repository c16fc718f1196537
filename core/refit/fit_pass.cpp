#include "core/refit/fit_pass.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

/// The samples of a chain in order; the last of a loop is its first again.
std::vector<Index> chain_samples(const LevelSystem& level, const CreaseChain& chain) {
  std::vector<Index> samples;
  for (Index i = 0; i < chain.segment_count(); ++i) {
    samples.push_back(chain.vertices[i]);
    samples.push_back(level.edge_sample(chain.edges[i]));
  }
  samples.push_back(chain.vertex(chain.segment_count()));
  return samples;
}

std::vector<double> slid_chain(const LevelSystem& level, std::size_t c, const ChainMatch& match,
                               const TargetSurface& target, std::span<const double> before,
                               std::span<const Vec3> limits) {
  const FeaturePath& path = match.path;
  const CreaseChain& chain = level.chains[c];
  const std::vector<Index> samples = chain_samples(level, chain);
  const std::vector<double>& first = level.places[c];
  const std::size_t last = before.size() - 1;
  std::vector<double> after(before.begin(), before.end());
  for (std::size_t k = chain.closed ? 0 : 1; k < last; ++k) {
    // On the coarsest level a vertex that slid off its bend would fold the faces beside it; later the bend is
    // resolved, and even spacing serves the curve better.
    if (level.topology.depth == 0 && std::binary_search(match.pinned.begin(), match.pinned.end(), before[k]))
      continue;
    const double gap_before = k > 0 ? before[k] - before[k - 1] : before[last] - before[last - 1];
    const double reach = 0.5 * std::min(gap_before, before[k + 1] - before[k]);
    for (int step = 0; step < 3; ++step) {
      const CurvePoint at = point_on_path(target, path, after[k]);
      const double way = (limits[samples[k]] - at.position).dot(at.tangent);
      after[k] = std::clamp(after[k] + way, before[k] - reach, before[k] + reach);
    }
  }
  if (chain.closed) after[last] = after[0] + path.length();
  for (std::size_t k = 0; k < last; ++k) {
    const double least = 0.25 * std::max(before[k + 1] - before[k], first[k + 1] - first[k]);
    if (!(after[k + 1] - after[k] > least)) return {before.begin(), before.end()};
  }
  return after;
}

void place_on_chains(const LevelSystem& level, const FeatureMatch& match, const TargetSurface& target,
                     bool slide, FitPass& pass) {
  if (slide) pass.places = slid_places(level, match, target, pass.places, pass.limit.points);
  const Index count = level.sample_count();
  pass.chain_tangents.assign(static_cast<std::size_t>(count), Vec3::Zero());
  parallel_for(count, 64, [&](Offset begin, Offset end) {
    for (Offset i = begin; i < end; ++i) {
      if (level.kind[i] == SampleKind::fixed) {
        pass.targets[i] = level.fixed_position[i];
      } else if (level.kind[i] == SampleKind::chain) {
        const Index chain = level.sample_chain[i];
        const CurvePoint at =
            point_on_path(target, match.chains[chain].path, pass.places[chain][level.sample_on_chain[i]]);
        pass.targets[i] = at.position;
        pass.chain_tangents[i] = at.tangent;
      }
    }
  });
}

}  // namespace

ChainPlaces slid_places(const LevelSystem& level, const FeatureMatch& match, const TargetSurface& target,
                        const ChainPlaces& places, std::span<const Vec3> limits) {
  ChainPlaces slid = places;
  parallel_for(static_cast<Offset>(places.size()), 1, [&](Offset begin, Offset end) {
    for (Offset c = begin; c < end; ++c) {
      if (!match.chains[c].matched || match.chains[c].turns) continue;
      slid[c] = slid_chain(level, static_cast<std::size_t>(c), match.chains[c], target, places[c], limits);
    }
  });
  return slid;
}

std::vector<SurfacePoint> project_samples(const LevelSystem& level, const TargetSurface& target,
                                          std::span<const Vec3> queries, const LimitState& limit,
                                          std::span<const SurfacePoint> hints,
                                          const LimitProjectionSettings& settings) {
  std::vector<Index> chosen;
  std::vector<Vec3> points, normals;
  std::vector<double> lengths;
  std::vector<SurfacePoint> known;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (level.kind[i] == SampleKind::chain || level.kind[i] == SampleKind::fixed) continue;
    chosen.push_back(static_cast<Index>(i));
    points.push_back(queries[i]);
    normals.push_back(limit.normals[i]);
    lengths.push_back(limit.lengths[i]);
    if (!hints.empty()) known.push_back(hints[i]);
  }
  const std::vector<SurfacePoint> feet =
      project_limit_points(target, {points, normals, lengths, known}, settings);
  std::vector<SurfacePoint> all(queries.size());
  for (std::size_t k = 0; k < chosen.size(); ++k) all[chosen[k]] = feet[k];
  return all;
}

FitPass evaluate_pass(const LevelSystem& level, const FeatureMatch& match, const TargetSurface& target,
                      std::vector<Vec3> control_points, const PassMode& mode, const FitPass* previous) {
  FitPass pass;
  pass.control_points = std::move(control_points);
  pass.limit = limit_state(level, pass.control_points);
  const std::size_t count = pass.limit.points.size();
  pass.places = previous != nullptr ? previous->places : level.places;
  std::vector<Vec3> queries = pass.limit.points;
  if (mode.relaxation > 0) {
    const std::vector<Vec3> moves = tangential_relaxation(level, pass.limit, mode.relaxation);
    for (std::size_t i = 0; i < count; ++i) queries[i] += moves[i];
  }
  pass.feet = project_samples(
      level, target, queries, pass.limit,
      previous != nullptr ? std::span<const SurfacePoint>(previous->feet) : std::span<const SurfacePoint>());
  pass.targets.resize(count);
  place_on_chains(level, match, target, mode.slide, pass);
  std::vector<Vec3> target_normals(count, Vec3::Zero());
  double sum = 0;
  Index measured = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3& at = pass.limit.points[i];
    double error = 0;
    switch (level.kind[i]) {
      case SampleKind::fixed:
        error = (at - pass.targets[i]).norm();
        break;
      case SampleKind::chain: {
        const Vec3 off = at - pass.targets[i];
        error = (off - pass.chain_tangents[i] * pass.chain_tangents[i].dot(off)).norm();
        break;
      }
      case SampleKind::surface:
      case SampleKind::crease:
        // Without a plausible place the sample stays where it is: its neighbours carry it.
        if (pass.feet[i].status == FootStatus::failed) {
          pass.targets[i] = at;
          continue;
        }
        pass.targets[i] = pass.feet[i].position;
        target_normals[i] = pass.feet[i].normal;
        // While relaxing, the way along the surface is no error.
        error = pass.feet[i].status == FootStatus::interior && mode.relaxation > 0
                    ? std::abs((at - pass.targets[i]).dot(pass.feet[i].normal))
                    : (at - pass.targets[i]).norm();
        break;
    }
    sum += error * error;
    pass.max = std::max(pass.max, error);
    ++measured;
  }
  pass.rms = std::sqrt(sum / std::max<Index>(measured, 1));
  pass.folded = folded_faces(level, pass.limit, target_normals);
  return pass;
}

StageMetrics tangent_metrics(const LevelSystem& level, const FitPass& pass, double tangential_weight) {
  StageMetrics metrics;
  metrics.crease = {pass.chain_tangents, tangential_weight, 1};
  metrics.interior.across = tangential_weight;
  metrics.interior.directions.assign(pass.targets.size(), Vec3::Zero());
  for (std::size_t i = 0; i < pass.targets.size(); ++i) {
    if (level.kind[i] == SampleKind::surface && pass.feet[i].status == FootStatus::interior) {
      metrics.interior.directions[i] = pass.feet[i].normal;
    } else if (level.mirror_axis[i] >= 0 && level.kind[i] == SampleKind::chain) {
      // The surface meets the plane at a right angle: its normal is the one of the curve.
      metrics.interior.directions[i] =
          pass.chain_tangents[i].cross(Vec3::Unit(level.mirror_axis[i])).normalized();
    }
  }
  return metrics;
}

}  // namespace flowcage
