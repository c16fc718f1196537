#include "core/blocks/ambient_body.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.hpp"
#include "core/project/winding_number.hpp"

namespace flowcage {
namespace {

/// Where a column meets a triangle: +1 where it enters the body.
struct Crossing {
  double at;
  int sign;
};

/// Positions of the columns along one axis: a little off the even ones, so that no symmetric body has its
/// edges on them.
std::vector<double> column_positions(const std::vector<double>& lines, int samples) {
  constexpr double off = 0.0137;
  std::vector<double> at;
  for (std::size_t n = 0; n + 1 < lines.size(); ++n) {
    for (int s = 0; s < samples; ++s)
      at.push_back(lines[n] + (lines[n + 1] - lines[n]) * (s + 0.5 + off) / samples);
  }
  return at;
}

/// Twice the signed area of a, b and the origin, the same bits (but the sign) for b, a.
double edge_side(const Vec2& a, const Vec2& b) {
  const bool swap = a.x() != b.x() ? a.x() > b.x() : a.y() > b.y();
  const Vec2& p = swap ? b : a;
  const Vec2& q = swap ? a : b;
  const double area = p.x() * q.y() - p.y() * q.x();
  return swap ? -area : area;
}

/// Halves every edge longer than `longest` in all of its triangles. False if there was none.
bool split_long_edges(AmbientBody& body, double longest) {
  std::vector<std::array<Index, 2>> edges;
  for (const auto& t : body.triangles) {
    for (int i = 0; i < 3; ++i) {
      const Index a = t[i], b = t[(i + 1) % 3];
      if ((body.points[a] - body.points[b]).norm() > longest)
        edges.push_back({std::min(a, b), std::max(a, b)});
    }
  }
  if (edges.empty()) return false;
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  const auto first = static_cast<Index>(body.points.size());
  for (const auto& [a, b] : edges) body.points.push_back((body.points[a] + body.points[b]) / 2);
  const auto middle = [&](Index a, Index b) {
    const std::array<Index, 2> key{std::min(a, b), std::max(a, b)};
    const auto found = std::lower_bound(edges.begin(), edges.end(), key);
    return found != edges.end() && *found == key ? first + static_cast<Index>(found - edges.begin())
                                                 : no_index;
  };
  std::vector<std::array<Index, 3>> triangles;
  std::vector<Index> parent;
  for (std::size_t n = 0; n < body.triangles.size(); ++n) {
    const auto& t = body.triangles[n];
    std::array<Index, 3> m{};
    int cut = 0;
    for (int i = 0; i < 3; ++i) {
      m[i] = middle(t[i], t[(i + 1) % 3]);
      cut += m[i] != no_index ? 1 : 0;
    }
    const auto add = [&](Index a, Index b, Index c) {
      triangles.push_back({a, b, c});
      parent.push_back(body.parent[n]);
    };
    if (cut == 0) add(t[0], t[1], t[2]);
    if (cut == 3) {
      for (int i = 0; i < 3; ++i) add(t[i], m[i], m[(i + 2) % 3]);
      add(m[0], m[1], m[2]);
    }
    for (int i = 0; i < 3 && (cut == 1 || cut == 2); ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      if (cut == 1 && m[i] != no_index) {
        add(t[i], m[i], t[k]);
        add(m[i], t[j], t[k]);
      }
      if (cut == 2 && m[k] == no_index) {  // edges i and j are cut
        add(m[i], t[j], m[j]);
        add(t[i], m[i], m[j]);
        add(t[i], m[j], t[k]);
      }
    }
  }
  body.triangles = std::move(triangles);
  body.parent = std::move(parent);
  return true;
}

}  // namespace

AmbientBody ambient_body(const TargetSurface& target, double longest) {
  const Tessellation& cad = target.tessellation();
  AmbientBody body{cad.points, cad.triangles, {}};
  close_rims(body.points, body.triangles);
  for (std::size_t t = 0; t < body.triangles.size(); ++t) {
    body.parent.push_back(t < cad.triangles.size() ? static_cast<Index>(t) : no_index);
  }
  while (split_long_edges(body, longest)) {
  }
  return body;
}

std::array<std::vector<double>, 3> body_fractions(const VoxelGrid& grid, std::span<const Vec3> points,
                                                  std::span<const std::array<Index, 3>> triangles,
                                                  int samples) {
  std::array<std::vector<double>, 3> result;
  parallel_for(3, 1, [&](Offset begin, Offset end) {
    for (auto axis = static_cast<int>(begin); axis < end; ++axis) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;
      const std::vector<double> us = column_positions(grid.lines[u], samples);
      const std::vector<double> vs = column_positions(grid.lines[v], samples);
      std::vector<std::vector<Crossing>> columns(us.size() * vs.size());
      for (const auto& t : triangles) {
        const Vec3 &a = points[t[0]], &b = points[t[1]], &c = points[t[2]];
        const auto [low_u, high_u] = std::minmax({a[u], b[u], c[u]});
        const auto [low_v, high_v] = std::minmax({a[v], b[v], c[v]});
        const auto first_u = std::lower_bound(us.begin(), us.end(), low_u) - us.begin();
        const auto first_v = std::lower_bound(vs.begin(), vs.end(), low_v) - vs.begin();
        for (auto i = first_u; i < static_cast<Offset>(us.size()) && us[i] <= high_u; ++i) {
          for (auto j = first_v; j < static_cast<Offset>(vs.size()) && vs[j] <= high_v; ++j) {
            const Vec2 at(us[i], vs[j]);
            const Vec2 pa = Vec2(a[u], a[v]) - at, pb = Vec2(b[u], b[v]) - at, pc = Vec2(c[u], c[v]) - at;
            const double wa = edge_side(pb, pc), wb = edge_side(pc, pa), wc = edge_side(pa, pb);
            const bool positive = wa > 0 && wb > 0 && wc > 0, negative = wa < 0 && wb < 0 && wc < 0;
            if (!positive && !negative) continue;
            const double z = (wa * a[axis] + wb * b[axis] + wc * c[axis]) / (wa + wb + wc);
            columns[i + static_cast<Offset>(us.size()) * j].push_back({z, positive ? -1 : 1});
          }
        }
      }
      std::vector<double>& fraction = result[axis];
      fraction.assign(static_cast<std::size_t>(grid.cell_count()), 0);
      std::vector<int> counted(fraction.size(), 0);
      const std::vector<double>& lines = grid.lines[axis];
      for (Index j = 0; j < static_cast<Index>(vs.size()); ++j) {
        for (Index i = 0; i < static_cast<Index>(us.size()); ++i) {
          std::vector<Crossing>& column = columns[i + static_cast<Offset>(us.size()) * j];
          std::sort(column.begin(), column.end(), [](const Crossing& p, const Crossing& q) {
            return std::tie(p.at, p.sign) < std::tie(q.at, q.sign);
          });
          int winding = 0;
          for (const Crossing& c : column) winding += c.sign;
          if (winding != 0) continue;
          std::array<Index, 3> cell{};
          cell[u] = i / samples;
          cell[v] = j / samples;
          const auto add = [&](double enter, double leave) {
            for (Index k = 0; k < grid.cells(axis); ++k) {
              const double from = std::max(enter, lines[k]), to = std::min(leave, lines[k + 1]);
              if (to <= from) continue;
              cell[axis] = k;
              const bool whole = enter > lines[k] && leave < lines[k + 1];
              fraction[grid.cell(cell)] += whole ? 1 : (to - from) / (lines[k + 1] - lines[k]);
            }
          };
          double enter = 0;
          for (const Crossing& c : column) {
            const int before = winding;
            winding += c.sign;
            if (before == 0) enter = c.at;
            if (before != 0 && winding == 0) add(enter, c.at);
          }
          for (cell[axis] = 0; cell[axis] < grid.cells(axis); ++cell[axis]) ++counted[grid.cell(cell)];
        }
      }
      for (std::size_t c = 0; c < fraction.size(); ++c) {
        fraction[c] = counted[c] > 0 ? std::min(1.0, fraction[c] / counted[c]) : 0;
      }
    }
  });
  return result;
}

}  // namespace flowcage
