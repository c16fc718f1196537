#include "core/cage/read_cage.hpp"

#include <unistd.h>

#include <fstream>
#include <random>
#include <sstream>

#include "core/base/error.hpp"
#include "core/cage/write_cage.hpp"
#include "tests/cage/cage_samples.hpp"
#include "tests/catch.hpp"

using namespace flowcage;
namespace fs = std::filesystem;

namespace {

constexpr const char* triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

std::string written(const Cage& cage) {
  std::ostringstream out;
  write_cage(cage, out);
  return out.str();
}

void check_same(const Cage& a, const Cage& b) {
  CHECK(a.points == b.points);
  CHECK(a.faces == b.faces);
  CHECK(a.creases == b.creases);
  CHECK(a.corners == b.corners);
  CHECK(a.face_patch == b.face_patch);
  CHECK(a.patch_names == b.patch_names);
}

/// The file must be refused with a message that begins with `begin` and contains `text`.
void check_refused(const std::string& content, const std::string& begin, const std::string& text) {
  INFO(content);
  try {
    parse_cage(content, "c.obj");
    FAIL("not refused");
  } catch (const Error& e) {
    CHECK(e.kind() == ErrorKind::input);
    CHECK_THAT(e.what(), Catch::Matchers::StartsWith(begin));
    CHECK_THAT(e.what(), contains_text(text));
    CHECK_FALSE(e.remedy().empty());
  }
}

}  // namespace

TEST_CASE("read_cage: every feature of the format") {
  const Cage cage = parse_cage(prism_text, "prism.obj");
  REQUIRE(cage.points.size() == 10);
  CHECK(cage.points[2] == Vec3(2.5, 1.5, 0));
  CHECK(cage.points[7] == Vec3(2.5, 1.5, 1));
  REQUIRE(cage.faces.size() == 7);
  CHECK(std::vector<Index>(cage.faces[0].begin(), cage.faces[0].end()) == std::vector<Index>{4, 3, 2, 1, 0});
  CHECK(std::vector<Index>(cage.faces[1].begin(), cage.faces[1].end()) == std::vector<Index>{5, 6, 7, 8, 9});
  CHECK(std::vector<Index>(cage.faces[2].begin(), cage.faces[2].end()) == std::vector<Index>{0, 1, 6, 5});
  CHECK(cage.patch_names == std::vector<std::string>{"bottom cap", "top", "sides"});
  CHECK(cage.face_patch == std::vector<Index>{0, 1, 2, 2, 2, 2, 2});
  CHECK(cage.creases == std::vector<Cage::Crease>{{0, 1, 2.5},
                                                  {5, 6, 10},
                                                  {6, 7, 10},
                                                  {7, 8, 3},
                                                  {8, 9, 4},
                                                  {0, 1, infinitely_sharp},
                                                  {1, 2, infinitely_sharp}});
  CHECK(cage.corners == std::vector<Cage::Corner>{{3, 10}});
  CHECK(cage.source == "prism.obj");
}

TEST_CASE("read_cage: line ends, byte order mark, faces before vertices, no last line break") {
  const Cage plain = parse_cage(triangle, "t");
  CHECK(plain.patch_names == std::vector<std::string>{""});
  CHECK(plain.face_patch == std::vector<Index>{0});
  check_same(plain, parse_cage("v 0 0 0\r\nv 1 0 0\r\nv 0 1 \\\r\n0\r\nf 1 2 3", "t"));
  check_same(plain, parse_cage("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r", "t"));
  check_same(plain, parse_cage("\xEF\xBB\xBF"
                               "f 1 2 3\n\tv 0 0 0\n  v 1 0 0  \nv\t0 1 0\n\n",
                               "t"));
}

