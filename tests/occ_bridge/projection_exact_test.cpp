// Nearest distances against the kernel's exhaustive search over all faces, on real files where they are there
// and on CAD built in code. FLOWCAGE_PROJECTION_POINTS: points a set (1000); FLOWCAGE_PROJECTION_FILES: names
// of the files, separated by blanks (all).
#include <fmt/format.h>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom_Surface.hxx>
#include <Standard_Failure.hxx>
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>

#include "occ_bridge/internal/face_projector.hpp"
#include "occ_bridge/internal/shape_rep.hpp"
#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/occ_bridge/projection_shapes.hpp"
#include "tests/occ_bridge/random_points.hpp"
#include "tests/occ_bridge/real_shapes.hpp"

using namespace flowcage;
using test_shapes::random_in;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// BRepExtrema face by face. A face whose box is farther than `bound` cannot hold a nearer point and is left
/// out.
class KernelSearch {
 public:
  explicit KernelSearch(const std::vector<TopoDS_Face>& faces) : faces_(faces) {
    for (const TopoDS_Face& face : faces) {
      Bnd_Box box;
      BRepBndLib::Add(face, box, false);
      boxes_.push_back(box);
    }
  }

  /// The least distance if it is below `bound`; otherwise `bound`.
  double distance(const Vec3& query, double bound) const {
    const gp_Pnt point(query.x(), query.y(), query.z());
    const TopoDS_Shape vertex = BRepBuilderAPI_MakeVertex(point).Vertex();
    Bnd_Box at;
    at.Set(point);
    for (std::size_t f = 0; f < faces_.size(); ++f) {
      if (boxes_[f].IsVoid() || at.Distance(boxes_[f]) > bound) continue;
      try {
        const BRepExtrema_DistShapeShape extrema(vertex, faces_[f]);
        if (extrema.IsDone() && extrema.NbSolution() > 0) bound = std::min(bound, extrema.Value());
      } catch (const Standard_Failure&) {
        continue;  // no answer of the kernel
      }
    }
    return bound;
  }

 private:
  const std::vector<TopoDS_Face>& faces_;
  std::vector<Bnd_Box> boxes_;
};

std::vector<SurfacePoint> closest(const FaceProjector& projector, const std::vector<Vec3>& queries) {
  std::vector<SurfacePoint> results(queries.size());
  projector.closest_points(queries, {}, results);
  return results;
}

struct Comparison {
  double kernel_gain = 0;  ///< how much nearer than ours the kernel's point is at most, in diagonals
  int ours_nearer = 0;     ///< points where it finds nothing as near as ours
  int off_the_faces = 0;   ///< of these: our point is not on its face
};

/// Whether the face's surface passes through the point at its (u, v), and these are inside of the trimming or
/// on it; to the largest tolerance that the CAD gives an edge or vertex of the face.
bool on_its_face(const SurfacePoint& point, const TopoDS_Face& face, double precision) {
  double tolerance = std::max(precision, BRep_Tool::Tolerance(face));
  for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Edge(it.Current())));
  }
  for (TopExp_Explorer it(face, TopAbs_VERTEX); it.More(); it.Next()) {
    tolerance = std::max(tolerance, BRep_Tool::Tolerance(TopoDS::Vertex(it.Current())));
  }
  const gp_Pnt at = BRep_Tool::Surface(face)->Value(point.uv.x(), point.uv.y());
  if (at.Distance(gp_Pnt(point.position.x(), point.position.y(), point.position.z())) > tolerance)
    return false;
  BRepTopAdaptor_FClass2d classifier(face, tolerance);
  return classifier.Perform(gp_Pnt2d(point.uv.x(), point.uv.y())) != TopAbs_OUT;
}

