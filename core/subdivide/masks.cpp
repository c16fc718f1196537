#include "core/subdivide/masks.hpp"

#include <algorithm>

namespace flowcage {
namespace {

VertexRule rule_of(bool vertex_is_sharp, int sharp_edges) {
  if (vertex_is_sharp || sharp_edges > 2) return VertexRule::corner;
  if (sharp_edges == 2) return VertexRule::crease;
  return sharp_edges == 1 ? VertexRule::dart : VertexRule::smooth;
}

// True where a feature is sharp now and smooth at the next level.
bool ends_here(double sharpness) {
  return sharpness > 0 && decayed_sharpness(sharpness) == 0;
}

// The mask of a rule that holds now and at the next level. `is_sharp` tells crease edges.
template <typename IsSharp>
VertexMask steady_mask(VertexRule rule, std::span<const double> edge_sharpness, const IsSharp& is_sharp) {
  VertexMask mask;
  if (rule == VertexRule::corner) return mask;
  if (rule == VertexRule::crease) {
    mask.vertex = 0.75;
    mask.crease = 0.125;
    int found = 0;
    for (std::size_t i = 0; i < edge_sharpness.size() && found < 2; ++i) {
      if (is_sharp(edge_sharpness[i])) mask.crease_edges[found++] = static_cast<int>(i);
    }
    return mask;
  }
  return smooth_vertex_mask(static_cast<int>(edge_sharpness.size()));
}

}  // namespace

double decayed_sharpness(double sharpness) {
  return sharpness >= infinitely_sharp ? sharpness : std::max(0.0, sharpness - 1);
}

VertexRule vertex_rule(double vertex_sharpness, std::span<const double> edge_sharpness) {
  const auto sharp =
      std::count_if(edge_sharpness.begin(), edge_sharpness.end(), [](double s) { return s > 0; });
  return rule_of(vertex_sharpness > 0, static_cast<int>(sharp));
}

VertexMask smooth_vertex_mask(int valence) {
  const double n = valence;
  VertexMask mask;
  mask.vertex = (n - 2) / n;
  mask.edge = mask.face = 1 / (n * n);
  return mask;
}

VertexMask vertex_mask(double vertex_sharpness, std::span<const double> edge_sharpness) {
  const auto sharp_now = [](double s) { return s > 0; };
  const auto sharp_next = [](double s) { return decayed_sharpness(s) > 0; };
  int now = 0, next = 0, ending = 0;
  double ending_sum = 0;
  for (const double s : edge_sharpness) {
    if (s <= 0) continue;
    ++now;
    if (sharp_next(s)) {
      ++next;
    } else {
      ++ending;
      ending_sum += s;
    }
  }
  if (ends_here(vertex_sharpness)) {
    ++ending;
    ending_sum += vertex_sharpness;
  }
  const VertexRule rule = rule_of(sharp_now(vertex_sharpness), now);
  VertexMask mask = steady_mask(rule, edge_sharpness, sharp_now);
  if (ending == 0 || rule == VertexRule::smooth || rule == VertexRule::dart) return mask;
  const VertexRule next_rule = rule_of(sharp_next(vertex_sharpness), next);
  if (next_rule == rule) return mask;

  const double parent = std::min(1.0, ending_sum / ending);
  const VertexMask child = steady_mask(next_rule, edge_sharpness, sharp_next);
  // A crease never follows another crease here, so one pair of crease edges is enough.
  if (child.crease != 0) mask.crease_edges = child.crease_edges;
  mask.vertex = parent * mask.vertex + (1 - parent) * child.vertex;
  mask.edge = parent * mask.edge + (1 - parent) * child.edge;
  mask.face = parent * mask.face + (1 - parent) * child.face;
  mask.crease = parent * mask.crease + (1 - parent) * child.crease;
  return mask;
}

EdgeMask edge_mask(double sharpness) {
  if (sharpness >= 1) return {0.5, 0};
  if (sharpness <= 0) return {0.25, 0.25};
  return {0.25 + 0.25 * sharpness, 0.25 - 0.25 * sharpness};
}

}  // namespace flowcage
