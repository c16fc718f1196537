// Names, colours, layers and instances: what was written is what is read, through sewing and splitting.
#include <algorithm>
#include <map>
#include <set>

#include "occ_bridge/cad_model.hpp"
#include "occ_bridge/internal/face_labels.hpp"
#include "tests/catch.hpp"
#include "tests/occ_bridge/cad_scratch.hpp"
#include "tests/occ_bridge/labelled_cad.hpp"

using namespace flowcage;

namespace {

CadModel read_files(const std::vector<std::string>& files, const CadReadSettings& settings = {}) {
  Progress silent;
  return read_cad(files, settings, silent);
}

std::vector<CadFace> faces_of(const CadModel& model) {
  std::vector<CadFace> faces;
  for (Index f = 0; f < model.face_count(); ++f) faces.push_back(model.face(f));
  return faces;
}

std::multiset<std::string> values(const CadModel& model, std::string CadFace::*field) {
  std::multiset<std::string> result;
  for (const CadFace& face : faces_of(model)) result.insert(face.*field);
  return result;
}

Error refusal(const std::vector<std::string>& files, const CadReadSettings& settings) {
  try {
    read_files(files, settings);
  } catch (const Error& error) {
    return error;
  }
  FAIL("no error");
  return {ErrorKind::internal, "", ""};
}

/// A nacelle twice under a wing that has one face of its own name, one of its own colour.
std::vector<TaggedPart> airliner() {
  return {{.shape = make_box({2, 1, 0.1}),
           .tag = {.name = "wing", .color = "#336699", .layer = "lifting"},
           .faces = {{.name = "root"}, {.color = "#ff0000", .layer = "tips"}}},
          {.shape = make_cylinder(0.1, 0.5),
           .tag = {.name = "nacelle", .color = "#00ff00"},
           .faces = {{.color = "#ffffff"}},
           .places = {{0, 0.5, -0.5}, {0, -0.5, -0.5}},
           .instances = {{.name = "left"}, {.name = "right", .color = "#0000ff"}}}};
}

}  // namespace

TEST_CASE("STEP: every instance of a part stands where it belongs, in any unit") {
  const Scratch scratch;
  for (const char* unit : {"MM", "M", "INCH"}) {
    CAPTURE(unit);
    const std::string file = scratch.file("airliner.step");
    write_tagged(airliner(), file, unit);
    CadReadSettings settings;
    settings.unite = false;  // the nacelles touch the wing
    const CadModel model = read_files({file}, settings);
    CHECK(model.summary().solids == 3);
    CHECK(model.summary().closed());
    CHECK(model.face_count() == 6 + 2 * 3);
    std::map<std::string, Box3> boxes;
    for (const CadFace& face : faces_of(model)) boxes[face.part + "|" + face.instance].extend(face.bounds);
    REQUIRE(boxes.size() == 3);
    CHECK(boxes["nacelle|left"].center().isApprox(Vec3(0, 0.5, -0.25), 1e-6));
    CHECK(boxes["nacelle|right"].center().isApprox(Vec3(0, -0.5, -0.25), 1e-6));
    std::vector<Index> numbers;
    for (const CadFace& face : faces_of(model)) numbers.push_back(face.number);
    std::ranges::sort(numbers);
    for (Index n = 0; n < 12; ++n) CHECK(numbers[n] == n + 1);
  }
}

TEST_CASE("STEP: the nearest name, colour and layer counts") {
  const Scratch scratch;
  const std::string file = scratch.file("airliner.step");
  write_tagged(airliner(), file);
  const CadModel model = read_files({file});
  std::map<std::string, std::multiset<std::string>> colors;
  std::multiset<std::string> wing_layers;
  for (const CadFace& face : faces_of(model)) {
    colors[face.part + "|" + face.instance].insert(face.color);
    if (face.part == "wing") wing_layers.insert(face.layer);
    if (face.part == "nacelle") CHECK(face.layer.empty());
  }
  // A face's own before its part's; an instance's before its part's, but not before the face's own.
  CHECK(colors["nacelle|left"] == std::multiset<std::string>{"#00ff00", "#00ff00", "#ffffff"});
  CHECK(colors["nacelle|right"] == std::multiset<std::string>{"#0000ff", "#0000ff", "#ffffff"});
  const std::string wing = colors.contains("wing|") ? "wing|" : "wing|wing";
  CHECK(colors[wing].count("#336699") == 5);
  CHECK(colors[wing].count("#ff0000") == 1);
  CHECK(wing_layers.count("lifting") == 5);
  CHECK(wing_layers.count("tips") == 1);
  CHECK(values(model, &CadFace::name).count("root") == 1);
  // Patch names: the face's own name, else the part's, as these tell the faces apart.
  CHECK(values(model, &CadFace::group).count("root") == 1);
  CHECK(values(model, &CadFace::group).count("wing") == 5);
  CHECK(values(model, &CadFace::group).count("nacelle") == 6);
  CHECK(model.face_name(0) == model.face(0).group);
}

