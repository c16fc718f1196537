#include "core/project/split_at_bends.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/base/error.hpp"
#include "core/project/chain_places.hpp"

namespace flowcage {
namespace {

/// The part of a path from one length to a later one; on a closed path the later one may lie beyond its end.
FeaturePath part_of(const FeaturePath& path, double from, double to) {
  FeaturePath part;
  const int rounds = path.closed ? 2 : 1;
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t p = 0; p < path.pieces.size(); ++p) {
      const double shift = round * path.length();
      const double begin = std::max(from, path.offsets[p] + shift);
      const double end = std::min(to, path.offsets[p + 1] + shift);
      if (!(end > begin)) continue;
      const FeaturePiece& piece = path.pieces[p];
      const double way = piece.s_end >= piece.s_begin ? 1 : -1;
      const double first = path.offsets[p] + shift;
      part.pieces.push_back(
          {piece.chain, piece.s_begin + way * (begin - first), piece.s_begin + way * (end - first)});
      part.offsets.push_back(part.offsets.back() + end - begin);
    }
  }
  return part;
}

/// Where a chain's edge lies on the chain it was cut from.
struct Origin {
  std::size_t chain = 0;
  Index segment = 0;
};

Origin origin_of(std::span<const CreaseChain> chains, Index edge) {
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const auto at = std::find(chains[c].edges.begin(), chains[c].edges.end(), edge);
    if (at != chains[c].edges.end()) return {c, static_cast<Index>(at - chains[c].edges.begin())};
  }
  throw Error(ErrorKind::internal, "a crease edge lies on no chain", "");
}

/// The match of one part of a chain.
ChainMatch part_of(const CreaseChain& part, const CreaseChain& whole, Index segment,
                   const ChainMatch& match) {
  const Index n = part.segment_count();
  const bool forward = part.vertices[0] == whole.vertex(segment);
  const auto place = [&](Index vertex) {
    const Index round = whole.closed && vertex > whole.segment_count() ? 1 : 0;
    return match.s[static_cast<std::size_t>(vertex - round * whole.segment_count())] +
           round * match.path.length();
  };
  // Vertices of the part as places of the whole, in the whole's direction.
  Index first = forward ? segment : segment + 1 - n;
  if (first < 0) first += whole.segment_count();
  ChainMatch result;
  result.matched = true;
  result.cost = match.cost;
  const double from = place(first);
  const double offset = whole.closed ? std::floor(from / match.path.length()) * match.path.length() : 0;
  result.path = part_of(match.path, from - offset, place(first + n) - offset);
  for (Index k = 0; k <= n; ++k) result.s.push_back(place(first + k) - from);
  if (forward) return result;
  result.path = reversed(result.path);
  std::reverse(result.s.begin(), result.s.end());
  const double length = result.s.front();
  for (double& s : result.s) s = length - s;
  return result;
}

}  // namespace

SplitCreases split_at_bends(SurfaceLevel topology, std::span<const Vec3> points,
                            std::vector<CreaseChain> chains, FeatureMatch match, const TargetSurface& target,
                            const FeatureMatchSettings& settings) {
  bool any = false;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const ChainMatch& chain = match.chains[c];
    for (std::size_t k = 0; k < chain.kept.size(); k += 2) {
      const Vec3 at = point_on_path(target, chain.path, 0.5 * (chain.kept[k] + chain.kept[k + 1])).position;
      match.warnings.push_back(fmt::format(
          "a sharp edge of the CAD turns back within {:.3g} m at ({:.6g}, {:.6g}, {:.6g}), far less "
          "than the cage's edges: the two vertices of the cage there were made corners",
          2 * (chain.kept[k + 1] - chain.kept[k]), at.x(), at.y(), at.z()));
    }
    for (const double kept : chain.kept) {
      any = true;
      const auto k = std::find(chain.s.begin(), chain.s.end(), kept) - chain.s.begin();
      const Index v = chains[c].vertex(static_cast<Index>(k));
      topology.vertex_sharpness[v] = infinitely_sharp;
      match.end_is_fixed[v] = true;
      match.end_position[v] = point_on_path(target, chain.path, kept).position;
    }
  }
  if (!any) return {std::move(topology), std::move(chains), std::move(match)};
  std::vector<CreaseChain> parts = crease_chains(topology);
  std::vector<ChainMatch> matches;
  for (const CreaseChain& part : parts) {
    const Origin origin = origin_of(chains, part.edges[0]);
    const ChainMatch& whole = match.chains[origin.chain];
    if (whole.kept.empty()) {
      matches.push_back(whole);
      continue;
    }
    matches.push_back(part_of(part, chains[origin.chain], origin.segment, whole));
    // What it has to say about corners was said of the whole chain.
    place_vertices(target, drawn_chain(part, points), settings, matches.back());
  }
  match.chains = std::move(matches);
  return {std::move(topology), std::move(parts), std::move(match)};
}

std::vector<Index> vertices_at_bends(const Cage& cage, const TargetSurface& target) {
  SurfaceLevel level = build_surface_level(cage);
  const std::vector<double> drawn = level.vertex_sharpness;
  std::vector<CreaseChain> chains = crease_chains(level);
  FeatureMatch match = match_features(level, cage.points, chains, target);
  const SplitCreases split =
      split_at_bends(std::move(level), cage.points, std::move(chains), std::move(match), target);
  std::vector<Index> vertices;
  for (std::size_t v = 0; v < drawn.size(); ++v) {
    if (split.topology.vertex_sharpness[v] > drawn[v]) vertices.push_back(static_cast<Index>(v));
  }
  return vertices;
}

}  // namespace flowcage
