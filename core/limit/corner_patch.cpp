#include "core/limit/corner_patch.hpp"

#include <cmath>
#include <optional>
#include <tuple>

#include "core/limit/limit_masks.hpp"

// Notation as in the header. Once refined, the points near the quad lie on a grid of half steps: child grid
// point (x,y) is at parent (x/2, y/2). The child quads of the quad are numbered by the parent corner they
// keep: 0 at P, 1 at E[k], 2 at F[k], 3 at E[k+1].

namespace flowcage {
namespace {

using Eigen::MatrixXd;
using Eigen::RowVectorXd;

enum OuterPoint { c0, a0, b0, d, b1, a1, c1, outer_count };

int wrap(int i, int n) {
  return (i % n + n) % n;
}

// Places of control points in a shape's order.
class Places {
 public:
  explicit Places(const PatchShape& shape) : shape_(shape) {}
  int edge(int i) const { return 1 + wrap(i, shape_.edge_count); }
  int face(int i) const { return 1 + shape_.edge_count + wrap(i, shape_.face_count); }
  int outer(OuterPoint point) const { return 1 + shape_.edge_count + shape_.face_count + point; }
  // Grid points -1 .. 2 round the quad. Precondition: P's ring is a grid there.
  int grid(int x, int y) const {
    const int k = shape_.face;
    if (x == 2) return outer(std::array{c0, a0, b0, d}[y + 1]);
    if (y == 2) return outer(std::array{c1, a1, b1}[x + 1]);
    if (x == 1) return y == 0 ? edge(k) : face(y == 1 ? k : k - 1);
    if (x == 0) return y == 0 ? 0 : edge(y == 1 ? k + 1 : k - 1);
    return y == 0 ? edge(k + 2) : face(y == 1 ? k + 1 : k + 2);
  }

 private:
  const PatchShape& shape_;
};

// Bicubic B-spline weights of position and derivatives by x and y in the cell [0,1]^2 of the grid -1 .. 2.
struct BicubicRows {
  std::array<std::array<std::array<double, 4>, 4>, 3> weight;  // [row][x + 1][y + 1]

  BicubicRows(double x, double y) {
    const auto [bx, dx] = cubic(x);
    const auto [by, dy] = cubic(y);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        weight[0][i][j] = bx[i] * by[j];
        weight[1][i][j] = dx[i] * by[j];
        weight[2][i][j] = bx[i] * dy[j];
      }
    }
  }
  // A crease along y = 0: points beyond it are 2 Q(x,0) - Q(x,1), whatever lies there.
  void fold_bottom() {
    for (auto& row : weight) {
      for (auto& column : row) {
        column[1] += 2 * column[0];
        column[2] -= column[0];
        column[0] = 0;
      }
    }
  }
  void fold_left() {
    for (auto& row : weight) {
      for (int j = 0; j < 4; ++j) {
        row[1][j] += 2 * row[0][j];
        row[2][j] -= row[0][j];
        row[0][j] = 0;
      }
    }
  }

 private:
  static std::pair<std::array<double, 4>, std::array<double, 4>> cubic(double x) {
    const double y = 1 - x;
    return {{y * y * y / 6, (4 - 6 * x * x + 3 * x * x * x) / 6, (4 - 6 * y * y + 3 * y * y * y) / 6,
             x * x * x / 6},
            {-y * y / 2, (-4 * x + 3 * x * x) / 2, (4 * y - 3 * y * y) / 2, x * x / 2}};
  }
};

bool is_semi_sharp(const PatchShape& shape) {
  const auto semi = [](double s) { return s > 0 && s < infinitely_sharp; };
  return semi(shape.vertex_sharpness) ||
         std::any_of(shape.edge_sharpness.begin(), shape.edge_sharpness.end(), semi);
}

std::vector<int> sharp_edges_of(const PatchShape& shape) {
  std::vector<int> sharp;
  for (int i = 0; i < shape.edge_count; ++i) {
    if (shape.edge_sharpness[i] > 0) sharp.push_back(i);
  }
  return sharp;
}

