#include "core/limit/quad_blocks.hpp"

#include <algorithm>
#include <array>
#include <cassert>

#include "core/base/error.hpp"
#include "core/limit/limit_masks.hpp"
#include "core/mesh/mirror.hpp"

// A region is the set of faces that borders enclose. Regular vertices only inside, so by the theorem of Gauss
// and Bonnet the number of its corners (one face between two borders) is four times its Euler number once no
// border bends inward: a rectangle has 4, a closed strip or a torus none.

namespace flowcage {
namespace {

// A side of a face: from its corner `side` to the next.
struct Side {
  Index face = no_index, side = 0;
};

class Partition {
 public:
  explicit Partition(const SurfaceLevel& level)
      : level_(level),
        irregular_(irregular_corners(level)),
        feature_(level.edge_vertices.size()),
        border_(level.edge_vertices.size()),
        reached_(static_cast<std::size_t>(level.vertex_count())) {
    for (Index e = 0; e < level.edge_count(); ++e) {
      const auto [a, b] = level.edge_faces[e];
      feature_[e] =
          b == no_index || level.edge_sharpness[e] > 0 || level.face_patch[a] != level.face_patch[b];
      if (feature_[e]) set_border(e);
    }
  }

  std::optional<std::vector<QuadBlock>> run() {
    trace(tracks_from_irregular_vertices());
    label();
    while (cut_closed_regions()) label();
    build_blocks();
    while (const std::optional<Cut> cut = find_self_contact()) {
      if (cut->too_coarse) return std::nullopt;
      split(*cut);
    }
    while (join_longest_side()) {
    }
    std::vector<QuadBlock> used;
    for (QuadBlock& block : blocks_) {
      if (!block.faces.empty()) used.push_back(std::move(block));
    }
    return used;
  }

 private:
  struct Track {
    Index vertex, edge;  // goes on from the vertex along the edge
  };
  struct Cut {
    Index block = 0;
    bool across_u = true;
    bool too_coarse = false;
  };
  enum BlockSide { bottom, right, top, left };

  void set_border(Index e) {
    border_[e] = 1;
    for (const Index v : level_.edge_vertices[e]) reached_[v] = 1;
  }
  Side across(const Side& at) const {
    const Index e = level_.face_edges[at.face][at.side % 4];
    const auto& faces = level_.edge_faces[e];
    const Index other = faces[faces[0] == at.face ? 1 : 0];
    if (other == no_index) return {};
    const auto row = level_.face_edges[other];
    return {other, static_cast<Index>(std::find(row.begin(), row.end(), e) - row.begin())};
  }

  // All inner edges of sectors (between borders) that are irregular or bend inward.
  std::vector<Track> tracks_from_irregular_vertices() {
    std::vector<Track> tracks;
    std::vector<Index> borders;
    for (Index v = 0; v < level_.vertex_count(); ++v) {
      const auto edges = level_.vertex_edges[v];
      const auto faces = level_.vertex_faces[v];
      const Index n = static_cast<Index>(edges.size());
      borders.clear();
      for (Index i = 0; i < n; ++i) {
        if (border_[edges[i]]) borders.push_back(i);
      }
      const bool closed = faces.size() == edges.size();
      const bool bare = borders.empty();
      if (bare) borders.push_back(0);
      for (std::size_t k = 0; k < borders.size(); ++k) {
        const bool last = k + 1 == borders.size();
        if (last && !closed) break;
        const Index first = borders[k], end = last ? borders[0] + n : borders[k + 1];
        bool stop = !bare && end - first > 2;
        for (Index i = first; i < end; ++i) stop = stop || is_irregular(faces[i % n], v);
        if (!stop) continue;
        for (Index i = first + (bare ? 0 : 1); i < end; ++i) tracks.push_back({v, edges[i % n]});
        reached_[v] = 1;
      }
    }
    return tracks;
  }
  bool is_irregular(Index face, Index vertex) const {
    const auto row = level_.face_vertices[face];
    return irregular_[level_.face_vertices.offsets[face] +
                      (std::find(row.begin(), row.end(), vertex) - row.begin())];
  }