/// Near points are within 2 % of the diagonal, far ones in a box of twice the model's extent.
Comparison compare(const std::vector<TopoDS_Face>& faces, std::size_t count) {
  const FaceProjector projector(faces);
  const Vec3 wide = Vec3::Constant(1e6);
  Box3 box;
  for (const SurfacePoint& p : closest(projector, random_in(Box3(-wide, wide), 500, 1)))
    box.extend(p.position);
  const double diagonal = box.diagonal().norm(), tie = 1e-9 * diagonal;
  std::vector<Vec3> queries = random_in(box, count, 2);
  const auto feet = closest(projector, queries);
  const Vec3 near = Vec3::Constant(0.02 * diagonal / std::sqrt(3.0)), far = Vec3::Constant(0.5 * diagonal);
  const std::vector<Vec3> offsets = random_in(Box3(-near, near), count, 3);
  for (std::size_t i = 0; i < count; ++i) queries[i] = feet[i].position + offsets[i];
  const std::vector<Vec3> others = random_in(Box3(box.min() - far, box.max() + far), count, 4);
  queries.insert(queries.end(), others.begin(), others.end());
  const auto results = closest(projector, queries);
  const KernelSearch kernel(faces);
  Comparison comparison;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    REQUIRE(results[i].status != FootStatus::failed);
    CHECK(std::abs((results[i].position - queries[i]).norm() - results[i].distance) <= 1e-12 * diagonal);
    const double least = kernel.distance(queries[i], results[i].distance + tie);
    const double gain = (results[i].distance - least) / diagonal;
    if (gain > 1e-9) {
      UNSCOPED_INFO(fmt::format("query {} {} {}: ours {} on face {}, the kernel's nearer by {} diagonals",
                                queries[i].x(), queries[i].y(), queries[i].z(), results[i].distance,
                                results[i].face, gain));
    }
    comparison.kernel_gain = std::max(comparison.kernel_gain, gain);
    if (least < results[i].distance + tie) continue;
    ++comparison.ours_nearer;
    if (!on_its_face(results[i], faces[results[i].face], 1e-7 * diagonal)) {
      ++comparison.off_the_faces;
      UNSCOPED_INFO(fmt::format("query {} {} {}: ours at {} on face {} is not on it", queries[i].x(),
                                queries[i].y(), queries[i].z(), results[i].distance, results[i].face));
    }
  }
  return comparison;
}

std::size_t points_a_set() {
  const char* text = std::getenv("FLOWCAGE_PROJECTION_POINTS");
  return text == nullptr ? 1000 : std::strtoull(text, nullptr, 10);
}

}  // namespace

TEST_CASE("CAD built in code: never farther than the kernel's search over all faces") {
  auto shapes = test_shapes::all();
  shapes.push_back({"ONERA M6", make_onera_m6().rep().shape});
  shapes.push_back({"trimmed panels", test_shapes::trimmed_panels()});
  for (const auto& [name, shape] : shapes) {
    INFO(name);
    const Comparison comparison = compare(test_shapes::faces_of(shape), points_a_set());
    CHECK(comparison.kernel_gain <= 1e-9);
    CHECK(comparison.off_the_faces == 0);
  }
}

TEST_CASE("real files: never farther than the kernel's search over all faces") {
  const std::filesystem::path folder = FLOWCAGE_REAL_CAD_DIR;
  if (!std::filesystem::is_directory(folder)) {
    std::cout << "no folder of real CAD files: skipped\n";
    return;
  }
  const char* wanted = std::getenv("FLOWCAGE_PROJECTION_FILES");
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.path().extension() == ".md") continue;
    if (wanted == nullptr || (" " + std::string(wanted) + " ").find(" " + name + " ") != std::string::npos) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  std::size_t usable = 0;
  for (const auto& file : files) {
    const auto faces = test_shapes::faces_of(test_shapes::read_shape(file.string()));
    if (faces.empty()) continue;  // two hold no surface that the kernel transfers
    ++usable;
    INFO(file.filename().string());
    const Comparison comparison = compare(faces, points_a_set());
    std::cout
        << fmt::format(
               "{}: {} faces; the kernel nearer by at most {:.1e} diagonals, ours nearer at {} points, {} of "
               "them not on the face\n",
               file.filename().string(), faces.size(), comparison.kernel_gain, comparison.ours_nearer,
               comparison.off_the_faces)
        << std::flush;
    CHECK(comparison.kernel_gain <= 1e-9);
    CHECK(comparison.off_the_faces == 0);
  }
  if (wanted == nullptr) CHECK(usable == 37);
}
