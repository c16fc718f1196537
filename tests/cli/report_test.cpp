// --report: the page that surface, mesh and inspect leave, opened in headless Chromium from a file.
#include <fstream>
#include <regex>
#include <sstream>

#include "cli/report/color_map.hpp"
#include "tests/catch.hpp"
#include "tests/cli/png_image.hpp"
#include "tests/cli/sphere_folder.hpp"
#include "tests/export/peers.hpp"
#include "tests/occ_bridge/labelled_cad.hpp"

using namespace flowcage;
using Strings = std::vector<std::string>;
using tests::PngImage;

namespace {

// Names that would be obeyed if they were markup anywhere.
const std::string evil_patch = "</script><script>throw'patch'</script>\"&amp;";
const std::string evil_file = "<img src=x onerror=throw'file'>\"&.step";

class Sphere : public tests::SphereFolder {
 public:
  Sphere() : SphereFolder(evil_file, evil_patch) {}
  ProgramRun report_of(const char* command, Strings rest) const {
    rest.insert(rest.end(), {"--report", "report.html"});
    return run(command, rest);
  }
};

/// What a browser made of a page.
struct Visit {
  std::string probe;    ///< what `probe` gave, as JSON
  std::string console;  ///< every line that the page wrote there, errors included
  PngImage picture;
};

/// Opens a copy of the page, to which a script is added that calls `probe`, an expression, after two seconds.
Visit visit(const WorkFolder& folder, const std::string& hash, const std::string& probe) {
  std::string page = folder.text_of("report.html");
  const std::size_t end = page.rfind("</body>");
  REQUIRE(end != std::string::npos);
  page.insert(end, "<script>setTimeout(() => document.body.setAttribute('data-probe', JSON.stringify(" +
                       probe + ")), 2000)</script>\n");
  folder.put("probed.html", page);
  const std::string chromium =
      "cd '" + folder.path().string() +
      "' && HOME=. timeout 100 chromium --headless --no-sandbox --user-data-dir=profile --use-gl=angle "
      "--use-angle=swiftshader --enable-unsafe-swiftshader --window-size=1200,800 --virtual-time-budget=4000 "
      "--force-prefers-reduced-motion --enable-logging=stderr ";
  const std::string url = "'file://" + (folder.path() / "probed.html").string() + "#" + hash + "'";
  const std::string dom = tests::run(chromium + "--dump-dom " + url).output;
  const std::string log = tests::run(chromium + "--screenshot=shot.png " + url).output;
  Visit result{.probe = "", .console = "", .picture = tests::read_png(folder.path() / "shot.png")};
  std::istringstream lines(dom + "\n" + log);
  for (std::string line; std::getline(lines, line);) {
    if (line.find(":CONSOLE") != std::string::npos) result.console += line + "\n";
  }
  std::smatch found;
  if (std::regex_search(dom, found, std::regex("data-probe=\"([^\"]*)\""))) {
    result.probe = found[1].str();
    for (const auto& [code, letter] :
         {std::pair{"&quot;", "\""}, {"&lt;", "<"}, {"&gt;", ">"}, {"&amp;", "&"}}) {
      result.probe = std::regex_replace(result.probe, std::regex(code), letter);
    }
  }
  return result;
}

bool have_browser() {
  return tests::have_program("chromium");
}

}  // namespace

TEST_CASE("colours: ends, middle and beyond of a scale; names of their own") {
  const auto same = [](const Rgb& a, const Rgb& b) { return a.r == b.r && a.g == b.g && a.b == b.b; };
  const VerdictScale scale = deviation_scale(1e-4);
  CHECK(same(verdict_color(scale, 1e-4), verdict_stops.front()));
  CHECK(same(verdict_color(scale, 1e-8), verdict_stops.back()));
  CHECK(same(verdict_color(scale, 0), verdict_stops.back()));
  CHECK(verdict_color(scale, 1e-6).g == Approx(verdict_stops[3].g));
  CHECK(same(verdict_color(scale, 1.01e-4), failure_color));
  CHECK(same(verdict_color(jacobian_scale, 1), verdict_stops.back()));
  CHECK(same(verdict_color(jacobian_scale, 0), failure_color));
  CHECK(same(verdict_color(jacobian_scale, -0.5), failure_color));
  CHECK(verdict_color(jacobian_scale, 1.0 / 12).r == Approx((verdict_stops[0].r + verdict_stops[1].r) / 2));
  for (std::size_t a = 0; a < 40; ++a) {
    for (std::size_t b = 0; b < a; ++b) CHECK_FALSE(same(palette_color(a), palette_color(b)));
  }
}

