#include "core/project/chain_runs.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace flowcage {
namespace {

/// A chain and the way it is run through.
struct Passage {
  Index chain = no_index;
  bool forward = true;
};

Index end_corner(const FeatureChain& chain, bool at_start) {
  return at_start ? chain.start : chain.end;
}

class RunBuilder {
 public:
  RunBuilder(const TargetSurface& target, const std::vector<bool>& is_used, double spacing)
      : target_(target),
        chains_(target.features().chains),
        ends_(chain_ends(target.features())),
        is_used_(is_used),
        spacing_(spacing),
        done_(chains_.size(), false) {}

  std::vector<ChainRun> build() {
    std::vector<ChainRun> runs;
    for (Index c = 0; c < static_cast<Index>(chains_.size()); ++c) {
      if (done_[c] || !(chains_[c].length > 0)) continue;
      done_[c] = true;
      std::vector<Passage> ahead = followed({c, true});
      ChainRun run;
      run.closed = chains_[c].start == no_index || loops(c, ahead);
      std::vector<Passage> passages;
      if (!run.closed) {
        passages = followed({c, false});
        std::reverse(passages.begin(), passages.end());
        for (Passage& p : passages) p.forward = !p.forward;
      }
      passages.push_back({c, true});
      passages.insert(passages.end(), ahead.begin(), ahead.end());
      fill(passages, run);
      runs.push_back(std::move(run));
    }
    return runs;
  }

 private:
  /// The passage after `from`, or none where a used corner, an end or a fork is.
  Passage next(const Passage& from) const {
    const Index corner = end_corner(chains_[from.chain], !from.forward);
    if (corner == no_index || is_used_[corner] || ends_.row_size(corner) != 2) return {};
    const ChainEnd& other =
        ends_[corner][ends_[corner][0].chain == from.chain && ends_[corner][0].at_start != from.forward];
    if (chains_[other.chain].kind != chains_[from.chain].kind) return {};
    return {other.chain, other.at_start};
  }
  std::vector<Passage> followed(const Passage& from) {
    std::vector<Passage> passages;
    for (Passage p = next(from); p.chain != no_index && !done_[p.chain]; p = next(p)) {
      done_[p.chain] = true;
      passages.push_back(p);
    }
    return passages;
  }
  /// Whether the last passage leads back into chain c.
  bool loops(Index c, const std::vector<Passage>& ahead) const {
    return next(ahead.empty() ? Passage{c, true} : ahead.back()).chain == c;
  }

  void fill(const std::vector<Passage>& passages, ChainRun& run) const {
    const Passage &first = passages.front(), &last = passages.back();
    run.kind = chains_[first.chain].kind;
    if (!run.closed) {
      run.start = end_corner(chains_[first.chain], first.forward);
      run.end = end_corner(chains_[last.chain], !last.forward);
    }
    std::vector<double> offsets{0};
    for (const Passage& p : passages) {
      run.chains.push_back(p.chain);
      offsets.push_back(offsets.back() + chains_[p.chain].length);
    }
    run.length = offsets.back();
    const int steps = static_cast<int>(std::clamp(std::ceil(run.length / spacing_), 16.0, 256.0));
    std::size_t part = 0;
    for (int i = 0; i <= steps; ++i) {
      const double s = run.length * i / steps;
      while (part + 1 < passages.size() && s > offsets[part + 1]) ++part;
      const double along = s - offsets[part];
      const Passage& p = passages[part];
      run.samples.push_back(
          target_.chain_point(p.chain, p.forward ? along : chains_[p.chain].length - along).position);
    }
    if (run.closed) run.samples.back() = run.samples.front();
  }

  const TargetSurface& target_;
  const std::vector<FeatureChain>& chains_;
  Csr<ChainEnd> ends_;
  const std::vector<bool>& is_used_;
  double spacing_;
  std::vector<bool> done_;
};

}  // namespace

Csr<ChainEnd> chain_ends(const FeatureGraph& features) {
  std::vector<std::vector<ChainEnd>> rows(features.corners.size());
  for (Index c = 0; c < static_cast<Index>(features.chains.size()); ++c) {
    const FeatureChain& chain = features.chains[c];
    if (chain.start == no_index) continue;
    rows[chain.start].push_back({c, true});
    rows[chain.end].push_back({c, false});
  }
  Csr<ChainEnd> ends;
  for (const auto& row : rows) ends.push_row(row);
  return ends;
}

std::vector<ChainRun> chain_runs(const TargetSurface& target, const std::vector<bool>& is_used,
                                 double spacing) {
  return RunBuilder(target, is_used, spacing).build();
}

double turn_at(const TargetSurface& target, std::span<const ChainEnd> ends) {
  assert(ends.size() == 2);
  std::array<Vec3, 2> leaving;
  for (int i = 0; i < 2; ++i) {
    const double s = ends[i].at_start ? 0 : target.features().chains[ends[i].chain].length;
    leaving[i] = target.chain_point(ends[i].chain, s).tangent;
    if (!ends[i].at_start) leaving[i] = -leaving[i];
  }
  return std::acos(std::clamp(-leaving[0].dot(leaving[1]), -1.0, 1.0));
}

}  // namespace flowcage
