#include "occ_bridge/internal/unite.hpp"

#include <fmt/format.h>
#include <BRepAdaptor_Curve.hxx>
#include <BRep_Builder.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <NCollection_DataMap.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Shell.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <functional>
#include <numeric>

#include "occ_bridge/internal/build_model.hpp"
#include "occ_bridge/internal/isolate.hpp"
#include "occ_bridge/internal/kernel_scope.hpp"
#include "occ_bridge/internal/outer_skin.hpp"
#include "occ_bridge/internal/tessellate.hpp"

namespace flowcage::occ {

namespace {

constexpr const char* stage = "unite bodies that overlap";

TopoDS_Compound compound_of(const std::vector<TopoDS_Face>& faces) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, face);
  return compound;
}

double free_length(const FaceEdges& topology) {
  double length = 0;
  for (Index e = 0; e < topology.edge_count(); ++e) {
    if (topology.is_free(e)) length += GCPnts_AbscissaPoint::Length(BRepAdaptor_Curve(topology.edge(e)));
  }
  return length;
}

/// Shells of the faces that are connected by edges, in the order of their first face.
std::vector<TopoDS_Shape> shells_of(const std::vector<TopoDS_Face>& faces) {
  const FaceEdges topology = face_edges_of(compound_of(faces));
  std::vector<Index> shell(faces.size());
  std::iota(shell.begin(), shell.end(), 0);
  const auto root = [&](Index f) {
    while (shell[f] != f) f = shell[f] = shell[shell[f]];
    return f;
  };
  for (Index e = 0; e < topology.edge_count(); ++e) {
    const auto uses = topology.uses[e];
    for (std::size_t i = 1; i < uses.size(); ++i) {
      const Index a = root(uses[0].face), b = root(uses[i].face);
      shell[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<TopoDS_Shape> result;
  BRep_Builder builder;
  for (Index first = 0; first < static_cast<Index>(faces.size()); ++first) {
    if (root(first) != first) continue;
    TopoDS_Shell joined;
    builder.MakeShell(joined);
    for (Index f = first; f < static_cast<Index>(faces.size()); ++f) {
      if (root(f) == first) builder.Add(joined, topology.face(f));
    }
    joined.Closed(face_edges_of(joined).free_edge_count() == 0);
    result.push_back(joined);
  }
  return result;
}

/// One solid of all shells where all are closed (outer ones and cavities), the shells themselves otherwise.
std::vector<TopoDS_Shape> bodies_of_skin(const std::vector<TopoDS_Face>& faces) {
  std::vector<TopoDS_Shape> shells = shells_of(faces);
  if (!std::ranges::all_of(shells, [](const TopoDS_Shape& shell) { return shell.Closed(); })) return shells;
  TopoDS_Solid solid;
  BRep_Builder builder;
  builder.MakeSolid(solid);
  for (const TopoDS_Shape& shell : shells) builder.Add(solid, shell);
  return {solid};
}

struct Attempt {
  OuterSkin skin;
  Index shared_faces = 0, split_faces = 0;
  std::string problem;                ///< "": accepted
  std::vector<std::string> warnings;  ///< of an accepted one
  std::vector<Index> bad_faces;       ///< as in the summary
  /// Near each other, no more: nothing was cut or is hidden.
  bool apart() const {
    return !skin.faces.empty() && skin.hidden == 0 && split_faces == 0 && shared_faces == 0;
  }
};

class Uniter {
 public:
  Uniter(const PreparedModel& model, const CadReadSettings& settings)
      : model_(model), settings_(settings), bodies_(bodies_of(model.shape)) {
    TopExp::MapShapes(model.shape, TopAbs_FACE, faces_);
  }

  const std::vector<Body>& bodies() const { return bodies_; }

  Attempt unite(const BodyGroup& group) const {
    Attempt attempt;
    const std::string failure = failure_of([&] { attempt = attempted(group); });
    if (!failure.empty()) attempt.problem = failure;
    return attempt;
  }

 private:
  Attempt attempted(const BodyGroup& group) const {
    Attempt attempt;
    FusedPieces fused = fuse_pieces(bodies_, group);
    attempt.shared_faces = fused.shared_faces;
    attempt.split_faces = fused.split_faces;
    std::vector<TopoDS_Face> faces;
    FaceLabels labels;
    for (const Piece& piece : fused.pieces) {
      faces.push_back(piece.face);
      const int origin = faces_.FindIndex(piece.origin);
      if (origin > 0) labels.set(piece.face, model_.labels[origin - 1]);
    }
    CadSummary bad;
    Progress nobody;
    triangulate_faces(compound_of(faces),
                      {.deflection = model_.deflection,
                       .scale = model_.metres,
                       .angle_degrees = settings_.tessellation_angle_degrees},
                      labels, bad, nobody);
    std::vector<bool> closed;
    double free_before = 0;
    for (const Index body : group.bodies) {
      closed.push_back(bodies_[body].closed);
      if (!closed.back()) free_before += free_length(face_edges_of(bodies_[body].shape));
    }
    attempt.skin = outer_skin(fused.pieces, closed);
    const bool all_closed = std::ranges::all_of(closed, std::identity{});
    const double free_after = free_length(face_edges_of(compound_of(attempt.skin.faces)));
    // What an open body encloses is a guess near its opening.
    const double most_doubtful = all_closed ? 1e-6 : 0.05;
    if (attempt.skin.doubtful > most_doubtful) {
      attempt.problem =
          fmt::format("{:.2g} of the area is in pieces that are partly hidden: a curve was missed",
                      attempt.skin.doubtful);
    } else if (all_closed && !bad.warnings.empty()) {
      attempt.problem = bad.warnings.front();
    } else if (free_after > 1.001 * free_before) {
      attempt.problem =
          fmt::format("gaps of {:.3g} m length would open", model_.metres * (free_after - free_before));
    } else if (!all_closed) {
      attempt.bad_faces = std::move(bad.bad_faces);
      attempt.warnings = std::move(bad.warnings);
      if (attempt.skin.doubtful > 0) {
        attempt.warnings.push_back(fmt::format(
            "uniting bodies with gaps: {:.2g} of the area is in pieces that seem partly hidden, and "
            "the larger part of each decided",
            attempt.skin.doubtful));
      }
    }
    return attempt;
  }

  const PreparedModel& model_;
  const CadReadSettings& settings_;
  std::vector<Body> bodies_;
  TopTools_IndexedMapOfShape faces_;  ///< of the model, in the order of its labels
};

std::string numbers_of(const std::vector<Index>& bodies) {
  std::string text;
  for (const Index body : bodies) text += fmt::format("{}{}", text.empty() ? "" : ", ", body);
  return text;
}

CadOverlap overlap_of(const BodyGroup& group) {
  CadOverlap overlap;
  for (const Index body : group.bodies) overlap.bodies.push_back(body + 1);
  return overlap;
}

void keep_as_it_is(CadOverlap overlap, const std::string& problem, CadSummary& summary) {
  overlap.problem = problem;
  summary.warnings.push_back(
      fmt::format("bodies {} overlap or touch and could not be united ({}): the pieces of each inside of "
                  "another one stay and can be met by projection; unite them in the CAD system",
                  numbers_of(overlap.bodies), problem));
  summary.overlaps.push_back(std::move(overlap));
}

/// Per face of the new model: which face of the old one it is (a part of).
class Origins {
 public:
  void add(const TopoDS_Shape& face, const TopoDS_Shape& origin) { origin_.Bind(face, origin); }
  TopoDS_Shape of(const TopoDS_Shape& face) const {
    const TopoDS_Shape* known = origin_.Seek(face);
    return known == nullptr ? face : *known;
  }

 private:
  NCollection_DataMap<TopoDS_Shape, TopoDS_Shape, TopTools_ShapeMapHasher> origin_;
};

void unite_groups(PreparedModel& model, const std::vector<BodyGroup>& groups,
                  const CadReadSettings& settings) {
  const KernelScope scope;
  const Uniter uniter(model, settings);
  const std::vector<Body>& bodies = uniter.bodies();
  std::vector<std::vector<TopoDS_Shape>> result;
  for (const Body& body : bodies) result.push_back({body.shape});
  Origins origins;
  for (const BodyGroup& group : groups) {
    const Attempt attempt = uniter.unite(group);
    const OuterSkin& skin = attempt.skin;
    CadOverlap overlap = overlap_of(group);
    if (!attempt.problem.empty()) {
      keep_as_it_is(std::move(overlap), attempt.problem, model.summary);
      continue;
    }
    if (attempt.apart()) continue;
    auto& warnings = model.summary.warnings;
    warnings.insert(warnings.end(), attempt.warnings.begin(), attempt.warnings.end());
    auto& bad_faces = model.summary.bad_faces;
    bad_faces.insert(bad_faces.end(), attempt.bad_faces.begin(), attempt.bad_faces.end());
    overlap.united = true;
    overlap.split_faces = attempt.split_faces;
    overlap.hidden_pieces = skin.hidden;
    model.summary.overlaps.push_back(std::move(overlap));
    for (std::size_t f = 0; f < skin.faces.size(); ++f) origins.add(skin.faces[f], skin.origins[f]);
    for (const Index body : group.bodies) result[body].clear();
    result[group.bodies.front()] = bodies_of_skin(skin.faces);
  }

  if (std::ranges::none_of(model.summary.overlaps, &CadOverlap::united)) return;

  const FaceEdges before = face_edges_of(model.shape);
  std::vector<Index> body_of_face(static_cast<std::size_t>(before.face_count()), no_index);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const FaceEdges own = face_edges_of(bodies[b].shape);
    for (Index f = 0; f < own.face_count(); ++f) {
      body_of_face[before.faces.FindIndex(own.face(f)) - 1] = static_cast<Index>(b);
    }
  }
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const auto& shapes : result) {
    for (const TopoDS_Shape& shape : shapes) builder.Add(compound, shape);
  }
  const FaceEdges after = face_edges_of(compound);
  std::vector<CadFace> labels;
  model.bodies.clear();
  for (Index f = 0; f < after.face_count(); ++f) {
    const Index origin = before.faces.FindIndex(origins.of(after.face(f))) - 1;
    labels.push_back(model.labels[origin]);
    model.bodies.push_back(body_of_face[origin]);
  }
  model.labels = std::move(labels);
  model.shape = compound;
}

}  // namespace

PreparedModel united(PreparedModel model, const CadReadSettings& settings, Progress& progress) {
  progress.step(stage, 0.0);
  const std::vector<Body> bodies = bodies_of(model.shape);
  if (bodies.size() < 2) return model;
  const std::vector<BodyGroup> groups = interfering_bodies(bodies, 2 * model.deflection);
  if (groups.empty()) return model;
  const auto work = [&] {
    Progress nobody;
    unite_groups(model, groups, settings);
    std::string bytes = bytes_of(model);
    build_model(model, settings, nobody);  // whether it survives this, too
    return bytes;
  };
  try {
    const IsolationSettings isolation{.file = model.summary.files.front().name,
                                      .stage = stage,
                                      .limit_seconds = settings.time_limit_seconds};
    return prepared_from(run_isolated(work, isolation, progress));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) throw;
    for (const BodyGroup& group : groups) keep_as_it_is(overlap_of(group), error.what(), model.summary);
    return model;
  }
}

}  // namespace flowcage::occ