LimitRing ring_of(const PatchShape& shape, const std::vector<int>& sharp_edges) {
  return {vertex_rule(shape.vertex_sharpness, shape.edge_sharpness), shape.edge_count, shape.face_count,
          sharp_edges};
}

// The smooth sector that holds the quad.
SmoothSector sector_of(const PatchShape& shape, const LimitRing& ring) {
  std::vector<SmoothSector> sectors;
  list_sectors(ring, sectors);
  for (const SmoothSector& sector : sectors) {
    if (wrap(shape.face - sector.first_edge, shape.edge_count) < sector.face_count) return sector;
  }
  return sectors.front();
}

// Whether P makes no difference: the whole quad is one bicubic, possibly with creases along its sides.
bool is_bicubic(const PatchShape& shape) {
  const std::vector<int> sharp = sharp_edges_of(shape);
  const LimitRing ring = ring_of(shape, sharp);
  return is_regular(ring, sector_of(shape, ring));
}

PatchRows bicubic_rows(const PatchShape& shape, double s, double t) {
  const Places place(shape);
  BicubicRows bicubic(s, t);
  if (shape.edge_sharpness[shape.face] > 0) bicubic.fold_bottom();
  if (shape.edge_sharpness[wrap(shape.face + 1, shape.edge_count)] > 0) bicubic.fold_left();
  PatchRows rows = PatchRows::Zero(3, shape.point_count());
  for (int r = 0; r < 3; ++r) {
    for (int x = -1; x <= 2; ++x) {
      for (int y = -1; y <= 2; ++y) {
        const double weight = bicubic.weight[r][x + 1][y + 1];
        if (weight != 0) rows(r, place.grid(x, y)) += weight;
      }
    }
  }
  return rows;
}

// Rows of refined points over a shape's points.
class Refinement {
 public:
  explicit Refinement(const PatchShape& shape)
      : shape_(shape),
        place_(shape),
        closed_(shape.face_count == shape.edge_count),
        has_c0_(closed_ || shape.face > 0),
        has_c1_(closed_ || shape.face + 1 < shape.face_count) {}

  // The same shape's points of the next level.
  MatrixXd own_points() const {
    const int n = shape_.edge_count, count = shape_.point_count();
    MatrixXd rows = MatrixXd::Zero(count, count);
    const VertexMask mask = vertex_mask(shape_.vertex_sharpness, shape_.edge_sharpness);
    rows(0, 0) = mask.vertex;
    for (int i = 0; i < n && mask.edge != 0; ++i) rows(0, place_.edge(i)) += mask.edge;
    for (int i = 0; i < shape_.face_count; ++i) {
      rows.row(place_.face(i)) = ring_face(i);
      rows.row(0) += mask.face * ring_face(i);
    }
    if (mask.crease != 0) {
      for (const int i : mask.crease_edges) rows(0, place_.edge(i)) += mask.crease;
    }
    for (int i = 0; i < n; ++i) {
      const EdgeMask edge = edge_mask(shape_.edge_sharpness[i]);
      auto row = rows.row(place_.edge(i));
      row(0) += edge.end;
      row(place_.edge(i)) += edge.end;
      if (edge.face != 0) row += edge.face * (ring_face(wrap(i - 1, n)) + ring_face(i));
    }
    for (int outer = 0; outer < outer_count; ++outer) {
      constexpr std::array<std::array<int, 2>, outer_count> at{
          {{2, -1}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {-1, 2}}};
      rows.row(place_.outer(static_cast<OuterPoint>(outer))) = grid_point(at[outer][0], at[outer][1]);
    }
    return rows;
  }