TEST_CASE("mesh --report: the same bytes on any number of threads, no markup from names, also on exit 4") {
  const Sphere folder;
  std::string page;
  for (const char* threads : {"1", "3"}) {
    const ProgramRun run = folder.report_of(
        "mesh", {"--levels", "2", "--tolerance", "1e-3", "--threads", threads, "-o", "m.vtu"});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    if (!page.empty()) CHECK(page == folder.text_of("report.html"));
    page = folder.text_of("report.html");
  }
  // three.js is in it; every script element is one of ours; nothing names another file.
  CHECK_THAT(page, contains_text("WebGLRenderer"));
  CHECK(page.find("throw'") != std::string::npos);
  CHECK(page.find("<script>throw") == std::string::npos);
  CHECK(page.find("<img") == std::string::npos);
  CHECK(page.find("<link") == std::string::npos);
  std::size_t scripts = 0;
  for (std::size_t at = 0; (at = page.find("<script", at)) != std::string::npos; ++at) ++scripts;
  CHECK(scripts == 6);  // the data, three.js, its controls, scene, viewer, tables
  CHECK_THAT(page, contains_text("default-src 'none'"));
  // A missed gate: nothing at OUT, but the page that shows where.
  const ProgramRun missed =
      folder.report_of("mesh", {"--levels", "1", "--tolerance", "1e-9", "-o", "none.vtu"});
  CHECK(missed.exit_code == 4);
  CHECK_THAT(folder.text_of("report.html"), contains_text("\"holds\":false"));
  CHECK(folder.entries() == Strings{evil_file, "cage.obj", "m.vtu", "report.html"});
  // A place that cannot be written is refused before the work.
  CHECK(run_flowcage({"mesh", evil_file, "--cage", "cage.obj", "--levels", "2", "-o", "n.vtu", "--report",
                      "none/report.html"},
                     {.folder = folder.path()})
            .exit_code == 5);
}

