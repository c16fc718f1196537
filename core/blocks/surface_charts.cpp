#include "core/blocks/surface_charts.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace flowcage {
namespace {

constexpr double on_chain = 1e-4;  // diagonals: how near to a chain an edge's ends must be
constexpr double longest = 1.3;    // edge lengths: arc between an edge's ends
constexpr double chord = 0.15;     // edge lengths: how far its middle may be (a chord of the curve)

std::vector<std::array<Index, 3>> triangles_across(const Tessellation& cad) {
  std::vector<std::array<Index, 3>> across(cad.triangles.size(), {no_index, no_index, no_index});
  std::vector<std::tuple<Index, Index, Index, int>> uses;
  for (Index t = 0; t < static_cast<Index>(cad.triangles.size()); ++t) {
    for (int i = 0; i < 3; ++i) {
      const Index a = cad.triangles[t][i], b = cad.triangles[t][(i + 1) % 3];
      uses.emplace_back(std::min(a, b), std::max(a, b), t, i);
    }
  }
  std::sort(uses.begin(), uses.end());
  for (std::size_t first = 0, last = 0; first < uses.size(); first = last) {
    last = first + 1;
    while (last < uses.size() && std::get<0>(uses[last]) == std::get<0>(uses[first]) &&
           std::get<1>(uses[last]) == std::get<1>(uses[first])) {
      ++last;
    }
    if (last - first != 2) continue;  // a rim, or more than two faces: a border either way
    const auto& [a0, b0, t0, i0] = uses[first];
    const auto& [a1, b1, t1, i1] = uses[first + 1];
    across[t0][i0] = t1;
    across[t1][i1] = t0;
  }
  return across;
}

/// Finds which sharp chain an edge of the tessellation lies on.
class ChainFinder {
 public:
  explicit ChainFinder(const TargetSurface& target)
      : target_(target), tolerance_(on_chain * target.diagonal()) {
    const std::vector<FeatureChain>& chains = target.features().chains;
    for (Index c = 0; c < static_cast<Index>(chains.size()); ++c) {
      Box3 box;
      for (const Vec3& p : chains[c].polyline) box.extend(p);
      const double room = tolerance_ + 0.1 * box.diagonal().norm();
      boxes_.emplace_back(box.min() - Vec3::Constant(room), box.max() + Vec3::Constant(room));
      if (chains[c].kind != ChainKind::sharp) continue;
      for (const Index f : chains[c].faces) of_face_[f].push_back(c);
    }
  }

  Index find(Index face, Index other, const Vec3& a, const Vec3& b) const {
    const auto found = of_face_.find(face);
    if (found == of_face_.end()) return no_index;
    for (const Index c : found->second) {
      const std::vector<Index>& faces = target_.features().chains[c].faces;
      // Inside of a face only a chain that has no other face beside it: a seam.
      const bool beside_both =
          face == other ? faces.size() == 1 : std::binary_search(faces.begin(), faces.end(), other);
      if (!beside_both || !boxes_[c].contains(a) || !boxes_[c].contains(b)) continue;
      const CurvePoint first = target_.closest_on_chain(c, a), last = target_.closest_on_chain(c, b);
      if (first.distance > tolerance_ || last.distance > tolerance_) continue;
      const double length = (b - a).norm(), whole = target_.features().chains[c].length;
      if (target_.closest_on_chain(c, (a + b) / 2).distance > tolerance_ + chord * length) continue;
      // Along the chain from end to end, not across a thin face between two of its runs.
      const double along = std::abs(last.s - first.s);
      if (std::min(along, std::max(whole - along, length)) > longest * length + tolerance_) continue;
      return c;
    }
    return no_index;
  }

 private:
  const TargetSurface& target_;
  double tolerance_;
  std::vector<Box3> boxes_;
  std::map<Index, std::vector<Index>> of_face_;
};

/// Numbers of the connected parts of equal `key` that do not cross `stops`.
template <typename Same>
std::vector<Index> parts_of(const SurfaceCharts& s, const Same& same, Index& count) {
  std::vector<Index> part(s.across.size(), no_index), stack;
  count = 0;
  for (Index seed = 0; seed < static_cast<Index>(part.size()); ++seed) {
    if (part[seed] != no_index) continue;
    part[seed] = count;
    stack.push_back(seed);
    while (!stack.empty()) {
      const Index t = stack.back();
      stack.pop_back();
      for (int i = 0; i < 3; ++i) {
        const Index n = s.across[t][i];
        if (n == no_index || s.chain[t][i] != no_index || part[n] != no_index || !same(t, n)) continue;
        part[n] = count;
        stack.push_back(n);
      }
    }
    ++count;
  }
  return part;
}

}  // namespace

