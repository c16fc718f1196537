// Reading CAD, on shapes built in code: every count, length and volume below is known in closed form.
#include <cmath>
#include <numbers>
#include <random>

#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/arc_length.hpp"
#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/occ_bridge/cad_scratch.hpp"

using namespace flowcage;

namespace {

constexpr double pi = std::numbers::pi;

CadModel model_of(const Shape& shape, const CadReadSettings& settings = {}) {
  Progress silent;
  return cad_model_of(shape, settings, silent);
}

CadModel read_one(const std::string& file, const CadReadSettings& settings = {}) {
  Progress silent;
  return read_cad({&file, 1}, settings, silent);
}

double volume(const Tessellation& mesh) {
  double six = 0;
  for (const auto& t : mesh.triangles) {
    six += mesh.points[t[0]].dot(mesh.points[t[1]].cross(mesh.points[t[2]]));
  }
  return six / 6;
}

template <typename Call>
Error error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  FAIL("no error");
  return {ErrorKind::internal, "", ""};
}

}  // namespace

TEST_CASE("arc length of an ellipse is the complete elliptic integral, and inverts") {
  const double a = 2, b = 1;
  const auto speed = [&](double t) { return std::hypot(a * std::sin(t), b * std::cos(t)); };
  const std::vector<double> breaks{0, 1, 2 * pi};
  const ArcLengthTable table(speed, breaks);
  CHECK(table.length() == Approx(4 * a * std::comp_ellint_2(std::sqrt(1 - b * b / (a * a)))).epsilon(1e-13));
  for (int i = 0; i <= 50; ++i) {
    const double t = 2 * pi * i / 50;
    CHECK(table.t_of(table.s_of(t)) == Approx(t).epsilon(1e-13).margin(1e-13));
    const double quarter_turns = a * std::ellint_2(std::sqrt(1 - b * b / (a * a)), t - pi / 2) +
                                 a * std::comp_ellint_2(std::sqrt(1 - b * b / (a * a)));
    CHECK(table.s_of(t) == Approx(quarter_turns).epsilon(1e-12).margin(1e-12));
  }
  // A speed that vanishes at the start, c(t) = (t^2, t^3) on [0, 1]: length ((13)^(3/2) - 8) / 27.
  const std::vector<double> unit{0, 1};
  const ArcLengthTable cusp([](double t) { return t * std::sqrt(4 + 9 * t * t); }, unit);
  CHECK(cusp.length() == Approx((std::pow(13.0, 1.5) - 8) / 27).epsilon(1e-12));
}

TEST_CASE("a box: 12 sharp edges, each a chain between two of 8 corners") {
  const CadModel box = model_of(make_box({1, 2, 3}));
  const CadSummary& found = box.summary();
  CHECK(found.solids == 1);
  CHECK(found.faces == 6);
  CHECK(found.edges == 12);
  CHECK(found.vertices == 8);
  CHECK(found.sharp_edges == 12);
  CHECK(found.sharp_chains == 12);
  CHECK(found.boundary_chains == 0);
  CHECK(found.corners == 8);
  CHECK(found.closed());
  CHECK(found.warnings.empty());
  CHECK(found.diagonal == Approx(std::sqrt(14.0)).epsilon(1e-12));
  CHECK(volume(box.tessellation()) == Approx(6).epsilon(1e-12));
  CHECK(box.tessellation().points.size() == 8);  // shared along the edges
  double sum = 0;
  for (const FeatureChain& chain : box.features().chains) {
    sum += chain.length;
    CHECK(chain.faces.size() == 2);
    CHECK(chain.start != chain.end);
    CHECK((box.features().corners[chain.start] - chain.polyline.front()).norm() < 1e-12);
    CHECK((box.features().corners[chain.end] - chain.polyline.back()).norm() < 1e-12);
  }
  CHECK(sum == Approx(4 * 6).epsilon(1e-12));
}

TEST_CASE("smooth bodies have no features, seams and fillets included") {
  CHECK(model_of(make_sphere(2)).features().chains.empty());
  CHECK(model_of(make_torus(2, 0.5)).features().chains.empty());
  const CadModel rounded = model_of(make_rounded_box({1, 1, 1}, 0.2));
  CHECK(rounded.summary().faces == 26);
  CHECK(rounded.summary().sharp_edges == 0);
}

