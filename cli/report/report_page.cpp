#include "cli/report/report_page.hpp"

#include <bit>
#include <cstdint>
#include <string_view>

#include "cli/report/embedded_files.hpp"

namespace flowcage {
namespace {

std::string base64(std::span<const std::uint8_t> bytes) {
  static constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t b = 0; b < 3; ++b) word = word << 8 | (b < n ? bytes[i + b] : 0U);
    for (std::size_t d = 0; d < 4; ++d) text += d <= n ? digits[word >> (18 - 6 * d) & 63U] : '=';
  }
  return text;
}

/// Numbers of four bytes, the least significant first, as a browser's typed arrays have them.
template <typename T>
std::string packed(std::span<const T> values) {
  static_assert(sizeof(T) == 4);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * values.size());
  for (const T value : values) {
    const auto word = std::bit_cast<std::uint32_t>(value);
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(word >> shift));
  }
  return base64(bytes);
}

/// As the page has it: about the middle of the body, so that single precision is enough.
std::string packed_points(std::span<const Vec3> points, const Vec3& origin) {
  std::vector<float> values;
  values.reserve(3 * points.size());
  for (const Vec3& p : points) {
    for (int a = 0; a < 3; ++a) values.push_back(static_cast<float>(p[a] - origin[a]));
  }
  return packed<float>(values);
}

Json color_json(const Rgb& c) {
  return Json::array({c.r, c.g, c.b});
}

Json scale_json(const VerdictScale& scale) {
  return {{"bad", scale.bad}, {"good", scale.good}, {"logarithmic", scale.logarithmic}};
}

Json surface_json(const SceneSurface& surface, const Vec3& origin) {
  Json names = Json::array();
  for (const SceneName& n : surface.names) {
    names.push_back({{"name", n.name}, {"type", n.type}, {"color", color_json(n.color)}});
  }
  std::vector<Index> corners;
  for (const auto& face : surface.faces) corners.insert(corners.end(), face.begin(), face.end());
  return {{"names", names},
          {"points", packed_points(surface.points, origin)},
          {"faces", packed<Index>(corners)},
          {"name", packed<Index>(surface.name)},
          {"region", packed<Index>(surface.region)},
          {"block", packed<Index>(surface.block)},
          {"quality", packed<float>(surface.quality)},
          {"deviation", packed<float>(surface.deviation)}};
}

Json marks_json(const Scene& scene, const Vec3& origin) {
  Json marks = Json::array();
  for (const SceneMark& mark : scene.marks) {
    Json lines = Json::array();
    for (const auto& line : mark.lines) lines.push_back(packed_points(line, origin));
    marks.push_back({{"text", mark.text},
                     {"place", json_of(mark.place)},
                     {"color", color_json(mark.color)},
                     {"lines", lines}});
  }
  return marks;
}

Json scene_json(const Scene& scene) {
  const Vec3 origin = scene.body.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(scene.body.center());
  Json edges = Json::array(), worst = Json::array();
  for (const auto& line : scene.edges) edges.push_back(packed_points(line, origin));
  for (const SceneCell& cell : scene.worst) {
    worst.push_back({{"metric", cell.metric}, {"corners", packed_points(cell.corners, origin)}});
  }
  Json colors{{"stops", Json::array()},
              {"failure", color_json(failure_color)},
              {"neutral", color_json(neutral_color)},
              {"quality", scale_json(jacobian_scale)}};
  for (const Rgb& stop : verdict_stops) colors["stops"].push_back(color_json(stop));
  if (scene.tolerance > 0) colors["deviation"] = scale_json(deviation_scale(scene.tolerance));
  constexpr std::size_t block_colors = 24;
  for (std::size_t b = 0; b < block_colors; ++b) colors["blocks"].push_back(color_json(palette_color(b)));
  Json json{{"origin", json_of(origin)},
            {"diagonal", scene.diagonal},
            {"body", {json_of(scene.body.min()), json_of(scene.body.max())}},
            {"colors", colors},
            {"cad", surface_json(scene.cad, origin)},
            {"edges", edges},
            {"worst", worst},
            {"marks", marks_json(scene, origin)},
            {"shown", scene.shown}};
  if (!scene.mesh.faces.empty()) json["mesh"] = surface_json(scene.mesh, origin);
  if (!scene.deviation.counts.empty()) {
    json["deviation"] = {
        {"low", scene.deviation.low}, {"high", scene.deviation.high}, {"counts", scene.deviation.counts}};
  }
  if (!scene.volume.dims.empty()) {
    std::vector<Index> dims;
    for (const auto& d : scene.volume.dims) dims.insert(dims.end(), d.begin(), d.end());
    json["volume"] = {{"points", packed_points(scene.volume.points, origin)},
                      {"dims", packed<Index>(dims)},
                      {"numbers", packed<Index>(scene.volume.numbers)},
                      {"quality", packed<float>(scene.volume.quality)}};
  }
  return json;
}

Json without_times(Json facts) {
  facts.erase("seconds");
  facts.erase("peak_memory_bytes");
  if (facts.contains("surface")) {
    for (Json& level : facts["surface"]["levels"]) level.erase("seconds");
  }
  return facts;
}

/// JSON inside of a script element: no markup can begin or end in it. Beyond ASCII all is escaped, U+2028
/// included.
std::string json_for_script(const Json& json) {
  std::string out;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace)) {
    switch (c) {  // these occur within strings only
      case '<':
        out += "\\u003c";
        break;
      case '>':
        out += "\\u003e";
        break;
      case '&':
        out += "\\u0026";
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace

void write_report_page(std::ostream& out, const ReportText& text, const Scene& scene) {
  const EmbeddedFiles files = embedded_files();
  const Json data{
      {"command", text.command},   {"title", text.options.inputs.front()}, {"unit", text.options.unit},
      {"warnings", text.warnings}, {"facts", without_times(text.facts)},   {"scene", scene_json(scene)}};
  // report.html says in which order: "{{name}}" stands for a part.
  std::string_view rest = files.page;
  for (std::size_t at = rest.find("{{"); at != std::string_view::npos; at = rest.find("{{")) {
    const std::size_t end = rest.find("}}", at);
    const std::string_view name = rest.substr(at + 2, end - at - 2);
    out << rest.substr(0, at);
    if (name == "style") out << files.style;
    if (name == "three") out << files.three;
    if (name == "orbit controls") out << files.orbit_controls;
    if (name == "data") out << json_for_script(data);
    if (name == "scene") out << files.scene;
    if (name == "viewer") out << files.viewer;
    if (name == "tables") out << files.tables;
    rest.remove_prefix(end + 2);
  }
  out << rest;
}

}  // namespace flowcage