TEST_CASE("mesh --report in a browser: no error, no loading, names are text, clicks fly, the plane cuts") {
  if (!have_browser()) return;
  const Sphere folder;
  // Warnings must be clickable: at the far tolerance a gate is missed somewhere.
  const ProgramRun run = folder.report_of("mesh", {"--levels", "2", "--tolerance", "1e-9", "-o", "m.vtu"});
  INFO(run.err);
  REQUIRE(run.exit_code == 4);
  const Visit seen = visit(folder, "colour=quality&cut=x:0.01", R"JS((() => {
    const text = (selector) => [...document.querySelectorAll(selector)].map((e) => e.textContent);
    const cut = viewer.cutGroup.children[0].geometry.attributes.position.count;
    viewer.setWholeCells(true);
    const whole = viewer.cutGroup.children[0].geometry.attributes.position.count;
    document.querySelectorAll('button.show')[0].click();
    return {
      loaded: performance.getEntriesByType('resource').length,
      scripts: document.querySelectorAll('#panel script, #panel img').length,
      title: text('h1'), verdict: text('#verdict'), patches: text('#panel label').map((t) => t.trim()),
      bars: document.querySelectorAll('svg.histogram').length, marker: viewer.marker.visible,
      radius: Math.hypot(...viewer.marker.position.toArray()).toFixed(2), cut, whole,
    };
  })())JS");
  INFO(seen.probe);
  CHECK(seen.console.empty());
  CHECK_THAT(seen.probe, contains_text("\"loaded\":0,\"scripts\":0"));
  CHECK_THAT(seen.probe, contains_text(R"("<img src=x onerror=throw'file'>\"&.step")"));
  CHECK_THAT(seen.probe, contains_text(R"("</script><script>throw'patch'</script>\"&amp;","plain")"));
  CHECK_THAT(seen.probe, contains_text("gates missed"));
  CHECK_THAT(seen.probe, contains_text("\"bars\":4,\"marker\":true,\"radius\":\"0.50\""));
  // Beside the middle the plane cuts a ring of cells: of four of the six sides a row of 4, in 20 layers,
  // quads all of them. Whole, 320 cells show their faces along the plane, the ring its 2 x 16 in- and
  // outside, and the four blocks 2 x 20 each where they meet.
  CHECK_THAT(seen.probe, contains_text("\"cut\":1920,\"whole\":4992"));
  CHECK(seen.picture.width == 1200);
  CHECK(seen.picture.colors() > 500);
}

TEST_CASE("surface --report in a browser") {
  if (!have_browser()) return;
  const Sphere folder;
  const ProgramRun run = folder.report_of("surface", {"--levels", "2", "--unit", "mm", "-o", "s.obj"});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Visit seen = visit(folder, "", R"JS({
    colours: [...document.querySelectorAll('#colour option')].map((o) => o.value),
    faces: viewer.surfaces.mesh.name.length, cut: document.getElementById('cut-axis').offsetParent === null,
    shown: [...document.querySelectorAll('#panel li')].map((e) => e.textContent).filter((t) => /all 96 faces/.test(t)).length,
  })JS");
  INFO(seen.probe);
  CHECK(seen.console.empty());
  CHECK(seen.probe == R"({"colours":["deviation","patch"],"faces":96,"cut":true,"shown":1})");
  CHECK(seen.picture.colors() > 500);
}

TEST_CASE("inspect --report in a browser: names stay text, borders are marked, clicks fly there") {
  const WorkFolder folder;
  write_tagged({{.shape = make_onera_m6(), .tag = {.name = evil_patch}},
                // beside the wing: y = 0 is a symmetry plane only where nothing is beyond it
                {.shape = make_box({0.1, 0.1, 0.1}), .tag = {.name = "a & \"b\""}, .places = {{0, 0.5, 1}}}},
               (folder.path() / "wing.step").string());
  const ProgramRun run =
      run_flowcage({"inspect", "wing.step", "--report", "report.html"}, {.folder = folder.path()});
  REQUIRE(run.exit_code == 0);
  CHECK(run_flowcage({"inspect", "wing.step", "--report", "none/x.html"}, {.folder = folder.path()})
            .exit_code == 5);
  CHECK(folder.text_of("report.html").find("<script>throw") == std::string::npos);
  if (!have_browser()) return;
  const Visit seen = visit(folder, "show=0", R"JS({
    scripts: document.querySelectorAll('#panel script').length,
    names: [...document.querySelectorAll('#panel label')].map((e) => e.textContent.trim()),
    marks: scene.marks.map((m) => [m.text.replace(/^[^:]*: /, ''), m.lines.length]),
    flown: viewer.marker.visible && scene.marks[0].place.every((x, a) =>
      Math.abs(x - scene.origin[a] - viewer.controls.target.getComponent(a)) < 1e-6),
    facts: document.querySelector('pre').textContent === facts.table,
  })JS");
  INFO(seen.probe);
  CHECK(seen.console.empty());
  CHECK_THAT(
      seen.probe,
      contains_text(R"("scripts":0,"names":["a & \"b\"","</script><script>throw'patch'</script>\"&amp;"])"));
  // The root is one chain, from the trailing edge around the smooth leading edge.
  CHECK_THAT(seen.probe, contains_text(R"("marks":[["symmetry plane, waterline or open end in y = 0",1]])"));
  CHECK_THAT(seen.probe, contains_text(R"("flown":true,"facts":true)"));
  CHECK(seen.picture.colors() > 500);
}