SurfaceCharts surface_charts(const TargetSurface& target, double least_area) {
  const Tessellation& cad = target.tessellation();
  const auto triangles = static_cast<Index>(cad.triangles.size());
  SurfaceCharts result;
  result.across = triangles_across(cad);
  result.chain.assign(result.across.size(), {no_index, no_index, no_index});
  const ChainFinder finder(target);
  std::vector<Vec3> area(static_cast<std::size_t>(triangles));
  for (Index t = 0; t < triangles; ++t) {
    const auto& v = cad.triangles[t];
    area[t] = (cad.points[v[1]] - cad.points[v[0]]).cross(cad.points[v[2]] - cad.points[v[0]]) / 2;
    for (int i = 0; i < 3; ++i) {
      const Index n = result.across[t][i];
      if (n == no_index || n < t) continue;
      // Inside of a face the surface is smooth, except along a seam or a sharp knot line.
      const Index c = finder.find(cad.triangle_face[t], cad.triangle_face[n], cad.points[v[i]],
                                  cad.points[v[(i + 1) % 3]]);
      if (c == no_index) continue;
      result.chain[t][i] = c;
      for (int j = 0; j < 3; ++j) {
        if (result.across[n][j] == t) result.chain[n][j] = c;
      }
    }
  }
  const std::vector<Index> group = parts_of(
      result, [](Index, Index) { return true; }, result.group_count);

  std::vector<int> label(static_cast<std::size_t>(triangles));  // 2 axis + (1 where it points down)
  std::vector<Vec3> group_area(static_cast<std::size_t>(result.group_count), Vec3::Zero());
  std::vector<double> group_size(group_area.size(), 0);
  const auto nearest_direction = [](const Vec3& n) {
    int axis = 0;
    n.cwiseAbs().maxCoeff(&axis);
    return 2 * axis + (n[axis] < 0 ? 1 : 0);
  };
  for (Index t = 0; t < triangles; ++t) {
    group_area[group[t]] += area[t];
    group_size[group[t]] += area[t].norm();
  }
  for (Index t = 0; t < triangles; ++t) {
    // A nearly plane part is one chart, whichever way its noise points.
    constexpr double plane = 0.99;
    const bool whole = group_area[group[t]].norm() > plane * group_size[group[t]];
    label[t] = nearest_direction(whole ? group_area[group[t]] : area[t]);
  }

  for (int round = 0; round < 8; ++round) {
    Index count = 0;
    result.chart = parts_of(
        result, [&](Index a, Index b) { return label[a] == label[b]; }, count);
    std::vector<double> size(static_cast<std::size_t>(count), 0);
    for (Index t = 0; t < triangles; ++t) size[result.chart[t]] += area[t].norm();
    std::vector<std::map<Index, double>> border(size.size());
    std::vector<int> chart_label(size.size());
    for (Index t = 0; t < triangles; ++t) {
      chart_label[result.chart[t]] = label[t];
      for (int i = 0; i < 3; ++i) {
        const Index n = result.across[t][i];
        if (n == no_index || result.chain[t][i] != no_index || result.chart[n] == result.chart[t]) continue;
        const auto& v = cad.triangles[t];
        border[result.chart[t]][result.chart[n]] += (cad.points[v[(i + 1) % 3]] - cad.points[v[i]]).norm();
      }
    }
    std::vector<int> new_label = chart_label;
    bool changed = false;
    for (Index c = 0; c < count; ++c) {
      if (size[c] >= least_area || border[c].empty()) continue;
      const auto longest = std::max_element(border[c].begin(), border[c].end(),
                                            [](const auto& a, const auto& b) { return a.second < b.second; });
      if (size[longest->first] < size[c]) continue;
      new_label[c] = chart_label[longest->first];
      changed = true;
    }
    if (!changed) break;
    for (Index t = 0; t < triangles; ++t) label[t] = new_label[result.chart[t]];
  }

  Index count = 0;
  result.chart = parts_of(
      result, [&](Index a, Index b) { return label[a] == label[b]; }, count);
  result.charts.resize(static_cast<std::size_t>(count));
  std::vector<Box3> box(result.charts.size());
  for (Index t = 0; t < triangles; ++t) {
    SurfaceCharts::Chart& chart = result.charts[result.chart[t]];
    chart.axis = label[t] / 2;
    chart.sign = label[t] % 2 == 0 ? 1 : -1;
    chart.group = group[t];
    chart.area += area[t].norm();
    for (const Index v : cad.triangles[t]) {
      chart.place += area[t].norm() / 3 * cad.points[v];
      box[result.chart[t]].extend(cad.points[v]);
    }
  }
  for (std::size_t c = 0; c < result.charts.size(); ++c) {
    result.charts[c].place /= std::max(result.charts[c].area, 1e-300);
    result.charts[c].diameter = box[c].diagonal().norm();
  }
  return result;
}

}  // namespace flowcage
