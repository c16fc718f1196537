// Our kernels and others' on the same work, as pairs NAME/ours and NAME/other. Wall-clock time on all cores.
#include <benchmark/benchmark.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <BRepTools.hxx>
#include <BRep_Tool.hxx>
#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <cstring>
#include <limits>
#include <memory>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/Sparse>

#include "core/base/parallel.hpp"
#include "core/limit/limit_stencils.hpp"
#include "core/refit/cgls.hpp"
#include "core/subdivide/refine.hpp"
#include "core/volume/refine_volume.hpp"
#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/shape_rep.hpp"
#include "occ_bridge/shapes.hpp"
#include "tests/blocks/sample_complexes.hpp"
#include "tests/occ_bridge/projection_shapes.hpp"
#include "tests/occ_bridge/random_points.hpp"
#include "tests/subdivide/cage_zoo.hpp"

using namespace flowcage;
namespace far_ = OpenSubdiv::Far;

namespace {

constexpr auto unit = benchmark::kMillisecond;

// ---- surface refinement: topology and points of levels 1 to 6, the last with all of its topology ----

constexpr int depth = 6;
Cage sheet() {
  return zoo::grid(6, 6);  // 36 faces, 147,456 at level 6
}

void refine_ours(benchmark::State& state) {
  const Cage cage = sheet();
  for (auto _ : state) {
    const std::vector<SurfaceLevel> levels = build_levels(cage, depth);
    benchmark::DoNotOptimize(refine_points(levels, cage.points).data());
  }
}

struct OsdPoint {
  Vec3 p = Vec3::Zero();
  void Clear(void* = nullptr) { p.setZero(); }                                           // NOLINT
  void AddWithWeight(const OsdPoint& source, double weight) { p += weight * source.p; }  // NOLINT
};

void refine_opensubdiv(benchmark::State& state) {
  const Cage cage = sheet();
  const std::vector<int> indices(cage.faces.values.begin(), cage.faces.values.end());
  std::vector<int> sizes;
  for (Index f = 0; f < cage.faces.size(); ++f) sizes.push_back(cage.faces.row_size(f));
  far_::TopologyDescriptor descriptor;
  descriptor.numVertices = static_cast<int>(cage.points.size());
  descriptor.numFaces = cage.faces.size();
  descriptor.numVertsPerFace = sizes.data();
  descriptor.vertIndicesPerFace = indices.data();
  OpenSubdiv::Sdc::Options options;
  options.SetVtxBoundaryInterpolation(OpenSubdiv::Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
  using Factory = far_::TopologyRefinerFactory<far_::TopologyDescriptor>;
  for (auto _ : state) {
    const std::unique_ptr<far_::TopologyRefiner> refiner(
        Factory::Create(descriptor, Factory::Options(OpenSubdiv::Sdc::SCHEME_CATMARK, options)));
    far_::TopologyRefiner::UniformOptions uniform(depth);
    uniform.fullTopologyInLastLevel = true;
    refiner->RefineUniform(uniform);
    std::vector<OsdPoint> points(cage.points.size());
    for (std::size_t v = 0; v < points.size(); ++v) points[v].p = cage.points[v];
    const far_::PrimvarRefinerReal<double> primvar(*refiner);
    for (int level = 1; level <= depth; ++level) {
      std::vector<OsdPoint> child(refiner->GetLevel(level).GetNumVertices());
      primvar.Interpolate(level, points, child);
      points = std::move(child);
    }
    benchmark::DoNotOptimize(points.data());
  }
}

// ---- least squares: the fit's own matrix of a level, three right sides, 30 iterations each ----

constexpr int iterations = 30;
struct LeastSquares {
  StencilTable rows;
  std::vector<Vec3> right_side, start;
};
LeastSquares least_squares() {
  const SurfaceLevel level = build_levels(sheet(), 4).back();
  LeastSquares s{oversampled_limit_stencils(level).position, {}, {}};
  zoo::Random random(3);
  for (Index r = 0; r < s.rows.size(); ++r) {
    s.right_side.emplace_back(std::sin(0.37 * r), std::cos(0.11 * r), std::sin(1e-3 * r * r));
  }
  s.start.assign(s.rows.control_vertex_count, Vec3::Zero());
  return s;
}

void cgls_ours(benchmark::State& state) {
  const LeastSquares s = least_squares();
  CglsSettings settings;
  settings.max_iterations = iterations;
  settings.tolerance = 1e-300;
  for (auto _ : state) {
    const LeastSquaresMatrix matrix = prepare_least_squares(s.rows);
    benchmark::DoNotOptimize(solve_cgls(matrix, s.right_side, s.start, settings).solution.data());
  }
}

void cgls_eigen(benchmark::State& state) {
  const LeastSquares s = least_squares();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index r = 0; r < s.rows.size(); ++r) {
    for (Offset k = s.rows.offsets[r]; k < s.rows.offsets[r + 1]; ++k) {
      entries.emplace_back(r, s.rows.indices[k], s.rows.weights[k]);
    }
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> matrix(s.rows.size(), s.rows.control_vertex_count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::MatrixXd right_side(s.rows.size(), 3);
  for (Index r = 0; r < s.rows.size(); ++r) right_side.row(r) = s.right_side[r].transpose();
  for (auto _ : state) {
    Eigen::LeastSquaresConjugateGradient<Eigen::SparseMatrix<double, Eigen::RowMajor>> solver;
    solver.setMaxIterations(iterations);
    solver.setTolerance(1e-300);
    solver.compute(matrix);
    const Eigen::MatrixXd x = solver.solve(right_side);
    benchmark::DoNotOptimize(x.data());
  }
}

// ---- projection to the trimmed faces of the M6 wing; items a second ----

CadModel wing() {
  Progress silent;
  return cad_model_of(make_onera_m6(), {}, silent);
}

std::vector<Vec3> near_points(const CadModel& cad, std::size_t count) {
  const Vec3 corner = Vec3::Constant(0.02 * cad.diagonal());
  Box3 box = cad.bounds();
  box.extend(box.min() - corner);
  box.extend(box.max() + corner);
  return test_shapes::random_in(box, count, 2);
}

void project_ours(benchmark::State& state) {
  const CadModel cad = wing();
  const std::vector<Vec3> points = near_points(cad, 20000);
  std::vector<SurfacePoint> feet(points.size());
  for (auto _ : state) cad.closest_points(points, {}, feet);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}

void project_opencascade(benchmark::State& state) {
  const CadModel cad = wing();
  const std::vector<TopoDS_Face> faces = test_shapes::faces_of(make_onera_m6().rep().shape);
  const std::vector<Vec3> points = near_points(cad, 40);
  std::vector<GeomAPI_ProjectPointOnSurf> searches(faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
    BRepTools::UVBounds(faces[f], u0, u1, v0, v1);
    searches[f].Init(BRep_Tool::Surface(faces[f]), u0, u1, v0, v1);
  }
  for (auto _ : state) {
    for (const Vec3& p : points) {
      double best = std::numeric_limits<double>::infinity();
      for (GeomAPI_ProjectPointOnSurf& search : searches) {
        search.Perform(gp_Pnt(p.x(), p.y(), p.z()));
        if (search.NbPoints() > 0) best = std::min(best, search.LowerDistance());
      }
      benchmark::DoNotOptimize(best);
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(points.size()));
}

// ---- volume refinement to 2,100,000 points, and a copy of the same bytes to memory that is new, too ----

BlockMesh coarse_volume() {
  const HexComplex complex = sample::grid_complex({2, 2, 2});
  BlockMesh mesh(std::make_shared<const HexComplex>(complex));
  for (int level = 0; level < 5; ++level) mesh = refine_volume(mesh);
  return mesh;
}

void refine_volume_ours(benchmark::State& state) {
  const BlockMesh mesh = coarse_volume();
  for (auto _ : state) benchmark::DoNotOptimize(refine_volume(mesh).points().data());
}

void refine_volume_copy(benchmark::State& state) {
  const BlockMesh fine = refine_volume(coarse_volume());
  const std::span<const Vec3> from = fine.points();
  for (auto _ : state) {
    std::vector<Vec3> to(from.size());
    constexpr Offset grain = 65536;
    parallel_for(static_cast<Offset>(from.size()), grain, [&](Offset begin, Offset end) {
      std::memcpy(to[begin].data(), from[begin].data(), static_cast<std::size_t>(end - begin) * sizeof(Vec3));
    });
    benchmark::DoNotOptimize(to.data());
  }
}

BENCHMARK(refine_ours)->Name("surface_refinement/ours")->Unit(unit)->UseRealTime();
BENCHMARK(refine_opensubdiv)->Name("surface_refinement/other")->Unit(unit)->UseRealTime();
BENCHMARK(cgls_ours)->Name("cgls/ours")->Unit(unit)->UseRealTime();
BENCHMARK(cgls_eigen)->Name("cgls/other")->Unit(unit)->UseRealTime();
BENCHMARK(project_ours)->Name("projection/ours")->Unit(unit)->UseRealTime();
BENCHMARK(project_opencascade)->Name("projection/other")->Unit(unit)->UseRealTime();
BENCHMARK(refine_volume_ours)->Name("volume_refinement/ours")->Unit(unit)->UseRealTime();
BENCHMARK(refine_volume_copy)->Name("volume_refinement/other")->Unit(unit)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();
