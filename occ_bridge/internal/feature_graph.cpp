#include "occ_bridge/internal/feature_graph.hpp"

#include <BRep_Tool.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace flowcage::occ {

namespace {

/// A run, or a part of it between kinks, with a node at each end.
struct Segment {
  ChainPiece piece;  ///< never reversed here
  ChainKind kind = ChainKind::sharp;
  Index edge = no_index;
  std::array<Index, 2> node{no_index, no_index};
};

/// An end of a segment: 0 its start, 1 its end.
struct SegmentEnd {
  Index segment = no_index;
  int end = 0;
};

class Joiner {
 public:
  Joiner(const FaceEdges& topology, const ChainSettings& settings)
      : topology_(topology), settings_(settings) {}

  ChainSet join(const std::vector<FeatureRun>& runs) {
    for (const FeatureRun& run : runs) add_segments(run);
    join_loose_ends();
    incidence_.assign(positions_.size(), {});
    for (Index s = 0; s < static_cast<Index>(segments_.size()); ++s) {
      for (int end = 0; end < 2; ++end) incidence_[segments_[s].node[end]].push_back({s, end});
    }
    corner_.assign(positions_.size(), no_index);
    for (std::size_t n = 0; n < positions_.size(); ++n) {
      if (incidence_[n].empty() || passes_through(incidence_[n])) continue;
      corner_[n] = static_cast<Index>(result_.graph.corners.size());
      result_.graph.corners.push_back(positions_[n]);
    }
    done_.assign(segments_.size(), false);
    for (std::size_t n = 0; n < positions_.size(); ++n) {
      if (corner_[n] == no_index) continue;
      for (const SegmentEnd& start : incidence_[n]) {
        if (!done_[start.segment]) walk(start);
      }
    }
    for (Index s = 0; s < static_cast<Index>(segments_.size()); ++s) {
      if (!done_[s]) walk({s, 0});  // closed loops without corner
    }
    return std::move(result_);
  }

 private:
  Index new_node(const Vec3& position, double tolerance) {
    positions_.push_back(position);
    tolerances_.push_back(tolerance);
    return static_cast<Index>(positions_.size()) - 1;
  }

  Index vertex_node(const TopoDS_Vertex& vertex) {
    const int known = vertices_.Extent();
    const int index = vertices_.Add(vertex);
    if (index > known) {
      const gp_Pnt p = BRep_Tool::Pnt(vertex);
      vertex_nodes_.push_back(new_node(settings_.scale * Vec3(p.X(), p.Y(), p.Z()),
                                       settings_.scale * BRep_Tool::Tolerance(vertex)));
    }
    return vertex_nodes_[index - 1];
  }

  void add_segments(const FeatureRun& run) {
    const TopoDS_Edge edge = TopoDS::Edge(topology_.edge(run.edge).Oriented(TopAbs_FORWARD));
    double first = 0, last = 0;
    const Handle(Geom_Curve) raw = BRep_Tool::Curve(edge, first, last);
    if (raw.IsNull() || !(run.t1 > run.t0)) return;
    gp_Trsf to_metres;
    to_metres.SetScale(gp_Pnt(0, 0, 0), settings_.scale);
    const auto curve = Handle(Geom_Curve)::DownCast(raw->Transformed(to_metres));
    const double t0 = raw->TransformedParameter(run.t0, to_metres);
    const double t1 = raw->TransformedParameter(run.t1, to_metres);
    const auto at = [&](double t) {
      const gp_Pnt p = curve->Value(t);
      return Vec3(p.X(), p.Y(), p.Z());
    };

    std::vector<double> cuts{t0};
    const ChainPiece whole = make_piece(curve, t0, t1);
    const auto breaks = smooth_breaks(curve, t0, t1);
    for (std::size_t i = 1; i + 1 < breaks.size(); ++i) {
      const double eps = 1e-7 * std::min(breaks[i] - breaks[i - 1], breaks[i + 1] - breaks[i]);
      const Vec3 before = unit_tangent(whole, breaks[i] - eps);
      const Vec3 after = unit_tangent(whole, breaks[i] + eps);
      if (before.dot(after) < std::cos(settings_.corner_angle)) cuts.push_back(breaks[i]);
    }
    cuts.push_back(t1);

    TopoDS_Vertex start, end;
    TopExp::Vertices(edge, start, end);
    const double tolerance = settings_.scale * BRep_Tool::Tolerance(edge);
    Index node = run.whole_start && !start.IsNull() ? vertex_node(start) : new_node(at(t0), tolerance);
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
      Segment segment{.piece = make_piece(curve, cuts[i], cuts[i + 1]), .kind = run.kind, .edge = run.edge};
      segment.node[0] = node;
      const bool last_part = i + 2 == cuts.size();
      node = last_part && run.whole_end && !end.IsNull() ? vertex_node(end)
                                                         : new_node(at(cuts[i + 1]), tolerance);
      segment.node[1] = node;
      segments_.push_back(segment);
    }
  }