  // The point of the child grid at (x,y), which is no point of P's ring but perhaps a corner of the quad.
  // Zero where it lies beyond a boundary.
  RowVectorXd grid_point(int x, int y) const {
    const int k = shape_.face;
    const int e = place_.edge(k), f = place_.face(k), g = place_.edge(k + 1);
    const auto outer = [&](OuterPoint point) { return place_.outer(point); };
    const RowVectorXd quad = centroid({0, e, f, g});
    const RowVectorXd right = centroid({e, outer(a0), outer(b0), f});
    const RowVectorXd top = centroid({g, f, outer(b1), outer(a1)});
    const RowVectorXd diagonal = centroid({f, outer(b0), outer(d), outer(b1)});
    const double along_e = shape_.edge_sharpness[k];
    const double along_g = shape_.edge_sharpness[wrap(k + 1, shape_.edge_count)];
    switch (8 * x + y) {
      case 8 * 1 + 0:
        return edge_point({0, e}, along_e, quad, lower_face());
      case 8 * 0 + 1:
        return edge_point({0, g}, along_g, quad, left_face());
      case 8 * 1 + 1:
        return quad;
      case 8 * 2 - 1:
        if (!has_c0_) break;
        return edge_point({e, place_.face(k - 1)}, 0, lower_face(), far_lower_face());
      case 8 * 2 + 0:
        return vertex_on_edge({0, e, outer(a0)}, along_e, {quad, right, lower_face(), far_lower_face()});
      case 8 * 2 + 1:
        return edge_point({e, f}, 0, quad, right);
      case 8 * 2 + 2:
        return smooth_vertex(f, {e, outer(b0), outer(b1), g}, {quad, right, diagonal, top});
      case 8 * 1 + 2:
        return edge_point({f, g}, 0, quad, top);
      case 8 * 0 + 2:
        return vertex_on_edge({0, g, outer(a1)}, along_g, {quad, top, left_face(), far_left_face()});
      case 8 * -1 + 2:
        if (!has_c1_) break;
        return edge_point({g, place_.face(k + 1)}, 0, left_face(), far_left_face());
      case 8 * 3 - 1:
        return far_lower_face();
      case 8 * 3 + 0:
        return edge_point({e, outer(a0)}, along_e, right, far_lower_face());
      case 8 * 3 + 1:
        return right;
      case 8 * 3 + 2:
        return edge_point({f, outer(b0)}, 0, right, diagonal);
      case 8 * 3 + 3:
        return diagonal;
      case 8 * 2 + 3:
        return edge_point({f, outer(b1)}, 0, top, diagonal);
      case 8 * 1 + 3:
        return top;
      case 8 * 0 + 3:
        return edge_point({g, outer(a1)}, along_g, top, far_left_face());
      case 8 * -1 + 3:
        return far_left_face();
      default:
        break;
    }
    return RowVectorXd::Zero(shape_.point_count());
  }