TEST_CASE("a cylinder: two rims without corner, parametrised by arc length") {
  const double r = 0.7;
  const CadModel cylinder = model_of(make_cylinder(r, 2));
  const FeatureGraph& graph = cylinder.features();
  REQUIRE(graph.chains.size() == 2);
  CHECK(graph.corners.empty());
  for (Index c = 0; c < 2; ++c) {
    const FeatureChain& rim = graph.chains[c];
    CHECK(rim.start == no_index);
    CHECK(rim.end == no_index);
    CHECK(rim.length == Approx(2 * pi * r).epsilon(1e-13));
    CHECK((rim.polyline.front() - rim.polyline.back()).norm() < 1e-12);
    CHECK(rim.polyline_s.back() == Approx(rim.length).epsilon(1e-13));
    const CurvePoint start = cylinder.chain_point(c, 0);
    for (const double s : {0.3, 1.7, 4.0}) {
      const CurvePoint p = cylinder.chain_point(c, s);
      CHECK(p.position.head<2>().norm() == Approx(r).epsilon(1e-13));
      const double turn = std::acos(start.position.head<2>().dot(p.position.head<2>()) / (r * r));
      CHECK(turn == Approx(s / r > pi ? 2 * pi - s / r : s / r).epsilon(1e-10));
      CHECK((cylinder.chain_point(c, s + rim.length).position - p.position).norm() < 1e-12);  // wraps
      const double h = 1e-6;
      const Vec3 secant = cylinder.chain_point(c, s + h).position - cylinder.chain_point(c, s - h).position;
      CHECK((secant / (2 * h) - p.tangent).norm() < 1e-8);
    }
    // The nearest point of a circle is known.
    std::mt19937 random(7);
    std::uniform_real_distribution<double> in(-2, 2);
    for (int i = 0; i < 200; ++i) {
      const Vec3 q(in(random), in(random), in(random));
      const CurvePoint foot = cylinder.closest_on_chain(c, q);
      Vec3 exact = r * Vec3(q.x(), q.y(), 0).normalized();
      exact.z() = start.position.z();
      CHECK((foot.position - exact).norm() < 1e-9);
      CHECK((cylinder.chain_point(c, foot.s).position - foot.position).norm() < 1e-9);
    }
  }
}

TEST_CASE("a half wing: open root, sharp trailing edge and flat tip; exact curves, not their polylines") {
  HalfWing wing;
  wing.airfoil = naca_symmetric(0.12, 0);
  const CadModel model = model_of(make_half_wing(wing));
  const CadSummary& found = model.summary();
  CHECK(found.free_edges == 2);  // upper and lower section curve at the root
  CHECK(found.boundary_chains + found.sharp_chains == static_cast<Index>(model.features().chains.size()));
  // Nearest points of every chain against a search among 20,000 of its points.
  std::mt19937 random(3);
  std::uniform_real_distribution<double> in(-0.2, 1.2);
  for (Index c = 0; c < static_cast<Index>(model.features().chains.size()); ++c) {
    const FeatureChain& chain = model.features().chains[c];
    for (int i = 0; i < 3; ++i) {
      const Vec3 q(in(random), 2 * in(random), in(random));
      const CurvePoint foot = model.closest_on_chain(c, q);
      double best = 1e300;
      for (int k = 0; k <= 20000; ++k) {
        best = std::min(best, (model.chain_point(c, chain.length * k / 20000.0).position - q).norm());
      }
      CHECK(foot.distance <= best + 1e-12);
      CHECK(foot.distance >= best - chain.length / 20000);
    }
    // s is arc length: a dense polyline by s has the same length to second order.
    double sum = 0;
    Vec3 before = model.chain_point(c, 0).position;
    for (int k = 1; k <= 20000; ++k) {
      const Vec3 p = model.chain_point(c, chain.length * k / 20000.0).position;
      const double step = (p - before).norm();
      CHECK(step == Approx(chain.length / 20000).epsilon(1e-4));
      sum += step;
      before = p;
    }
    CHECK(sum == Approx(chain.length).epsilon(1e-6));
  }
}

TEST_CASE("STEP, IGES and BREP round trips give the same body in metres, whatever the file's unit") {
  const Scratch scratch;
  const Shape body = make_difference(make_box({0.3, 0.2, 0.1}), make_cylinder(0.03, 1));
  const CadModel direct = model_of(body);
  for (const char* unit : {"mm", "m", "in"}) {
    for (const char* name : {"a.step", "b.STP", "c.igs", "d.IGES"}) {
      CAPTURE(unit, name);
      const std::string file = scratch.file(std::string(unit) + "_" + name);
      try {
        write_cad(body, file, unit);
      } catch (const Error&) {
        continue;  // the writer takes lower-case extensions only
      }
      const CadModel model = read_one(file);
      const CadSummary& found = model.summary();
      CHECK(found.warnings.empty());
      CHECK(found.solids == 1);
      CHECK(found.closed());
      CHECK(found.faces == direct.summary().faces);
      CHECK(found.sharp_edges == direct.summary().sharp_edges);
      CHECK(found.sharp_chains == direct.summary().sharp_chains);
      CHECK(found.corners == direct.summary().corners);
      CHECK((found.bounds.min() - direct.bounds().min()).norm() < 1e-9);
      CHECK((found.bounds.max() - direct.bounds().max()).norm() < 1e-9);
      CHECK(volume(model.tessellation()) == Approx(volume(direct.tessellation())).epsilon(1e-4));
    }
  }
  const std::string brep = scratch.file("e.brep");
  write_cad(body, brep);
  CHECK(read_one(brep).summary().diagonal == Approx(direct.diagonal()).epsilon(1e-9));
}

