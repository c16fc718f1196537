#include "core/mesh/hex_adjacency.hpp"

#include <fmt/format.h>

#include <atomic>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

constexpr Offset point_grain = 8192;
constexpr std::uint32_t half_faces_at_once = 8'000'000;  // 128 MB

// A face of one cell, or a boundary quad, filed under its smallest point. The three other points identify it:
// the one diagonally opposite and the two beside it.
struct HalfFace {
  Index opposite, low, high;
  std::uint32_t id;  // 6 cell + face, or 6 #cells + boundary quad

  bool same_face(const HalfFace& b) const { return opposite == b.opposite && low == b.low && high == b.high; }
  bool operator<(const HalfFace& b) const {
    if (opposite != b.opposite) return opposite < b.opposite;
    if (low != b.low) return low < b.low;
    if (high != b.high) return high < b.high;
    return id < b.id;
  }
};

std::pair<Index, HalfFace> key_of(const std::array<Index, 4>& quad, std::uint32_t id) {
  int first = 0;
  for (int i = 1; i < 4; ++i) {
    if (quad[i] < quad[first]) first = i;
  }
  const auto [low, high] = std::minmax(quad[(first + 1) % 4], quad[(first + 3) % 4]);
  return {quad[first], HalfFace{quad[(first + 2) % 4], low, high, id}};
}

class Matcher {
 public:
  explicit Matcher(const HexView& mesh) : mesh_(mesh), cells_(mesh.cell_count()) {
    for (const BoundaryPatch& patch : mesh.patches()) {
      quads_.insert(quads_.end(), patch.quads.begin(), patch.quads.end());
    }
    const Offset half_faces = 6 * cells_ + static_cast<Offset>(quads_.size());
    if (half_faces >= Offset{std::numeric_limits<std::uint32_t>::max()} ||
        static_cast<Offset>(mesh.points().size()) > std::numeric_limits<Index>::max()) {
      throw Error(ErrorKind::input,
                  fmt::format("{} cells are more than 32-bit face numbers can hold", cells_),
                  "split the mesh, or make it coarser");
    }
  }

  FaceMatching run() {
    result_.adjacency.across.assign(static_cast<std::size_t>(6 * cells_), uncovered_face);
    result_.adjacency.boundary_owner.assign(quads_.size(), no_index);
    count_half_faces();
    const Index points = static_cast<Index>(mesh_.points().size());
    for (Index begin = 0; begin < points;) {
      std::uint32_t total = 0;
      Index end = begin;
      while (end < points && (end == begin || total + count_[end] <= half_faces_at_once)) {
        total += count_[end++];
      }
      match_range(begin, end, total);
      begin = end;
    }
    std::sort(result_.uncovered.begin(), result_.uncovered.end());
    return std::move(result_);
  }

 private:
  void check_range(Index point, const char* what, Offset number) const {
    if (point >= 0 && point < static_cast<Index>(mesh_.points().size())) return;
    throw Error(ErrorKind::input,
                fmt::format("{} {} uses point {}, but there are {} points", what, number, point,
                            mesh_.points().size()),
                "write the mesh again with the program that made it");
  }

  // How many half-faces each point files, and between which points those of a batch of cells lie.
  void count_half_faces() {
    count_.assign(mesh_.points().size(), 0);
    batch_points_.resize(static_cast<std::size_t>((cells_ + cell_grain - 1) / cell_grain));
    parallel_for(cells_, cell_grain, [&](Offset begin, Offset end) {
      Index low = std::numeric_limits<Index>::max(), high = no_index;
      visit_cells(mesh_, begin, end, [&](Offset c, const HexPoints& cell) {
        for (const Index p : cell) check_range(p, "cell", c);
        for (int f = 0; f < 6; ++f) {
          const auto quad = face_points(cell, f);
          const Index least = std::min({quad[0], quad[1], quad[2], quad[3]});
          std::atomic_ref(count_[least]).fetch_add(1, std::memory_order_relaxed);
          low = std::min(low, least);
          high = std::max(high, least);
        }
      });
      batch_points_[static_cast<std::size_t>(begin / cell_grain)] = {low, high};
    });
    for (std::size_t q = 0; q < quads_.size(); ++q) {
      for (const Index p : quads_[q]) check_range(p, "boundary quad", static_cast<Offset>(q));
      ++count_[*std::min_element(quads_[q].begin(), quads_[q].end())];
    }
  }