 private:
  RowVectorXd centroid(const std::array<int, 4>& places) const {
    RowVectorXd row = RowVectorXd::Zero(shape_.point_count());
    for (const int place : places) row[place] += 0.25;
    return row;
  }
  RowVectorXd ring_face(int i) const {
    return centroid({0, place_.edge(i), place_.face(i), place_.edge(i + 1)});
  }
  RowVectorXd nothing() const { return RowVectorXd::Zero(shape_.point_count()); }
  RowVectorXd lower_face() const { return has_c0_ ? ring_face(shape_.face - 1) : nothing(); }
  RowVectorXd left_face() const { return has_c1_ ? ring_face(shape_.face + 1) : nothing(); }
  RowVectorXd far_lower_face() const {
    const int k = shape_.face;
    if (!has_c0_) return nothing();
    return centroid({place_.edge(k), place_.outer(a0), place_.outer(c0), place_.face(k - 1)});
  }
  RowVectorXd far_left_face() const {
    const int k = shape_.face;
    if (!has_c1_) return nothing();
    return centroid({place_.edge(k + 1), place_.outer(a1), place_.outer(c1), place_.face(k + 1)});
  }
  RowVectorXd edge_point(const std::array<int, 2>& ends, double sharpness, const RowVectorXd& face,
                         const RowVectorXd& other_face) const {
    const EdgeMask mask = edge_mask(sharpness);
    RowVectorXd row = mask.face * (face + other_face);
    for (const int end : ends) row[end] += mask.end;
    return row;
  }
  RowVectorXd smooth_vertex(int vertex, const std::array<int, 4>& edges,
                            const std::array<RowVectorXd, 4>& faces) const {
    const VertexMask mask = smooth_vertex_mask(4);
    RowVectorXd row = mask.face * (faces[0] + faces[1] + faces[2] + faces[3]);
    row[vertex] += mask.vertex;
    for (const int edge : edges) row[edge] += mask.edge;
    return row;
  }
  // The middle of three points along an edge of P: E[k] or E[k + 1], of valence 4, its other edges smooth.
  RowVectorXd vertex_on_edge(const std::array<int, 3>& along, double sharpness,
                             const std::array<RowVectorXd, 4>& faces) const {
    const VertexMask mask = vertex_mask(0, std::array<double, 4>{sharpness, 0, sharpness, 0});
    RowVectorXd row = mask.face * (faces[0] + faces[1] + faces[2] + faces[3]);
    row[along[1]] += mask.vertex;
    for (const int end : {along[0], along[2]}) row[end] += mask.edge + mask.crease;
    if (mask.edge != 0) {
      const int k = shape_.face;
      const int across = along[1] == place_.edge(k) ? place_.face(k - 1) : place_.face(k + 1);
      row[place_.face(k)] += mask.edge;
      row[across] += mask.edge;
    }
    return row;
  }

  const PatchShape& shape_;
  Places place_;
  bool closed_, has_c0_, has_c1_;
};

// The child grid -1 .. 3 round the quad, each point as a row over the shape's points.
class ChildGrid {
 public:
  explicit ChildGrid(const PatchShape& shape) {
    const Refinement refinement(shape);
    const Places place(shape);
    const MatrixXd own = refinement.own_points();
    const int k = shape.face;
    for (int x = -1; x <= 3; ++x) {
      for (int y = -1; y <= 3; ++y) {
        RowVectorXd& row = rows_[x + 1][y + 1];
        const bool ring_only = (x == -1 && y < 2) || (y == -1 && x < 2);
        if (!ring_only) row = x == 0 && y == 0 ? RowVectorXd(own.row(0)) : refinement.grid_point(x, y);
      }
    }
    const bool closed = shape.edge_count == shape.face_count;
    const auto own_row = [&](bool exists, int row) {
      return exists ? RowVectorXd(own.row(row)) : RowVectorXd(RowVectorXd::Zero(own.cols()));
    };
    const bool below = closed || k > 0, left = closed || k + 1 < shape.face_count;
    rows_[1][0] = own_row(below, place.edge(k - 1));
    rows_[2][0] = own_row(below, place.face(k - 1));
    rows_[0][1] = own_row(left, place.edge(k + 2));
    rows_[0][2] = own_row(left, place.face(k + 1));
    rows_[0][0] = RowVectorXd::Zero(own.cols());  // never part of a child quad that is away from P
  }
  const RowVectorXd& operator()(int x, int y) const { return rows_[x + 1][y + 1]; }

 private:
  std::array<std::array<RowVectorXd, 5>, 5> rows_;  // [x + 1][y + 1]
};

}  // namespace

bool PatchShape::operator<(const PatchShape& other) const {
  return std::tie(edge_count, face_count, face, vertex_sharpness, edge_sharpness) <
         std::tie(other.edge_count, other.face_count, other.face, other.vertex_sharpness,
                  other.edge_sharpness);
}

struct PatchShapes::Prepared {
  enum class Kind {
    bicubic,    // one bicubic
    stam,       // P is irregular, all sharpness is steady: eigenbasis
    semi_sharp  // something decays: refined once, then its children
  };
  PatchShape shape;
  Kind kind = Kind::bicubic;
  std::optional<ChildGrid> grid;         // but for bicubic
  std::optional<SpectralPowers> powers;  // stam
  PatchRows at_vertex;                   // stam
  MatrixXd own_points;                   // semi_sharp
  std::array<int, 4> children{};         // semi_sharp
};