TEST_CASE("IGES: colours and levels of faces") {
  const Scratch scratch;
  const std::string file = scratch.file("box.igs");
  write_tagged({{.shape = make_box({1, 1, 1}),
                 .tag = {.color = "#00ff00"},
                 .faces = {{.color = "#ff0000"}, {.color = "#336699"}}}},
               file);
  const CadModel model = read_files({file});
  CHECK(values(model, &CadFace::color).count("#ff0000") == 1);
  CHECK(values(model, &CadFace::color).count("#336699") == 1);
  CHECK(values(model, &CadFace::color).count("#00ff00") == 4);
  CHECK(values(model, &CadFace::group).count("#00ff00") == 4);  // nothing else tells them apart
}

TEST_CASE("labels survive sewing and splitting") {
  // Loose faces of a box, each with a name: sewn to a solid.
  const Scratch scratch;
  const double a = 1;
  const std::vector<std::vector<Vec3>> sides{
      {{0, 0, 0}, {0, a, 0}, {a, a, 0}, {a, 0, 0}}, {{0, 0, a}, {a, 0, a}, {a, a, a}, {0, a, a}},
      {{0, 0, 0}, {a, 0, 0}, {a, 0, a}, {0, 0, a}}, {{0, a, 0}, {0, a, a}, {a, a, a}, {a, a, 0}},
      {{0, 0, 0}, {0, 0, a}, {0, a, a}, {0, a, 0}}, {{a, 0, 0}, {a, a, 0}, {a, a, a}, {a, 0, a}}};
  const std::vector<Tag> tags{{.name = "bottom"}, {.name = "top"},  {.name = "front"},
                              {.name = "back"},   {.name = "left"}, {.name = "right"}};
  const std::string file = scratch.file("loose.step");
  write_tagged({{.shape = make_faces(sides, false), .tag = {.name = "crate"}, .faces = tags}}, file);
  const CadModel model = read_files({file});
  CHECK(model.summary().free_edges_before == 24);
  CHECK(model.summary().closed());
  for (const CadFace& face : faces_of(model)) {
    CAPTURE(face.name);
    CHECK(face.group == face.name);
    const Vec3 middle = face.bounds.center();
    const std::map<std::string, Vec3> expected{{"bottom", {.5, .5, 0}}, {"top", {.5, .5, 1}},
                                               {"front", {.5, 0, .5}},  {"back", {.5, 1, .5}},
                                               {"left", {0, .5, .5}},   {"right", {1, .5, .5}}};
    REQUIRE(expected.contains(face.name));
    CHECK((expected.at(face.name) - middle).norm() < 1e-9);
  }
}

TEST_CASE("the parts of a split face share its number and name, and its neighbours keep theirs") {
  // A roof folded along a knot line, closed to a prism: the gables' edges are split with it.
  const Scratch scratch;
  const std::string file = scratch.file("roof.step");
  const Shape roof = make_folded_roof();
  write_tagged({{.shape = roof, .tag = {.name = "shed"}, .faces = {{.name = "roof"}, {.name = "gable"}}}},
               file);
  const CadModel model = read_files({file});
  CHECK(model.face_count() == 5);
  CHECK(values(model, &CadFace::name) == std::multiset<std::string>{"", "", "gable", "roof", "roof"});
  for (const CadFace& face : faces_of(model))
    CHECK(face.number == (face.name == "roof" ? 1 : std::max<Index>(2, face.number)));
}

TEST_CASE("patch names: the first that tells the faces apart") {
  const auto groups = [](std::vector<CadFace> faces) {
    occ::choose_groups(faces);
    std::vector<std::string> names;
    for (const CadFace& face : faces) names.push_back(face.group);
    return names;
  };
  using Names = std::vector<std::string>;
  // One product around everything says nothing; its colours do.
  CHECK(groups({{.part = "car", .color = "#ff0000"}, {.part = "car", .color = "#0000ff"}}) ==
        Names{"#ff0000", "#0000ff"});
  CHECK(groups({{.part = "car", .layer = "1", .color = "#ff0000"},
                {.part = "car", .layer = "1", .color = "#ff0000"}}) == Names{"car", "car"});
  CHECK(groups({{.name = "inlet", .solid = "duct"}, {.solid = "duct"}, {.solid = "valve"}}) ==
        Names{"inlet", "duct", "valve"});
  CHECK(groups({{.file = "a"}, {.file = "b"}}) == Names{"a", "b"});
  CHECK(groups({{.color = "#ff0000", .file = "a"}, {.color = "#ff0000", .file = "a"}}) == Names{"", ""});
}

