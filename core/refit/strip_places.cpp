#include "core/refit/strip_places.hpp"

#include <algorithm>

namespace flowcage {

ChainPlaces paired_places(const LevelSystem& level, const FeatureMatch& match, const TargetSurface& target,
                          const ChainPlaces& places) {
  constexpr double narrow = 0.5;
  ChainPlaces paired = places;
  const Index steps = Index{2} << level.topology.depth;  // samples a segment of the cage
  const auto held = [&](Index chain, Index k) {
    const bool loop = level.chains[chain].closed;
    return match.chains[chain].turns ||
           (!loop && (k == 0 || k + 1 == static_cast<Index>(places[chain].size())));
  };
  const auto spacing = [&](Index chain, Index k) {
    const std::vector<double>& s = places[chain];
    return k + 1 < static_cast<Index>(s.size()) ? s[k + 1] - s[k] : s[k] - s[k - 1];
  };
  for (const OppositeSegments& pair : match.strips) {
    const Index a = pair.chain_a, b = pair.chain_b;
    if (!match.chains[a].matched || !match.chains[b].matched) continue;
    for (Index i = 0; i <= steps; ++i) {
      const Index ka = pair.segment_a * steps + i;
      const Index kb = pair.segment_b * steps + (pair.against ? steps - i : i);
      const bool a_held = held(a, ka), b_held = held(b, kb);
      if (a_held && b_held) continue;
      for (int step = 0; step < 2; ++step) {
        const CurvePoint at_a = point_on_path(target, match.chains[a].path, paired[a][ka]);
        const CurvePoint at_b = point_on_path(target, match.chains[b].path, paired[b][kb]);
        const Vec3 rung = at_b.position - at_a.position;
        if (rung.norm() > narrow * std::min(spacing(a, ka), spacing(b, kb))) break;
        const double share = a_held || b_held ? 1 : 0.5;
        const double slip_a = rung.dot(at_a.tangent), slip_b = rung.dot(at_b.tangent);
        if (!a_held) paired[a][ka] += share * slip_a;
        if (!b_held) paired[b][kb] -= share * slip_b;
      }
    }
  }
  for (std::size_t c = 0; c < paired.size(); ++c) {
    std::vector<double>& s = paired[c];
    if (s.empty() || s == places[c]) continue;
    if (level.chains[c].closed) s.back() = s.front() + match.chains[c].path.length();
    for (std::size_t k = 0; k + 1 < s.size(); ++k) {
      if (s[k + 1] - s[k] < 0.25 * (places[c][k + 1] - places[c][k])) {
        s = places[c];
        break;
      }
    }
  }
  return paired;
}

}  // namespace flowcage