  /// Nodes that only one end touches, and that coincide with another such node, become one.
  void join_loose_ends() {
    std::vector<int> degree(positions_.size(), 0);
    for (const Segment& segment : segments_) {
      for (const Index n : segment.node) ++degree[n];
    }
    std::vector<Index> loose;
    for (Index n = 0; n < static_cast<Index>(positions_.size()); ++n) {
      if (degree[n] == 1) loose.push_back(n);
    }
    std::ranges::stable_sort(loose, {}, [&](Index n) { return positions_[n].x(); });
    std::vector<Index> into(positions_.size());
    for (std::size_t n = 0; n < into.size(); ++n) into[n] = static_cast<Index>(n);
    double widest = 0;
    for (const Index n : loose) widest = std::max(widest, tolerances_[n]);
    for (std::size_t i = 0; i < loose.size(); ++i) {
      if (into[loose[i]] != loose[i]) continue;
      const Vec3& p = positions_[loose[i]];
      for (std::size_t j = i + 1; j < loose.size() && positions_[loose[j]].x() - p.x() <= 2 * widest; ++j) {
        const double reach = tolerances_[loose[i]] + tolerances_[loose[j]];
        if (into[loose[j]] == loose[j] && (positions_[loose[j]] - p).norm() <= reach) {
          into[loose[j]] = loose[i];
        }
      }
    }
    for (Segment& segment : segments_) {
      for (Index& n : segment.node) n = into[n];
    }
  }

  /// Unit tangent at an end, pointing away from it along the segment.
  Vec3 leaving(const SegmentEnd& at) const {
    const ChainPiece& piece = segments_[at.segment].piece;
    const double eps = 1e-9 * (piece.t1 - piece.t0);  // off a kink at the very end
    const double t = at.end == 0 ? piece.t0 + eps : piece.t1 - eps;
    const Vec3 tangent = unit_tangent(piece, t);
    return at.end == 0 ? tangent : Vec3(-tangent);
  }

  bool passes_through(const std::vector<SegmentEnd>& ends) const {
    if (ends.size() != 2) return false;
    if (segments_[ends[0].segment].kind != segments_[ends[1].segment].kind) return false;
    return -leaving(ends[0]).dot(leaving(ends[1])) >= std::cos(settings_.corner_angle);
  }

  /// Follows segments from `start` to the next corner, or round to itself.
  void walk(SegmentEnd start) {
    FeatureChain chain;
    chain.kind = segments_[start.segment].kind;
    chain.start = corner_[segments_[start.segment].node[start.end]];
    std::vector<ChainPiece> pieces;
    SegmentEnd at = start;
    for (;;) {
      const Segment& segment = segments_[at.segment];
      done_[at.segment] = true;
      pieces.push_back(segment.piece);
      pieces.back().reversed = at.end == 1;
      for (const EdgeUse& use : topology_.uses[segment.edge]) chain.faces.push_back(use.face);
      const SegmentEnd arrived{at.segment, 1 - at.end};
      const Index node = segment.node[arrived.end];
      chain.end = corner_[node];
      if (chain.end != no_index) break;
      const auto& ends = incidence_[node];
      const bool first = ends[0].segment == arrived.segment && ends[0].end == arrived.end;
      at = first ? ends[1] : ends[0];
      if (done_[at.segment]) break;
    }
    std::ranges::sort(chain.faces);
    const auto rest = std::ranges::unique(chain.faces);
    chain.faces.erase(rest.begin(), rest.end());
    ChainCurve curve(pieces, settings_.deviation);
    chain.length = curve.length();
    chain.polyline = curve.polyline();
    chain.polyline_s = curve.polyline_s();
    result_.graph.chains.push_back(std::move(chain));
    result_.curves.push_back(std::move(curve));
  }

  const FaceEdges& topology_;
  ChainSettings settings_;
  std::vector<Segment> segments_;
  std::vector<Vec3> positions_;     ///< of nodes, in metres
  std::vector<double> tolerances_;  ///< of nodes, in metres
  TopTools_IndexedMapOfShape vertices_;
  std::vector<Index> vertex_nodes_;
  std::vector<std::vector<SegmentEnd>> incidence_;
  std::vector<Index> corner_;  ///< of nodes: into the graph's corners, or no_index
  std::vector<bool> done_;
  ChainSet result_;
};

}  // namespace

ChainSet join_feature_runs(const FaceEdges& topology, const std::vector<FeatureRun>& runs,
                           const ChainSettings& settings) {
  return Joiner(topology, settings).join(runs);
}

}  // namespace flowcage::occ