TEST_CASE("names are one line of UTF-8, and placeholders are none") {
  CHECK(occ::clean_name("  left wing\r\n") == "left wing");
  CHECK(occ::clean_name("NONE").empty());
  CHECK(occ::clean_name("#2068").empty());
  CHECK(occ::clean_name("#2068b") == "#2068b");
  CHECK(occ::clean_name("Open CASCADE STEP translator 7.6 1").empty());
  CHECK(occ::clean_name("Fl\xFCgel") == "Fl\xEF\xBF\xBDgel");            // Latin-1
  CHECK(occ::clean_name("Fl\xC3\xBCgel") == "Fl\xC3\xBCgel");            // UTF-8
  CHECK(occ::clean_name("a\xC0\x80z") == "a\xEF\xBF\xBD\xEF\xBF\xBDz");  // overlong
  CHECK(occ::clean_name("<script>") == "<script>");
}

TEST_CASE("faces are taken and left out by name, colour, layer, part and number") {
  const Scratch scratch;
  const std::string file = scratch.file("airliner.step");
  write_tagged(airliner(), file);
  const auto count = [&](const std::vector<std::string>& include, const std::vector<std::string>& exclude) {
    CadReadSettings settings;
    settings.include = include;
    settings.exclude = exclude;
    const CadModel model = read_files({file}, settings);
    CHECK(model.summary().faces_left_out == 12 - model.face_count());
    return model.face_count();
  };
  CHECK(count({"wing"}, {}) == 6);
  CHECK(count({"nac*"}, {}) == 6);
  CHECK(count({"n?celle"}, {"color:#00FF00"}) == 4);
  CHECK(count({"part:wing"}, {"layer:tips"}) == 5);
  CHECK(count({"name:root", "colour:#f*"}, {}) == 4);  // the root, a red tip, two white ends
  CHECK(count({"instance:left"}, {}) == 3);
  CHECK(count({}, {"nacelle"}) == 6);
  CHECK(count({"face:1-3,12"}, {"face:2"}) == 3);
  // Numbers are those of the file, whatever is left out.
  CadReadSettings settings;
  settings.exclude = {"face:1-3"};
  const CadModel rest = read_files({file}, settings);
  for (const CadFace& face : faces_of(rest)) CHECK(face.number > 3);
  CHECK(rest.summary().free_edges > 0);  // its solid is open now
}

TEST_CASE("a pattern that matches nothing is refused with what there is") {
  const Scratch scratch;
  const std::string file = scratch.file("airliner.step");
  write_tagged(airliner(), file);
  const auto refused = [&](const std::string& pattern) {
    CadReadSettings settings;
    settings.include = {pattern};
    const Error error = refusal({file}, settings);
    CHECK(error.kind() == ErrorKind::usage);
    CHECK(std::string(error.what()).find("--include \"" + pattern + "\"") == 0);
    return error;
  };
  CHECK(refused("nacele").remedy().find("did you mean \"nacelle\"?") == 0);
  CHECK(refused("nacele").remedy().find("part:nacelle (6 faces)") != std::string::npos);
  CHECK(refused("layer:wing").remedy().find("layer:lifting (5 faces)") != std::string::npos);
  CHECK(refused("layer:wing").remedy().find("part:") == std::string::npos);
  CHECK(std::string(refused("face:13").what()).find("faces 1 to 12") != std::string::npos);
  CHECK(std::string(refused("face:0").what()).find("no face number") != std::string::npos);
  CHECK(std::string(refused("face:4-2").what()).find("descend") != std::string::npos);
  CadReadSettings settings;
  settings.exclude = {"*"};
  CHECK(std::string(refusal({file}, settings).what()).find("leave no face") != std::string::npos);
}

TEST_CASE("several files: their names tell their faces apart") {
  const Scratch scratch;
  const std::vector<std::string> files{scratch.file("hull.step"), scratch.file("rudder.igs")};
  write_cad(make_box({2, 1, 1}), files[0], "m");
  write_cad(translated(make_box({0.2, 0.1, 1}), {3, 0, 0}), files[1], "mm");
  const CadModel model = read_files(files);
  CHECK(values(model, &CadFace::group) == std::multiset<std::string>{"hull", "hull", "hull", "hull", "hull",
                                                                     "hull", "rudder", "rudder", "rudder",
                                                                     "rudder", "rudder", "rudder"});
  CadReadSettings settings;
  settings.include = {"file:rudder"};
  const CadModel rudder = read_files(files, settings);
  CHECK(rudder.face_count() == 6);
  CHECK(rudder.face(0).number == 7);
  CHECK(rudder.bounds().min().x() == Approx(2.9));
}