TEST_CASE("read_cage: g comes before usemtl, usemtl before o") {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\n";
  const auto names = [&](const std::string& faces) { return parse_cage(vertices + faces, "t").patch_names; };
  using Names = std::vector<std::string>;
  CHECK(names("o a\nf 1 2 3\nusemtl b\nf 3 2 4\n") == Names{"a", "b"});
  CHECK(names("g a\nf 1 2 3\nusemtl b\nf 3 2 4\n") == Names{"a"});
  CHECK(names("g a\nusemtl b\nf 1 2 3\ng\nf 3 2 4\n") == Names{"a", "b"});
  CHECK(names("g wing#1 # note\nf 1 2 3\ng unused\ng wing#1\nf 3 2 4\n") == Names{"wing#1"});
}

TEST_CASE("write_cage: what was written is read back, bit for bit") {
  const Cage cage = parse_cage(prism_text, "prism.obj");
  check_same(cage, parse_cage(written(cage), "again"));
  CHECK(written(cage) == written(parse_cage(written(cage), "again")));

  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-300, 300), mantissa(-1, 1);
  for (int run = 0; run < 200; ++run) {
    Cage noisy = cage;
    for (Vec3& p : noisy.points) {
      for (double& x : p) x = mantissa(random) * std::pow(10.0, exponent(random));
    }
    for (Cage::Crease& c : noisy.creases) c.sharpness = std::abs(mantissa(random)) * 1e3;
    for (Cage::Corner& c : noisy.corners) c.sharpness = std::abs(mantissa(random));
    noisy.patch_names = {"", "a b", "#c"};
    const Cage back = parse_cage(written(noisy), "again");
    noisy.patch_names[2] = "_c";
    check_same(noisy, back);
  }
}