  // All tracks step by step, each until it meets a border.
  void trace(std::vector<Track> tracks) {
    while (!tracks.empty()) {
      std::vector<Track> next;
      for (const Track& track : tracks) {
        if (border_[track.edge]) continue;
        const auto [a, b] = level_.edge_vertices[track.edge];
        const Index end = a == track.vertex ? b : a;
        const bool stops = reached_[end];
        set_border(track.edge);
        if (stops) continue;
        const auto ring = level_.vertex_edges[end];
        assert(ring.size() == 4);
        const auto at = std::find(ring.begin(), ring.end(), track.edge) - ring.begin();
        next.push_back({end, ring[(at + 2) % 4]});
      }
      tracks = std::move(next);
    }
  }

  void label() {
    region_.assign(static_cast<std::size_t>(level_.face_count()), no_index);
    corners_.clear();
    std::vector<Index> stack;
    for (Index seed = 0; seed < level_.face_count(); ++seed) {
      if (region_[seed] != no_index) continue;
      const Index region = static_cast<Index>(corners_.size());
      corners_.push_back(0);
      region_[seed] = region;
      stack.push_back(seed);
      while (!stack.empty()) {
        const Index face = stack.back();
        stack.pop_back();
        for (Index side = 0; side < 4; ++side) {
          if (border_[level_.face_edges[face][side]]) {
            corners_[region] += is_corner(face, side);
            continue;
          }
          const Index other = across({face, side}).face;
          if (region_[other] != no_index) continue;
          region_[other] = region;
          stack.push_back(other);
        }
      }
    }
  }
  // Whether the face lies alone between two borders at its corner.
  bool is_corner(Index face, Index corner) const {
    const auto edges = level_.face_edges[face];
    return border_[edges[corner]] && border_[edges[(corner + 3) % 4]];
  }

  // A line across each closed strip, a first line into each torus.
  bool cut_closed_regions() {
    std::vector<Track> tracks;
    std::vector<Index> start(corners_.size(), no_index), at_border(corners_.size(), no_index);
    for (Index f = 0; f < level_.face_count(); ++f) {
      const Index region = region_[f];
      if (corners_[region] != 0) continue;
      if (start[region] == no_index) start[region] = 4 * f;
      for (Index side = 0; side < 4 && at_border[region] == no_index; ++side) {
        if (border_[level_.face_edges[f][side]]) at_border[region] = 4 * f + (side + 1) % 4;
      }
    }
    for (std::size_t region = 0; region < corners_.size(); ++region) {
      if (start[region] == no_index) continue;
      const Index code = at_border[region] == no_index ? start[region] : at_border[region];
      const Index face = code / 4, side = code % 4;
      const Index vertex = level_.face_vertices[face][side];
      tracks.push_back({vertex, level_.face_edges[face][side]});
      reached_[vertex] = 1;
    }
    const bool any = !tracks.empty();
    trace(std::move(tracks));
    return any;
  }

  void build_blocks() {
    blocks_.assign(corners_.size(), {});
    for (Index f = 0; f < level_.face_count(); ++f) {
      QuadBlock& block = blocks_[region_[f]];
      for (Index c = 0; c < 4 && block.faces.empty(); ++c) {
        if (is_corner(f, c)) block = grow({f, c});
      }
    }
    std::size_t count = 0;
    for (const QuadBlock& block : blocks_) count += block.faces.size();
    if (count != static_cast<std::size_t>(level_.face_count())) {
      throw Error(ErrorKind::internal, "blocks of the surface: a region is no rectangle",
                  "report this cage as a defect");
    }
  }

  // The rectangle from its lower left corner.
  QuadBlock grow(const Side& corner) const {
    QuadBlock block;
    block.patch = level_.face_patch[corner.face];
    for (Side row = corner; row.face != no_index;) {
      ++block.count_v;
      Index count = 0;
      for (Side at = row;;) {
        block.faces.push_back(at.face);
        block.turns.push_back(static_cast<std::uint8_t>(at.side));
        ++count;
        const Side right_side{at.face, (at.side + 1) % 4};
        if (border_[level_.face_edges[at.face][right_side.side]]) break;
        const Side next = across(right_side);
        at = {next.face, (next.side + 1) % 4};
      }
      if (block.count_v > 1 && count != block.count_u) return {};
      block.count_u = count;
      const Side top_side{row.face, (row.side + 2) % 4};
      row = border_[level_.face_edges[row.face][top_side.side]] ? Side{} : across(top_side);
    }
    return block;
  }