PatchShapes::PatchShapes() = default;
PatchShapes::~PatchShapes() = default;
PatchShapes::PatchShapes(PatchShapes&&) noexcept = default;
PatchShapes& PatchShapes::operator=(PatchShapes&&) noexcept = default;

namespace {

// Position and tangents at P: ds toward E[k] and dt toward E[k + 1] where P is smooth, the pair of the
// quad's sector elsewhere.
PatchRows rows_at_vertex(const PatchShape& shape) {
  const std::vector<int> sharp = sharp_edges_of(shape);
  const LimitRing ring = ring_of(shape, sharp);
  RingWeights position, u, v;
  limit_position_mask(ring, position);
  if (ring.rule == VertexRule::smooth && ring.edge_count > 2) {
    RingWeights across;
    limit_tangent_masks(ring, {shape.face, ring.face_count}, u, across);
    limit_tangent_masks(ring, {wrap(shape.face + 1, ring.edge_count), ring.face_count}, v, across);
  } else {
    limit_tangent_masks(ring, sector_of(shape, ring), u, v);
  }
  PatchRows rows = PatchRows::Zero(3, shape.point_count());
  const Places place(shape);
  const std::array<const RingWeights*, 3> weights{&position, &u, &v};
  for (int r = 0; r < 3; ++r) {
    rows(r, 0) = weights[r]->vertex;
    for (int i = 0; i < shape.edge_count; ++i) rows(r, place.edge(i)) = weights[r]->edges[i];
    for (int i = 0; i < shape.face_count; ++i) rows(r, place.face(i)) = weights[r]->faces[i];
  }
  return rows;
}

// The child quad at parent corner 1, 2 or 3: its corner 0 is a vertex of valence 4 on an edge of P whose
// halves have the given sharpness, along the child's own second (corner 1) or first (corner 3) direction.
PatchShape shape_away_from_vertex(double sharpness, int corner) {
  PatchShape shape;
  shape.edge_sharpness.assign(4, 0);
  if (corner == 1) shape.edge_sharpness[1] = shape.edge_sharpness[3] = sharpness;
  if (corner == 3) shape.edge_sharpness[0] = shape.edge_sharpness[2] = sharpness;
  return shape;
}

// Child parameters (s,t) of the child quad at a corner as seen from the parent's (2s, 2t).
struct ChildPlace {
  int corner;
  double s, t;
};
ChildPlace child_at(double s, double t) {
  const double x = 2 * s, y = 2 * t;
  if (x <= 1 && y <= 1) return {0, x, y};
  if (y <= 1) return {1, y, 2 - x};
  if (x <= 1) return {3, 2 - y, x};
  return {2, 2 - x, 2 - y};
}
// Derivatives by the child's (s,t) to those by the parent's.
void turn_derivatives(int corner, PatchRows& rows) {
  const RowVectorXd ds = 2 * rows.row(1), dt = 2 * rows.row(2);
  rows.row(1) = corner == 0 ? ds : corner == 1 ? RowVectorXd(-dt) : corner == 2 ? RowVectorXd(-ds) : dt;
  rows.row(2) = corner == 0 ? dt : corner == 1 ? ds : corner == 2 ? RowVectorXd(-dt) : RowVectorXd(-ds);
}

}  // namespace

