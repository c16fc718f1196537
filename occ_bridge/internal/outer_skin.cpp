#include "occ_bridge/internal/outer_skin.hpp"

#include <BRep_Builder.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <cmath>

#include "occ_bridge/internal/face_edges.hpp"
#include "occ_bridge/internal/tessellate.hpp"

namespace flowcage::occ {

namespace {

constexpr std::size_t most_samples = 48;  // triangles of a piece, the largest
constexpr double pure = 0.98;             // of the area agrees: the rest is at the rim

struct Sample {
  Vec3 position, normal;
  double area = 0, height = 0;
};

Sample sample_of(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 cross = (b - a).cross(c - a);
  const double twice = cross.norm(), longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return {(a + b + c) / 3, twice > 0 ? Vec3(cross / twice) : Vec3::Zero(), 0.5 * twice,
          longest > 0 ? twice / longest : 0};
}

struct Verdict {
  double area = 0, hidden = 0, inward = 0;  ///< inward: the normal looks into a body
};

class Judge {
 public:
  Judge(const std::vector<Piece>& pieces, const std::vector<bool>& closed)
      : pieces_(pieces), closed_(closed) {
    TopoDS_Compound all;
    BRep_Builder builder;
    builder.MakeCompound(all);
    for (const Piece& piece : pieces) builder.Add(all, piece.face);
    mesh_ = collect_triangles(face_edges_of(all), 1);  // numbers the faces as the pieces are
    triangles_.resize(pieces.size());
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      triangles_[mesh_.triangle_face[t]].push_back(mesh_.triangles[t]);
    }
    for (std::size_t body = 0; body < closed.size(); ++body) {
      std::vector<std::array<Index, 3>> own;
      for (std::size_t p = 0; p < pieces.size(); ++p) {
        for (const PieceOwner& owner : pieces[p].owners) {
          if (owner.body != static_cast<Index>(body)) continue;
          for (auto triangle : triangles_[p]) {
            if (owner.side < 0) std::swap(triangle[1], triangle[2]);
            own.push_back(triangle);
          }
        }
      }
      close_rims(mesh_.points, own);
      trees_.push_back(build_winding_tree(mesh_.points, own));
    }
  }

  Verdict judge(std::size_t p) const {
    Verdict verdict;
    std::vector<Sample> samples;
    for (const auto& [a, b, c] : triangles_[p]) {
      samples.push_back(sample_of(mesh_.points[a], mesh_.points[b], mesh_.points[c]));
    }
    std::ranges::stable_sort(samples, std::ranges::greater{}, &Sample::area);
    if (samples.size() > most_samples) samples.resize(most_samples);
    for (const Sample& sample : samples) {
      constexpr double off = 1e-6;  // of the triangle's height: bodies may be near without touching
      const Vec3 step = off * sample.height * sample.normal;
      const Sides outer = winding(sample.position + step, p), inner = winding(sample.position - step, p);
      verdict.area += sample.area;
      const bool between = std::min(outer.all, inner.all) > 0.5;
      const bool within = std::min(outer.others, inner.others) > 0.5;
      if (between || within) verdict.hidden += sample.area;
      if (outer.all > inner.all) verdict.inward += sample.area;
    }
    return verdict;
  }

  /// Whether all owners know their inside.
  bool closed(std::size_t p) const {
    return std::ranges::all_of(pieces_[p].owners,
                               [&](const PieceOwner& owner) { return closed_[owner.body]; });
  }

 private:
  struct Sides {
    double all = 0, others = 0;
  };
  Sides winding(const Vec3& at, std::size_t piece) const {
    Sides sum;
    for (std::size_t body = 0; body < trees_.size(); ++body) {
      const double number = winding_number(trees_[body], at);
      const bool own = std::ranges::any_of(pieces_[piece].owners, [&](const PieceOwner& owner) {
        return owner.body == static_cast<Index>(body);
      });
      sum.all += number;
      if (!own) sum.others += number;
    }
    return sum;
  }

  const std::vector<Piece>& pieces_;
  const std::vector<bool>& closed_;
  Tessellation mesh_;
  std::vector<std::vector<std::array<Index, 3>>> triangles_;
  std::vector<WindingTree> trees_;
};

}  // namespace

OuterSkin outer_skin(const std::vector<Piece>& pieces, const std::vector<bool>& closed) {
  const Judge judge(pieces, closed);
  OuterSkin skin;
  double all = 0;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Verdict verdict = judge.judge(p);
    all += verdict.area;
    if (std::max(verdict.hidden, verdict.area - verdict.hidden) < pure * verdict.area) {
      skin.doubtful += verdict.area;
    }
    if (verdict.hidden > 0.5 * verdict.area) {
      ++skin.hidden;
      continue;
    }
    const bool turn = judge.closed(p) && verdict.inward > 0.5 * verdict.area;
    skin.faces.push_back(turn ? TopoDS::Face(pieces[p].face.Reversed()) : pieces[p].face);
    skin.origins.push_back(pieces[p].origin);
  }
  if (all > 0) skin.doubtful /= all;
  return skin;
}

}  // namespace flowcage::occ
