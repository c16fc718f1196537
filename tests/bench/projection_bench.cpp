// Nearest-point queries a second, ours and the kernel's two searches on the same points; see
// docs/contributing.md.
//   projection_bench [--points N] [--kernel-points N] [CAD FILE...]
#include <fmt/format.h>
#include <sys/resource.h>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <TopoDS_Compound.hxx>
#include <chrono>
#include <cstdlib>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/parallel.hpp"
#include "occ_bridge/internal/face_projector.hpp"
#include "occ_bridge/internal/projection_parts.hpp"
#include "occ_bridge/internal/shape_rep.hpp"
#include "occ_bridge/shapes.hpp"
#include "tests/occ_bridge/projection_shapes.hpp"
#include "tests/occ_bridge/random_points.hpp"
#include "tests/occ_bridge/real_shapes.hpp"

using namespace flowcage;
using test_shapes::random_in;

namespace {

struct Seconds {
  double wall = 0, processor = 0;
};

double processor_seconds() {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return static_cast<double>(use.ru_utime.tv_sec) + 1e-6 * static_cast<double>(use.ru_utime.tv_usec);
}

template <typename Work>
Seconds time_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  const double processor = processor_seconds();
  work();
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          processor_seconds() - processor};
}

std::vector<Vec3> moved(const std::vector<SurfacePoint>& feet, double reach, unsigned seed) {
  const Vec3 corner = Vec3::Constant(reach);
  std::vector<Vec3> points = random_in(Box3(-corner, corner), feet.size(), seed);
  for (std::size_t i = 0; i < feet.size(); ++i) points[i] += feet[i].position;
  return points;
}

struct Counts {
  std::size_t ours = 200000, kernel = 200;
};

struct Measures {
  std::size_t kernel_points = 0;
  double evaluation = 0;  ///< seconds of one surface evaluation
};

/// Of a cell's polynomial with both derivatives, cells in turn.
double evaluation_time(const std::vector<TopoDS_Face>& faces) {
  const ProjectionParts parts = build_projection(faces);
  std::vector<CellPolynomial> cells;
  for (std::size_t c = 0; c < parts.cells.cells.size(); ++c) {
    if (!parts.cell_polynomials[c].empty()) cells.push_back(parts.cell_polynomials[c]);
  }
  if (cells.empty()) return 0;
  constexpr std::size_t count = 1000000;
  double sum = 0;
  const Seconds time = time_of([&] {
    for (std::size_t i = 0; i < count; ++i) {
      sum += evaluate(cells[i / 8 % cells.size()], Vec2(0.1 * static_cast<double>(i % 8), 0.3)).duv.x();
    }
  });
  fmt::print("  one surface evaluation {:.0f} ns (checksum {:.3g}); {} of {} cells are polynomials\n",
             1e9 * time.processor / count, sum, cells.size(), parts.cells.cells.size());
  return time.processor / count;
}