int PatchShapes::prepare(const PatchShape& shape) {
  const auto known = numbers_.find(shape);
  if (known != numbers_.end()) return known->second;
  auto entry = std::make_unique<Prepared>();
  entry->shape = shape;
  if (is_semi_sharp(shape)) {
    entry->kind = Prepared::Kind::semi_sharp;
    entry->grid.emplace(entry->shape);
    entry->own_points = Refinement(entry->shape).own_points();
    PatchShape next = shape;
    next.vertex_sharpness = decayed_sharpness(shape.vertex_sharpness);
    for (double& s : next.edge_sharpness) s = decayed_sharpness(s);
    const double along_e = next.edge_sharpness[shape.face];
    const double along_g = next.edge_sharpness[wrap(shape.face + 1, shape.edge_count)];
    entry->children = {prepare(next), prepare(shape_away_from_vertex(along_e, 1)),
                       prepare(shape_away_from_vertex(0, 2)), prepare(shape_away_from_vertex(along_g, 3))};
  } else if (!is_bicubic(shape)) {
    entry->kind = Prepared::Kind::stam;
    entry->grid.emplace(entry->shape);
    entry->powers.emplace(Refinement(entry->shape).own_points());
    entry->at_vertex = rows_at_vertex(shape);
  }
  const int number = static_cast<int>(prepared_.size());
  prepared_.push_back(std::move(entry));
  numbers_.emplace(shape, number);
  return number;
}

PatchRows PatchShapes::evaluate(int number, double s, double t) const {
  const Prepared& entry = *prepared_[number];
  const PatchShape& shape = entry.shape;
  if (entry.kind == Prepared::Kind::bicubic) return bicubic_rows(shape, s, t);

  if (entry.kind == Prepared::Kind::semi_sharp) {
    const ChildPlace at = child_at(s, t);
    const PatchRows child = evaluate(entry.children[at.corner], at.s, at.t);
    PatchRows rows = PatchRows::Zero(3, shape.point_count());
    if (at.corner == 0) {
      rows = child * entry.own_points;
    } else {
      // The child's grid steps (1,0) and (0,1) in steps of the parent's child grid.
      constexpr std::array<std::array<int, 2>, 4> corner{{{0, 0}, {2, 0}, {2, 2}, {0, 2}}};
      constexpr std::array<std::array<int, 2>, 4> along_s{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
      const PatchShape& child_shape = prepared_[entry.children[at.corner]]->shape;
      const Places place(child_shape);
      const auto [cx, cy] = corner[at.corner];
      const auto [sx, sy] = along_s[at.corner];
      for (int x = -1; x <= 2; ++x) {
        for (int y = -1; y <= 2; ++y) {
          const auto weights = child.col(place.grid(x, y));
          if (weights.isZero(0)) continue;
          rows += weights * (*entry.grid)(cx + x * sx - y * sy, cy + x * sy + y * sx);
        }
      }
    }
    turn_derivatives(at.corner, rows);
    return rows;
  }

  const double far = std::max(s, t);
  if (far <= 0) return entry.at_vertex;
  // After `steps` refinements the place is in one of the three child quads away from P, which are bicubics.
  const int steps = far >= 1 ? 0 : -std::ilogb(far) - 1;
  const double x = std::ldexp(s, steps + 1), y = std::ldexp(t, steps + 1);
  const int cell_x = x >= 1 ? 1 : 0, cell_y = y >= 1 ? 1 : 0;
  BicubicRows bicubic(x - cell_x, y - cell_y);
  if (cell_y == 0 && shape.edge_sharpness[shape.face] > 0) bicubic.fold_bottom();
  if (cell_x == 0 && shape.edge_sharpness[wrap(shape.face + 1, shape.edge_count)] > 0) bicubic.fold_left();
  PatchRows rows = PatchRows::Zero(3, shape.point_count());
  for (int r = 0; r < 3; ++r) {
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) {
        const double weight = bicubic.weight[r][i][j];
        if (weight != 0) rows.row(r) += weight * (*entry.grid)(cell_x + i - 1, cell_y + j - 1);
      }
    }
  }
  rows.row(0) = entry.powers->multiply(rows.row(0), {steps, 1, false});
  rows.bottomRows(2) = 2 * entry.powers->multiply(rows.bottomRows(2), {steps, 2, true});
  return rows;
}

}  // namespace flowcage
