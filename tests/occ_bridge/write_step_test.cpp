// B-spline patches as STEP, read back by OpenCASCADE and gmsh.
#include "occ_bridge/write_step.hpp"

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <GeomLProp_SLProps.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedDataMapOfShapeListOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <numbers>

#include "core/refit/fit_surface.hpp"
#include "core/subdivide/refine.hpp"
#include "core/target/analytic_surfaces.hpp"
#include "occ_bridge/cad_model.hpp"
#include "tests/catch.hpp"
#include "tests/export/peers.hpp"
#include "tests/occ_bridge/cad_scratch.hpp"
#include "tests/refit/hand_drawn_cages.hpp"

using namespace flowcage;
using std::numbers::pi;

namespace {

PatchSurface patches_of(const Cage& cage, int depth) {
  const std::vector<SurfaceLevel> levels = build_levels(cage, depth);
  Progress silent;
  return make_bicubic_patches(levels.back(), refine_points(levels, cage.points), {}, silent);
}

// As the kernel reads it by itself: in millimetres, nothing mended by us.
TopoDS_Shape read_back(const std::string& file) {
  STEPControl_Reader reader;
  REQUIRE(reader.ReadFile(file.c_str()) == IFSelect_RetDone);
  REQUIRE(reader.TransferRoots() == 1);
  return reader.OneShape();
}

int count(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  int n = 0;
  for (TopExp_Explorer e(shape, kind); e.More(); e.Next()) ++n;
  return n;
}

double volume(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-9);
  return properties.Mass();
}

int free_edges_after_sewing(const TopoDS_Shape& shape, double tolerance) {
  BRepBuilderAPI_Sewing sewing(tolerance);
  for (TopExp_Explorer f(shape, TopAbs_FACE); f.More(); f.Next()) sewing.Add(f.Current());
  sewing.Perform();
  return sewing.NbFreeEdges();
}

gp_Vec normal_on(const TopoDS_Face& face, const TopoDS_Edge& edge, double t) {
  Standard_Real first, last;
  const gp_Pnt2d uv = BRep_Tool::CurveOnSurface(edge, face, first, last)->Value(first + t * (last - first));
  GeomLProp_SLProps properties(BRep_Tool::Surface(face), uv.X(), uv.Y(), 1, 1e-12);
  REQUIRE(properties.IsNormalDefined());
  const gp_Vec normal(properties.Normal());
  return face.Orientation() == TopAbs_REVERSED ? normal.Reversed() : normal;
}

struct Contact {
  int free_edges = 0, smooth = 0, sharp = 0;
  double smooth_degrees = 0;  // the largest of smooth edges
};
// Edges are told apart at 5 degrees; samples crowd toward both ends, where irregular vertices are.
Contact contact_of(const TopoDS_Shape& shape) {
  TopTools_IndexedDataMapOfShapeListOfShape faces_of;
  TopExp::MapShapesAndAncestors(shape, TopAbs_EDGE, TopAbs_FACE, faces_of);
  Contact contact;
  for (int k = 1; k <= faces_of.Extent(); ++k) {
    const TopoDS_Edge edge = TopoDS::Edge(faces_of.FindKey(k));
    if (faces_of(k).Extent() == 1) {
      ++contact.free_edges;
      continue;
    }
    const TopoDS_Face a = TopoDS::Face(faces_of(k).First()), b = TopoDS::Face(faces_of(k).Last());
    double largest = 0;
    for (int step = -60; step <= 60; ++step) {
      const double t = 0.5 + 0.5 * std::tanh(0.15 * step) / std::tanh(9.0);
      largest = std::max(largest, normal_on(a, edge, t).Angle(normal_on(b, edge, t)) * 180 / pi);
    }
    if (largest > 5) {
      ++contact.sharp;
    } else {
      ++contact.smooth;
      contact.smooth_degrees = std::max(contact.smooth_degrees, largest);
    }
  }
  return contact;
}

int crease_edges(const PatchSurface& surface) {
  return static_cast<int>(std::count_if(surface.edges.begin(), surface.edges.end(),
                                        [](const PatchEdge& e) { return e.crease && e.use_count == 2; }));
}

}  // namespace

TEST_CASE("A fitted sphere as STEP: one solid of six faces, its volume within the fit") {
  const Cage cage = test::box_cage(Vec3(-0.6, -0.6, -0.6), Vec3(0.6, 0.6, 0.6), false);
  FitSettings settings;
  settings.levels = 2;
  Progress silent;
  const SurfaceFit fit = fit_surface(cage, *sphere_surface(Vec3::Zero(), 1), settings, silent);
  const FittedLevel& last = fit.levels.back();
  const PatchSurface surface = make_bicubic_patches(last.topology, last.control_points, {}, silent);
  const Scratch scratch;
  const std::string file = scratch.file("sphere.step");
  const std::vector<std::string> names{"ball"};
  write_step(surface, names, {file, "sphere.step", "mm"});

  const TopoDS_Shape shape = read_back(file);
  CHECK(shape.ShapeType() == TopAbs_SOLID);
  CHECK(BRepCheck_Analyzer(shape).IsValid());
  CHECK(count(shape, TopAbs_FACE) == 6);
  CHECK(free_edges_after_sewing(shape, 1e-6) == 0);
  const double deviation =
      2 * std::sqrt(3.0) * fit.max_deviation;  // of the radius; the box's diagonal is 2 sqrt 3
  CHECK(deviation < 1e-3);
  CHECK(volume(shape) == Approx(4e9 / 3 * pi).epsilon(3 * deviation));  // positive: faces outward
  const Contact contact = contact_of(shape);
  CHECK(contact.free_edges == 0);
  CHECK(contact.smooth == 12);
  CHECK(contact.smooth_degrees < 0.1);

  const std::string text = text_of(file);
  CHECK_THAT(text, contains_text("SI_UNIT(.MILLI.,.METRE.)"));
  CadReadSettings read;
  const CadModel model = read_cad(std::vector<std::string>{file}, read, silent);
  REQUIRE(model.summary().groups.size() == 1);
  CHECK(model.summary().groups[0].name == "ball");
  CHECK(model.summary().unit == "mm");
  CHECK(model.summary().warnings.empty());
}