  // Files and pairs the half-faces whose smallest point is in [begin, end).
  void match_range(Index begin, Index end, std::uint32_t total) {
    std::vector<std::uint32_t> start(static_cast<std::size_t>(end - begin) + 1, 0);
    for (Index p = begin; p < end; ++p) start[p - begin + 1] = start[p - begin] + count_[p];
    std::vector<std::uint32_t> cursor(start.begin(), start.end() - 1);
    std::vector<HalfFace> filed(total);
    parallel_for(cells_, cell_grain, [&](Offset first, Offset last) {
      const auto [low, high] = batch_points_[static_cast<std::size_t>(first / cell_grain)];
      if (high < begin || low >= end) return;
      visit_cells(mesh_, first, last, [&](Offset c, const HexPoints& cell) {
        for (int f = 0; f < 6; ++f) {
          const auto [least, half] = key_of(face_points(cell, f), static_cast<std::uint32_t>(6 * c + f));
          if (least < begin || least >= end) continue;
          filed[std::atomic_ref(cursor[least - begin]).fetch_add(1, std::memory_order_relaxed)] = half;
        }
      });
    });
    for (std::size_t q = 0; q < quads_.size(); ++q) {
      const auto [least, half] = key_of(quads_[q], static_cast<std::uint32_t>(6 * cells_ + Offset(q)));
      if (least >= begin && least < end) filed[cursor[least - begin]++] = half;
    }
    using Found = std::pair<Offset, std::vector<Offset>>;  // internal faces, uncovered
    const Found found = parallel_reduce(
        end - begin, point_grain, Found{},
        [&](Offset first, Offset last) {
          Found part;
          for (Offset p = first; p < last; ++p)
            pair_at({filed.data() + start[p], start[p + 1] - start[p]}, part);
          return part;
        },
        [](Found a, const Found& b) {
          a.first += b.first;
          a.second.insert(a.second.end(), b.second.begin(), b.second.end());
          return a;
        });
    result_.adjacency.internal_faces += found.first;
    result_.uncovered.insert(result_.uncovered.end(), found.second.begin(), found.second.end());
  }

  void pair_at(std::span<HalfFace> bucket, std::pair<Offset, std::vector<Offset>>& found) {
    std::sort(bucket.begin(), bucket.end());
    const auto first_quad = static_cast<std::uint32_t>(6 * cells_);
    for (std::size_t i = 0; i < bucket.size();) {
      std::size_t end = i + 1;
      while (end < bucket.size() && bucket[end].same_face(bucket[i])) ++end;
      const std::uint32_t a = bucket[i].id;
      if (end - i > 2 || a >= first_quad) refuse(bucket.subspan(i, end - i));
      if (end - i == 1) {
        found.second.push_back(a);
      } else if (const std::uint32_t b = bucket[i + 1].id; b >= first_quad) {
        result_.adjacency.across[a] = ~static_cast<Index>(b - first_quad);
        result_.adjacency.boundary_owner[b - first_quad] = static_cast<Index>(a / 6);
      } else {
        result_.adjacency.across[a] = static_cast<Index>(b / 6);
        result_.adjacency.across[b] = static_cast<Index>(a / 6);
        ++found.first;
      }
      i = end;
    }
  }

  [[noreturn]] void refuse(std::span<const HalfFace> group) const {
    const auto first_quad = static_cast<std::uint32_t>(6 * cells_);
    const auto quads = std::count_if(group.begin(), group.end(), [&](auto h) { return h.id >= first_quad; });
    const auto cells = static_cast<std::ptrdiff_t>(group.size()) - quads;
    const Vec3 centre = (mesh_.points()[group[0].opposite] +
                         (mesh_.points()[group[0].low] + mesh_.points()[group[0].high]) / 2) /
                        2;
    const std::string what =
        quads == 0   ? fmt::format("a face is shared by {} cells", cells)
        : cells == 0 ? fmt::format("boundary quad {} is no cell's face", group[0].id - first_quad)
        : cells == 2 ? fmt::format("boundary quad {} lies between two cells", group[2].id - first_quad)
                     : fmt::format("a boundary face is listed {} times", quads);
    throw Error(ErrorKind::input, fmt::format("{}, near {}", what, place(centre)),
                "the mesh must be conforming, and each outer face must be in exactly one patch");
  }

  const HexView& mesh_;
  Offset cells_;
  std::vector<std::array<Index, 4>> quads_;
  std::vector<std::uint32_t> count_;
  std::vector<std::pair<Index, Index>> batch_points_;
  FaceMatching result_;
};

}  // namespace

FaceMatching match_faces(const HexView& mesh) {
  return Matcher(mesh).run();
}

void HexAdjacency::read_across(Offset begin, std::span<CellNeighbours> out) const {
  if (blocks) {
    blocks->read_across(begin, out);
    return;
  }
  const Index* at = across.data() + 6 * begin;
  for (CellNeighbours& cell : out) {
    std::copy_n(at, 6, cell.begin());
    at += 6;
  }
}

HexAdjacency build_hex_adjacency(const HexView& mesh) {
  if (const auto* blocks = dynamic_cast<const BlockMesh*>(&mesh)) {
    HexAdjacency adjacency;
    adjacency.blocks = std::make_shared<const BlockAdjacency>(*blocks);
    for (const BoundaryPatch& patch : mesh.patches()) {
      adjacency.boundary_owner.insert(adjacency.boundary_owner.end(), patch.owner.begin(), patch.owner.end());
    }
    adjacency.internal_faces = (6 * mesh.cell_count() - adjacency.boundary_faces()) / 2;
    return adjacency;
  }
  FaceMatching matching = match_faces(mesh);
  if (!matching.uncovered.empty()) {
    const Offset half = matching.uncovered.front();
    HexPoints cell;
    mesh.read_cells(half / 6, {&cell, 1});
    Vec3 centre = Vec3::Zero();
    for (const Index p : face_points(cell, static_cast<int>(half % 6))) centre += mesh.points()[p] / 4;
    throw Error(ErrorKind::input,
                fmt::format("{} outer faces belong to no patch; one is at {}, of cell {}",
                            matching.uncovered.size(), place(centre), half / 6),
                "each outer face must be in exactly one patch");
  }
  return std::move(matching.adjacency);
}

}  // namespace flowcage
