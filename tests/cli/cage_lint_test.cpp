// What surface and mesh say of a cage before they fit it, and what they put right in it.
#include <sstream>

#include "occ_bridge/shapes.hpp"
#include "tests/catch.hpp"
#include "tests/cli/run_program.hpp"

using namespace flowcage;
using Strings = std::vector<std::string>;

namespace {

constexpr const char* faces[] = {"1 3 4 2", "5 6 8 7", "3 7 8 4", "1 5 7 3", "2 4 8 6", "1 2 6 5"};

/// A cube's cage, 0.9 m wide, in millimetres; `turned` faces (from the end) run the other way.
std::string cube_cage(int turned = 0) {
  std::ostringstream text;
  for (int i = 0; i < 8; ++i) {
    text << "v " << ((i & 1) != 0 ? 450 : -450) << ' ' << ((i & 2) != 0 ? 450 : -450) << ' '
         << ((i & 4) != 0 ? 450 : -450) << '\n';
  }
  for (int f = 0; f < 6; ++f) {
    std::istringstream corners(faces[f]);
    Strings face(4);
    for (std::string& corner : face) corners >> corner;
    if (f >= 6 - turned) std::swap(face[1], face[3]);
    text << 'f';
    for (const std::string& corner : face) text << ' ' << corner;
    text << '\n';
  }
  return text.str();
}

class Body : public WorkFolder {
 public:
  Body(const Shape& shape, const std::string& cage) {
    write_cad(shape, (path() / "body.step").string(), "mm");
    put("cage.obj", cage);
  }
  ProgramRun run(const Strings& rest = {"surface", "-o", "x.obj"}) const {
    Strings arguments{rest.front(), "body.step", "--cage", "cage.obj", "--levels", "1", "--json", "x.json"};
    arguments.insert(arguments.end(), rest.begin() + 1, rest.end());
    return run_flowcage(arguments, {.folder = path()});
  }
};

}  // namespace

TEST_CASE("creases along the CAD's sharp edges are found where the cage has none") {
  const Body box(make_box(Vec3(1, 1, 1)), cube_cage());
  const ProgramRun run = box.run({"mesh", "-o", "x.vtu"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);  // the gates: within 1e-4 only if all twelve edges are sharp
  CHECK_THAT(run.err, contains_text("12 of its edges were made creases along 12 of the CAD's 12 chains"));
  const std::string json = box.text_of("x.json");
  CHECK_THAT(json, contains_text("\"crease_edges\": 12"));
  CHECK_THAT(json, contains_text("\"creases\": \"found\""));
  CHECK_THAT(json, contains_text("\"lint\": []"));
}

TEST_CASE("a cage with any crease is taken as it was drawn") {
  const Body box(make_box(Vec3(1, 1, 1)), cube_cage() + "l 1 2\n");
  const ProgramRun run = box.run({"surface", "-o", "x.obj", "--force"});
  CHECK(run.exit_code == 4);
  CHECK_THAT(box.text_of("x.json"), contains_text("\"crease_edges\": 1,"));
  CHECK_THAT(box.text_of("x.json"), contains_text("\"creases\": \"file\""));
  const Body smooth(make_box(Vec3(1, 1, 1)), cube_cage() + "t crease 2/1/0 0 1 0\n");
  CHECK(smooth.run({"surface", "-o", "x.obj", "--force"}).exit_code == 4);
  CHECK_THAT(smooth.text_of("x.json"), contains_text("\"crease_edges\": 0,"));
}

TEST_CASE("faces that are turned round are reversed, with a word") {
  for (const int turned : {2, 6}) {
    const Body sphere(make_sphere(0.5), cube_cage(turned));
    const ProgramRun run = sphere.run({"surface", "-o", "x.obj", "--tolerance", "1e-3"});
    INFO(run.err);
    CHECK(run.exit_code == 0);
    const char* rule = turned == 2 ? "face_direction" : "inside_out";
    CHECK_THAT(sphere.text_of("x.json"), contains_text(std::string("\"rule\": \"") + rule + "\""));
    CHECK_THAT(sphere.text_of("x.json"), contains_text("\"severity\": \"mended\""));
    CHECK_THAT(run.err, contains_text("reversed"));
  }
}

TEST_CASE("a cage of another genus than the CAD: exit 3 with the numbers") {
  const Body torus(make_torus(0.4, 0.15), cube_cage());
  const ProgramRun run = torus.run();
  INFO(run.err);
  CHECK(run.exit_code == 3);
  CHECK_THAT(run.err, contains_text("flowcage: cage.obj: the cage has genus 0 (V - E + F = 2"));
  CHECK_THAT(run.err, contains_text("the CAD genus 1 (V - E + F = 0"));
  CHECK(torus.entries() == Strings{"body.step", "cage.obj"});
}