  // The k-th face side of a side of a block, counter-clockwise round it.
  static Index side_length(const QuadBlock& block, int side) {
    return side % 2 == 0 ? block.count_u : block.count_v;
  }
  static Side side_of(const QuadBlock& block, int side, Index k) {
    const Index last_u = block.count_u - 1, last_v = block.count_v - 1;
    const std::array<std::array<Index, 2>, 4> places{
        {{k, 0}, {last_u, k}, {last_u - k, last_v}, {0, last_v - k}}};
    const Index cell = places[side][0] + block.count_u * places[side][1];
    return {block.faces[cell], (block.turns[cell] + side) % 4};
  }

  // Where a block meets itself, and the cut through its middle that parts the two places.
  std::optional<Cut> find_self_contact() const {
    std::vector<int> side_at(level_.edge_vertices.size(), -1);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      const QuadBlock& block = blocks_[b];
      for (int side = bottom; side <= left; ++side) {
        for (Index k = 0; k < side_length(block, side); ++k) {
          const Side at = side_of(block, side, k);
          const Index e = level_.face_edges[at.face][at.side];
          const int code = static_cast<int>(4 * b) + side;
          if (side_at[e] < 0 || side_at[e] / 4 != static_cast<int>(b)) {
            side_at[e] = code;
            continue;
          }
          const int other = side_at[e] % 4;
          // Opposite sides are parted by a cut between them, one side that is folded by a cut across itself.
          bool across_u = side % 2 == 1;
          if (other == side) across_u = !across_u;
          if ((other + side) % 2 == 1) across_u = block.count_u >= block.count_v;
          if ((across_u ? block.count_u : block.count_v) < 2) across_u = !across_u;
          return Cut{static_cast<Index>(b), across_u, (across_u ? block.count_u : block.count_v) < 2};
        }
      }
    }
    return std::nullopt;
  }

  void split(const Cut& cut) {
    const QuadBlock whole = std::move(blocks_[cut.block]);
    const Index count = cut.across_u ? whole.count_u : whole.count_v;
    const Index middle = count / 2;
    QuadBlock low, high;
    low.patch = high.patch = whole.patch;
    low.count_u = high.count_u = whole.count_u;
    low.count_v = high.count_v = whole.count_v;
    (cut.across_u ? low.count_u : low.count_v) = middle;
    (cut.across_u ? high.count_u : high.count_v) = count - middle;
    for (Index j = 0; j < whole.count_v; ++j) {
      for (Index i = 0; i < whole.count_u; ++i) {
        const Index cell = i + whole.count_u * j, at = cut.across_u ? i : j;
        QuadBlock& part = at < middle ? low : high;
        part.faces.push_back(whole.faces[cell]);
        part.turns.push_back(whole.turns[cell]);
        if (at == middle) {
          set_border(level_.face_edges[whole.faces[cell]][(whole.turns[cell] + (cut.across_u ? 3 : 0)) % 4]);
        }
        if (at >= middle) region_[whole.faces[cell]] = static_cast<Index>(blocks_.size());
      }
    }
    blocks_[cut.block] = std::move(low);
    blocks_.push_back(std::move(high));
  }

  // The block beyond a whole side, if both may be one block.
  Index partner(Index b, int side) const {
    const QuadBlock& block = blocks_[b];
    const Index length = side_length(block, side);
    Index other = no_index;
    for (Index k = 0; k < length; ++k) {
      const Side at = side_of(block, side, k);
      if (feature_[level_.face_edges[at.face][at.side]]) return no_index;
      const Index beyond = region_[across(at).face];
      if (k == 0) other = beyond;
      if (beyond != other) return no_index;
    }
    const std::array<Side, 2> ends{side_of(block, side, 0), side_of(block, side, length - 1)};
    // Both ends become the middle of a straight side: no corner of the other block may be missing there, and
    // nothing irregular may lie there.
    const auto corner_is_free = [&](const Side& at, Index corner) {
      return is_corner(at.face, corner % 4) &&
             irregular_[level_.face_vertices.offsets[at.face] + corner % 4] == 0;
    };
    const Side first = across(ends[0]), last = across(ends[1]);
    if (!corner_is_free(ends[0], ends[0].side) || !corner_is_free(ends[1], ends[1].side + 1) ||
        !corner_is_free(first, first.side + 1) || !corner_is_free(last, last.side)) {
      return no_index;
    }
    return touches_itself(b, other, length) ? no_index : other;
  }
  // Whether two blocks meet in more than the shared side.
  bool touches_itself(Index b, Index other, Index shared) const {
    Index contacts = 0;
    const QuadBlock& block = blocks_[b];
    for (int side = bottom; side <= left; ++side) {
      for (Index k = 0; k < side_length(block, side); ++k) {
        const Side beyond = across(side_of(block, side, k));
        contacts += beyond.face != no_index && region_[beyond.face] == other;
      }
    }
    return contacts != shared;
  }