TEST_CASE("read_cage: each defect is refused with its line") {
  const std::string v4 = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\n";  // lines 1 to 4
  check_refused("", "c.obj: ", "empty");
  check_refused(" \n", "c.obj: ", "no vertices");
  check_refused("# only a comment\n", "c.obj: ", "no vertices");
  check_refused(v4, "c.obj: ", "no faces");
  check_refused("ISO-10303-21;\nHEADER;\n", "c.obj:1: ", "STEP");
  check_refused("hello world\n", "c.obj:1: ", "\"hello\"");
  check_refused("v 0 0 0\nv 1 \x01\xff\n", "c.obj:2: ", "\"??\" is no number");
  check_refused(std::string("v 0 0 0\nv \0 1 2\n", 16), "c.obj:2: ", "binary");
  check_refused("v 1 2\n", "c.obj:1: ", "coordinate is missing");
  check_refused("v 1,5 2 3\n", "c.obj:1: ", "\"1,5\" is no number");
  check_refused("v 1 2 3x\n", "c.obj:1: ", "\"3x\"");
  check_refused("v 1 2 +-3\n", "c.obj:1: ", "\"+-3\"");
  check_refused("v 1 2 nan\n", "c.obj:1: ", "not finite");
  check_refused("v 1 -inf 3\n", "c.obj:1: ", "not finite");
  check_refused("v 1 1e999 3\n", "c.obj:1: ", "double precision");
  check_refused("v 1 2 3 four\n", "c.obj:1: ", "\"four\"");
  check_refused("deg 3 3\n", "c.obj:1: ", "free-form");

  check_refused(v4 + "f 1 2\n", "c.obj:5: ", "has 2 vertices");
  check_refused(v4 + "f\n", "c.obj:5: ", "has 0 vertices");
  check_refused(v4 + "f 1 2 x\n", "c.obj:5: ", "\"x\"");
  check_refused(v4 + "f 1 2 3.5\n", "c.obj:5: ", "\"3.5\"");
  check_refused(v4 + "f 1/ 2 3\n", "c.obj:5: ", "texture number is missing");
  check_refused(v4 + "f 1/1/ 2 3\n", "c.obj:5: ", "normal number is missing");
  check_refused(v4 + "f 1/1/1/1 2 3\n", "c.obj:5: ", "normal number");
  check_refused(v4 + "f 0 2 3\n", "c.obj:5: ", "count from 1");
  check_refused(v4 + "f 1 2 9\n", "c.obj:5: ", "names vertex 9");
  check_refused(v4 + "f 1 2 -5\n", "c.obj:5: ", "\"-5\" does not exist");
  check_refused(v4 + "f 1 2 99999999999999999999\n", "c.obj:5: ", "no whole number");
  check_refused(v4 + "f 1 2 3000000000\n", "c.obj:5: ", "does not exist");
  check_refused(v4 + "f 1 2 3 2\n", "c.obj:5: ", "twice");
  check_refused(v4 + "f 1 2 3\n", "c.obj:4: ", "vertex 4 at (1, 1, 1) belongs to no face");
  check_refused(v4 + "\nf 1 2 3\nf 1 2 4\n", "c.obj:7: ", "same direction");
  check_refused(v4 + "v 5 5 5\nf 1 2 3\nf 2 1 4\nf 1 2 5\n", "c.obj:8: ", "more than two faces");
  check_refused(v4 + "v 1 0 0\nf 1 2 3\nf 3 5 4\n", "c.obj:5: ", "repeats vertex 2");
  check_refused("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nf 1 2 3\nf 1 4 5\n", "c.obj:1: ", "one fan");

  const std::string quad = v4 + "f 1 2 4 3\n";
  check_refused(quad + "t crease 2/1/0 0 3 2\n", "c.obj:6: ", "no edge");
  check_refused(quad + "t crease 2/1/0 0 4 2\n", "c.obj:6: ", "names vertex 5");
  check_refused(quad + "t crease 2/1/0 0 -1 2\n", "c.obj:6: ", "does not exist");
  check_refused(quad + "t crease 2/1/0 0 1 -2\n", "c.obj:6: ", "negative");
  check_refused(quad + "t crease 2/1/0 0 1 nan\n", "c.obj:6: ", "not finite");
  check_refused(quad + "t crease 2/1/0 0 1\n", "c.obj:6: ", "sharpness is missing");
  check_refused(quad + "t crease 2/1/0 0 1 2 3\n", "c.obj:6: ", "follows the tag");
  check_refused(quad + "t crease 0 1 2\n", "c.obj:6: ", "malformed");
  check_refused(quad + "t crease 3/1/0 0 1 2 2\n", "c.obj:6: ", "do not suit");
  check_refused(quad + "t crease 999999998/1/0 0 1 2\n", "c.obj:6: ", "vertex number");
  check_refused(quad + "t corner 1/1/0 7 2\n", "c.obj:6: ", "names vertex 8");
  check_refused(quad + "t hole 1/0/0 0\n", "c.obj:6: ", "\"hole\" is not supported");
  check_refused(quad + "t\n", "c.obj:6: ", "not supported");
  check_refused(quad + "l 1\n", "c.obj:6: ", "fewer than two");
  check_refused(quad + "l 1 2 3\n", "c.obj:6: ", "no edge");
  // The line where a continued statement begins.
  check_refused(v4 + "f 1 \\\n 2 \\\n 3\nf 1 2 \\\n 4\n", "c.obj:8: ", "same direction");
}

TEST_CASE("read_cage: files that are none") {
  const fs::path folder = fs::temp_directory_path();
  CHECK_THROWS_WITH(read_cage("no/such/file.obj"),
                    contains_text("no/such/file.obj: cannot read: No such file"));
  CHECK_THROWS_WITH(read_cage(folder), contains_text("Is a directory"));
  if (fs::exists("/dev/null"))
    CHECK_THROWS_WITH(read_cage("/dev/null"), contains_text("/dev/null: the file is empty"));
  const fs::path file = folder / ("flowcage_cage_" + std::to_string(::getpid()) + ".obj");
  const Cage cage = parse_cage(prism_text, "prism.obj");
  write_cage(cage, file);
  check_same(cage, read_cage(file));
  fs::remove(file);
}

TEST_CASE("scale_cage") {
  Cage cage = scale_cage(parse_cage(triangle, "t.obj"), 0.001);
  CHECK(cage.points[1] == Vec3(0.001, 0, 0));
  CHECK_THROWS_WITH(scale_cage(parse_cage("v 0 0 0\nv 1e300 0 0\nv 0 1 0\nf 1 2 3\n", "t.obj"), 1e10),
                    contains_text("t.obj: a vertex overflows"));
}