/// A row: ours cold and with hints, then the kernel's on the first of the same points.
void measure(const std::string& set, const FaceProjector& projector, const std::vector<TopoDS_Face>& faces,
             const std::vector<Vec3>& queries, const std::vector<SurfacePoint>& hints,
             const Measures& measures) {
  std::vector<SurfacePoint> results(queries.size());
  const double count = static_cast<double>(queries.size());
  const Seconds cold = time_of([&] { projector.closest_points(queries, {}, results); });
  const Seconds hinted = time_of([&] { projector.closest_points(queries, hints, results); });
  const ProjectionWork work = projector.work(queries, {});
  const double evaluations = static_cast<double>(work.evaluations) / count;
  const double one = cold.processor / count;
  fmt::print(
      "  {:5} {:9.0f}/s on {} threads, {:8.0f}/s a core ({:.2f} us); with hints {:9.0f}/s, {:8.0f}/s a "
      "core\n",
      set, count / cold.wall, thread_count(), 1 / one, 1e6 * one, count / hinted.wall,
      count / hinted.processor);
  fmt::print(
      "        a query: {:.2f} surface and {:.2f} curve evaluations, {:.1f} cells ({:.3f} with several "
      "starts), {:.1f} curve pieces; the evaluations alone are {:.0f} % of the time\n",
      evaluations, static_cast<double>(work.curve_evaluations) / count,
      static_cast<double>(work.cells) / count, static_cast<double>(work.general_searches) / count,
      static_cast<double>(work.pieces) / count, 100 * evaluations * measures.evaluation / one);
  const std::size_t few = std::min(measures.kernel_points, queries.size());
  if (few == 0) return;
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Face& face : faces) builder.Add(compound, face);
  double nearer = 0;
  const Seconds extrema = time_of([&] {
    for (std::size_t i = 0; i < few; ++i) {
      const Vec3& q = queries[i];
      const BRepExtrema_DistShapeShape search(BRepBuilderAPI_MakeVertex(gp_Pnt(q.x(), q.y(), q.z())).Vertex(),
                                              compound);
      if (search.IsDone()) nearer = std::max(nearer, results[i].distance - search.Value());
    }
  });
  std::vector<GeomAPI_ProjectPointOnSurf> searches(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
    BRepTools::UVBounds(faces[f], u0, u1, v0, v1);
    searches[f].Init(BRep_Tool::Surface(faces[f]), u0, u1, v0, v1);
  }
  double sum = 0;
  const Seconds geom = time_of([&] {
    for (std::size_t i = 0; i < few; ++i) {
      double best = std::numeric_limits<double>::infinity();
      for (GeomAPI_ProjectPointOnSurf& search : searches) {
        search.Perform(gp_Pnt(queries[i].x(), queries[i].y(), queries[i].z()));
        if (search.NbPoints() > 0) best = std::min(best, search.LowerDistance());
      }
      if (best < 1e300) sum += best;
    }
  });
  const double n = static_cast<double>(few);
  fmt::print(
      "        BRepExtrema {:.1f}/s: ours is {:.0f} times that a core (nearer than ours by at most {:.1e}); "
      "GeomAPI over all faces {:.1f}/s: {:.0f} times\n",
      n / extrema.processor, extrema.processor / n / one, nearer, n / geom.processor,
      geom.processor / n / one);
}

void measure(const std::string& name, const std::vector<TopoDS_Face>& faces, const Counts& counts) {
  std::optional<FaceProjector> built;
  const Seconds build = time_of([&] { built.emplace(faces); });
  const FaceProjector& projector = *built;
  fmt::print("{}: {} faces, {} cells, {} curve pieces, made in {:.2f} s\n", name, faces.size(),
             projector.cell_count(), projector.curve_piece_count(), build.wall);
  const Measures measures{counts.kernel, evaluation_time(faces)};
  // The faces' extent, from feet of points all round.
  const Vec3 corner = Vec3::Constant(1e6);
  std::vector<SurfacePoint> around(2000);
  projector.closest_points(random_in(Box3(-corner, corner), around.size(), 1), {}, around);
  Box3 box;
  for (const SurfacePoint& p : around) box.extend(p.position);
  const double diagonal = box.diagonal().norm();
  std::vector<SurfacePoint> feet(counts.ours), hints(counts.ours);
  projector.closest_points(random_in(box, counts.ours, 2), {}, feet);
  const std::vector<Vec3> near = moved(feet, 0.01 * diagonal, 3);
  std::vector<Vec3> before =
      random_in(Box3(Vec3::Constant(-0.001 * diagonal), Vec3::Constant(0.001 * diagonal)), counts.ours, 4);
  const auto earlier = [&](const std::vector<Vec3>& queries) {
    std::vector<Vec3> points = queries;
    for (std::size_t i = 0; i < points.size(); ++i) points[i] += before[i];
    projector.closest_points(points, {}, hints);
  };
  earlier(near);
  measure("near", projector, faces, near, hints, measures);
  const Vec3 half = Vec3::Constant(diagonal);
  const std::vector<Vec3> far = random_in(Box3(box.center() - half, box.center() + half), counts.ours, 5);
  earlier(far);
  measure("far", projector, faces, far, hints, measures);
}

}  // namespace

int main(int argc, char** argv) {
  Counts counts;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--points" && i + 1 < argc) {
      counts.ours = std::strtoull(argv[++i], nullptr, 10);
    } else if (word == "--kernel-points" && i + 1 < argc) {
      counts.kernel = std::strtoull(argv[++i], nullptr, 10);
    } else {
      files.push_back(word);
    }
  }
  if (files.empty()) {
    measure("ONERA M6 wing", test_shapes::faces_of(make_onera_m6().rep().shape), counts);
    measure("trimmed panels", test_shapes::faces_of(test_shapes::trimmed_panels()), counts);
  }
  for (const std::string& file : files) {
    measure(file, test_shapes::faces_of(test_shapes::read_shape(file)), counts);
  }
  return 0;
}