  bool join_longest_side() {
    Index best = no_index, best_length = 0, best_other = no_index;
    int best_side = 0;
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      for (int side = bottom; side <= left && !blocks_[b].faces.empty(); ++side) {
        if (side_length(blocks_[b], side) <= best_length) continue;
        const Index other = partner(static_cast<Index>(b), side);
        if (other == no_index) continue;
        best = static_cast<Index>(b);
        best_other = other;
        best_side = side;
        best_length = side_length(blocks_[b], side);
      }
    }
    if (best == no_index) return false;
    for (Index k = 0; k < best_length; ++k) {
      const Side at = side_of(blocks_[best], best_side, k);
      border_[level_.face_edges[at.face][at.side]] = 0;
    }
    for (const Index face : blocks_[best_other].faces) region_[face] = best;
    const std::size_t size = blocks_[best].faces.size() + blocks_[best_other].faces.size();
    // The union's lower left corner is that of the block, or of its partner if that lies below or to the
    // left.
    const bool below = best_side == bottom || best_side == left;
    Side corner{blocks_[best].faces[0], blocks_[best].turns[0]};
    if (below) {
      // From the lower left face straight through the partner to its far side.
      Side at =
          across(side_of(blocks_[best], best_side, best_side == bottom ? 0 : blocks_[best].count_v - 1));
      while (!border_[level_.face_edges[at.face][(at.side + 2) % 4]]) {
        at = across({at.face, (at.side + 2) % 4});
      }
      // `at` was entered by its top (bottom) or right (left) side.
      corner = {at.face, (at.side + (best_side == bottom ? 2 : 3)) % 4};
    }
    blocks_[best] = grow(corner);
    blocks_[best_other] = {};
    if (blocks_[best].faces.size() != size) {
      throw Error(ErrorKind::internal, "blocks of the surface: two rectangles made none",
                  "report this cage as a defect");
    }
    return true;
  }

  const SurfaceLevel& level_;
  std::vector<char> irregular_;         // by face corner
  std::vector<char> feature_, border_;  // by edge; features are borders for good
  std::vector<char> reached_;           // by vertex: a border or a track's start
  std::vector<Index> region_;           // by face: number of its block
  std::vector<Index> corners_;          // by region
  std::vector<QuadBlock> blocks_;       // joined ones are empty
};

}  // namespace

std::vector<char> irregular_corners(const SurfaceLevel& level) {
  const MirrorExtension extension(level);
  const SurfaceLevel& around = extension.level();
  std::vector<char> irregular(level.face_vertices.values.size(), 0);
  std::vector<double> sharpness;
  std::vector<int> sharp;
  std::vector<SmoothSector> sectors;
  for (Index v = 0; v < level.vertex_count(); ++v) {
    const auto edges = around.vertex_edges[v];
    const auto faces = around.vertex_faces[v];
    sharpness.clear();
    sharp.clear();
    for (std::size_t i = 0; i < edges.size(); ++i) {
      sharpness.push_back(around.edge_sharpness[edges[i]]);
      if (sharpness.back() > 0) sharp.push_back(static_cast<int>(i));
    }
    const LimitRing ring{vertex_rule(level.vertex_sharpness[v], sharpness), static_cast<int>(edges.size()),
                         static_cast<int>(faces.size()), sharp};
    list_sectors(ring, sectors);
    for (const SmoothSector& sector : sectors) {
      if (is_regular(ring, sector)) continue;
      for (int k = 0; k < sector.face_count; ++k) {
        const Index face = faces[(sector.first_edge + k) % ring.edge_count];
        if (!extension.is_own_face(face)) continue;
        const auto row = level.face_vertices[face];
        irregular[level.face_vertices.offsets[face] + (std::find(row.begin(), row.end(), v) - row.begin())] =
            1;
      }
    }
  }
  return irregular;
}

std::optional<std::vector<QuadBlock>> partition_into_blocks(const SurfaceLevel& level) {
  return Partition(level).run();
}

}  // namespace flowcage