TEST_CASE("a given unit overrules that of the file") {
  const Scratch scratch;
  const std::string file = scratch.file("box.step");
  write_cad(make_box({1, 1, 1}), file, "mm");
  CadReadSettings settings;
  settings.cad_unit = "ft";
  CHECK(read_one(file, settings).diagonal() == Approx(std::sqrt(3.0) * 304.8).epsilon(1e-12));
  settings.cad_unit = "parsec";
  CHECK(error_of([&] { read_one(file, settings); }).kind() == ErrorKind::usage);
}

TEST_CASE("several files are one model") {
  const Scratch scratch;
  const std::vector<std::string> files{scratch.file("a.step"), scratch.file("b.igs")};
  write_cad(make_box({1, 1, 1}), files[0], "in");
  write_cad(translated(make_box({1, 1, 1}), {3, 0, 0}), files[1], "mm");
  Progress silent;
  const CadModel model = read_cad(files, {}, silent);
  CHECK(model.summary().solids == 2);
  CHECK(model.bounds().sizes().isApprox(Vec3(4, 1, 1), 1e-9));
}

TEST_CASE("input that is no CAD is refused by name, with a remedy") {
  const Scratch scratch;
  const auto refused = [](const std::string& file, const std::string& why) {
    const Error error = error_of([&] { read_one(file); });
    CAPTURE(file, std::string(error.what()));
    CHECK(error.kind() == ErrorKind::input);
    CHECK(std::string(error.what()).find(file) == 0);
    CHECK(std::string(error.what()).find(why) != std::string::npos);
    CHECK(std::string(error.what()).find('\n') == std::string::npos);
    CHECK(!error.remedy().empty());
  };
  refused(scratch.file("missing.step"), "no such file");
  refused(scratch.path.string(), "folder");
  refused(scratch.write("empty.step", ""), "empty");
  refused(scratch.write("text.step", "a letter to my aunt\n"), "ISO-10303-21");
  refused(scratch.write("text.igs", "a letter to my aunt\n"), "IGES");
  refused(scratch.write("text.xyz", "a letter to my aunt\n"), "neither");
  refused(scratch.write("binary.step", std::string("PK\3\4\0\0\0", 7)), "binary");
  refused(scratch.write("head.step", "ISO-10303-21;\nHEADER;\n"), "cut off");
  refused(scratch.write("bare.step", "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"),
          "");

  write_cad(make_cylinder(1, 2), scratch.file("whole.step"), "mm");
  write_cad(make_cylinder(1, 2), scratch.file("whole.igs"), "mm");
  const std::string step = text_of(scratch.file("whole.step")), iges = text_of(scratch.file("whole.igs"));
  refused(scratch.write("half.step", step.substr(0, step.size() / 2)), "cut off");
  refused(scratch.write("half.igs", iges.substr(0, iges.size() / 2)), "cut off");
  CHECK_NOTHROW(read_one(scratch.write("step_in_disguise.igs", step)));
}

TEST_CASE("a cancelled reading ends with Error(interrupted)") {
  struct Impatient : Progress {
    bool cancelled() const override { return true; }
  } impatient;
  const Shape box = make_box({1, 1, 1});
  const Error error = error_of([&] { cad_model_of(box, {}, impatient); });
  CHECK(error.kind() == ErrorKind::interrupted);
}

TEST_CASE("closest points of a read model: a small cylinder's distances are known") {
  const Scratch scratch;
  const double r = 2e-5, h = 5e-5;  // metres: the kernel's absolute tolerances must not show
  const std::string file = scratch.file("pin.step");
  write_cad(make_cylinder(r, h), file, "mm");
  const CadModel pin = read_one(file);
  CHECK(pin.diagonal() == Approx(std::hypot(2 * r, 2 * r, h)).epsilon(1e-6));
  std::mt19937 random(11);
  std::uniform_real_distribution<double> in(-2, 2);
  std::vector<Vec3> queries;
  for (int i = 0; i < 500; ++i) queries.push_back(r * Vec3(in(random), in(random), 2 * in(random)));
  std::vector<SurfacePoint> found(queries.size());
  pin.closest_points(queries, {}, found);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Vec3& q = queries[i];
    const double radial = q.head<2>().norm() - r, axial = std::abs(q.z() - h / 2) - h / 2;
    const double outside = std::hypot(std::max(radial, 0.0), std::max(axial, 0.0));
    const double exact = outside > 0 ? outside : -std::max(radial, axial);
    CHECK(found[i].distance == Approx(exact).margin(1e-9 * r));
    if (found[i].status == FootStatus::interior) {
      const double side = outside > 0 ? 1 : -1;  // the normal points out of the body
      CHECK((q - found[i].position).dot(found[i].normal) == Approx(side * exact).margin(1e-9 * r));
    }
  }
}