TEST_CASE("STEP units: the same body in each") {
  const PatchSurface surface = patches_of(test::box_cage(Vec3(0, 0, 0), Vec3(0.1, 0.2, 0.3), true), 1);
  const Scratch scratch;
  const std::vector<std::string> names{""};
  Progress silent;
  for (const char* unit : {"m", "mm", "in", "ft"}) {
    INFO(unit);
    const std::string file = scratch.file(std::string(unit) + ".step");
    write_step(surface, names, {file, "box.step", unit});
    const TopoDS_Shape shape = read_back(file);
    CHECK(volume(shape) == Approx(6e6).epsilon(1e-9));
    CHECK(read_cad(std::vector<std::string>{file}, {}, silent).summary().unit == unit);
  }
  CHECK_THROWS_AS(write_step(surface, names, {scratch.file("x.step"), "x.step", "cm"}), Error);
  CHECK_THROWS_AS(write_step(surface, names, {scratch.file("no/x.step"), "x.step", "m"}), Error);
  // The same bytes again.
  write_step(surface, names, {scratch.file("again.step"), "box.step", "m"});
  const bool same = text_of(scratch.file("again.step")) == text_of(scratch.file("m.step"));
  CHECK(same);
}

TEST_CASE("Bodies of every kind as STEP: valid, watertight, smooth but for creases") {
  struct Case {
    std::string name;
    Cage cage;
    bool closed;
    double volume;  // cubic metres; 0: not known
  };
  test::WingCageShape blunt;
  blunt.half_base = 0.002;
  Cage turned = test::box_cage(Vec3(0, 0, 0), Vec3(1, 1, 1), true);
  for (Index f = 0; f < turned.faces.size(); ++f)
    std::reverse(turned.faces[f].begin(), turned.faces[f].end());
  const std::vector<Case> cases{{"torus", test::torus_cage(1, 0.3, 8, 6), true, 0},
                                {"cylinder", test::cylinder_cage(1, 3), true, 0},
                                {"open wing", test::wing_cage({}), false, 0},
                                {"blunt wing", test::wing_cage(blunt), false, 0},
                                {"box", test::box_cage(Vec3(0, 0, 0), Vec3(1, 2, 3), true), true, 6},
                                {"cavity", turned, true, 1}};
  const Scratch scratch;
  const std::vector<std::string> names{"wall"};
  for (const Case& c : cases) {
    INFO(c.name);
    const PatchSurface surface = patches_of(c.cage, 2);
    const std::string file = scratch.file("case.step");
    write_step(surface, names, {file, "case.step", "mm"});
    const TopoDS_Shape shape = read_back(file);
    CHECK(shape.ShapeType() == (c.closed ? TopAbs_SOLID : TopAbs_SHELL));
    CHECK(BRepCheck_Analyzer(shape).IsValid());
    CHECK(count(shape, TopAbs_FACE) == static_cast<int>(surface.patches.size()));
    const Contact contact = contact_of(shape);
    CHECK((contact.free_edges == 0) == c.closed);
    CHECK(contact.free_edges == free_edges_after_sewing(shape, 1e-6));
    CHECK(contact.sharp == crease_edges(surface));
    CHECK(contact.smooth_degrees < 0.1);
    if (c.closed) CHECK(volume(shape) > 0);
    if (c.volume > 0) CHECK(volume(shape) == Approx(1e9 * c.volume).epsilon(1e-9));
  }
}

TEST_CASE("Two bodies become two solids, and gmsh meshes the file") {
  Cage two = test::box_cage(Vec3(0, 0, 0), Vec3(1, 1, 1), false);
  const Cage other = test::cylinder_cage(1, 3);
  const Index shift = static_cast<Index>(two.points.size());
  for (const Vec3& p : other.points) two.points.push_back(p + Vec3(5, 0, 0));
  for (Index f = 0; f < other.faces.size(); ++f) {
    std::vector<Index> row(other.faces[f].begin(), other.faces[f].end());
    for (Index& v : row) v += shift;
    two.faces.push_row(row);
    two.face_patch.push_back(0);
  }
  for (const Cage::Crease& c : other.creases) two.creases.push_back({c.a + shift, c.b + shift, c.sharpness});
  const PatchSurface surface = patches_of(two, 2);
  const Scratch scratch;
  const std::string file = scratch.file("two.step");
  write_step(surface, std::vector<std::string>{"wall"}, {file, "two.step", "m"});
  CHECK(count(read_back(file), TopAbs_SOLID) == 2);
  if (!tests::have_program("gmsh")) return;
  const std::string mesh = scratch.file("two.msh");
  const tests::PeerRun run = tests::run("gmsh -2 -clmax 400 " + file + " -o " + mesh + " 2>&1");
  INFO(run.output);
  CHECK(run.exit_code == 0);
  CHECK(run.output.find("Error") == std::string::npos);
  CHECK(run.output.find("Warning") == std::string::npos);
  CHECK_THAT(text_of(mesh), contains_text("$EndElements"));
}
