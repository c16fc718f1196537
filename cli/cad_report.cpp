#include "cli/cad_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <numeric>

#include "cli/cad_table.hpp"
#include "cli/report/color_map.hpp"

namespace flowcage {
namespace {

/// Markup in names is shown, not obeyed.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// Where a viewer stands, orthographic: right and up span the picture, `toward` points at the viewer.
struct View {
  std::string_view title;
  Vec3 right, up, toward;
};

std::array<View, 3> views() {
  const auto from = [](std::string_view title, const Vec3& eye) {
    const Vec3 toward = eye.normalized(), right = Vec3::UnitZ().cross(toward).normalized();
    return View{title, right, toward.cross(right), toward};
  };
  return {from("from the front, left and above", {-1, -1.4, 0.8}),
          from("from behind, right and below", {1, 1.4, -0.8}), from("from the left", {0, -1, 0})};
}

constexpr double picture_width = 900;
constexpr std::array<std::string_view, 4> border_colors{"#1f6fd0", "#e00000", "#e07b00", "#8a2be2"};

class Picture {
 public:
  Picture(const CadModel& model, const View& view, const std::vector<Rgb>& face_colors)
      : model_(model), view_(view), face_colors_(face_colors) {
    for (const Vec3& p : model.tessellation().points) box_.extend(flat(p));
    const double width = std::max(box_.sizes().x(), 1e-9 * model.diagonal());
    const double height = std::max(box_.sizes().y(), 1e-9 * model.diagonal());
    scale_ = std::min((picture_width - 40) / width, 600 / height);
    height_ = height * scale_ + 40;
  }

  std::string svg() const {
    std::string text = fmt::format(
        "<h3>{}</h3>\n<svg viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" "
        "xmlns=\"http://www.w3.org/2000/svg\">\n<g stroke-width=\"0.4\" stroke-linejoin=\"round\">\n",
        view_.title, picture_width, height_, picture_width, height_);
    append_triangles(text);
    text += "</g>\n<g fill=\"none\" stroke-width=\"2.5\" stroke-linejoin=\"round\">\n";
    append_borders(text);
    text += "</g>\n</svg>\n";
    return text;
  }

 private:
  Vec2 flat(const Vec3& p) const { return {view_.right.dot(p), view_.up.dot(p)}; }
  Vec2 pixel(const Vec3& p) const {
    const Vec2 q = flat(p);
    return {20 + (q.x() - box_.min().x()) * scale_, height_ - 20 - (q.y() - box_.min().y()) * scale_};
  }

  /// Far ones first.
  void append_triangles(std::string& text) const {
    const Tessellation& mesh = model_.tessellation();
    std::vector<double> depth;
    for (const auto& t : mesh.triangles) {
      depth.push_back(view_.toward.dot(mesh.points[t[0]] + mesh.points[t[1]] + mesh.points[t[2]]));
    }
    std::vector<std::size_t> order(depth.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](std::size_t t) { return depth[t]; });
    for (const std::size_t t : order) {
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3 normal =
          (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).stableNormalized();
      const double light = 0.45 + 0.55 * std::abs(normal.dot((view_.toward + 0.4 * view_.up).normalized()));
      const Rgb& color = face_colors_[mesh.triangle_face[t]];
      const auto byte = [&](double value) {
        return static_cast<int>(255 * std::clamp(light * value, 0.0, 1.0));
      };
      const std::string paint =
          fmt::format("#{:02x}{:02x}{:02x}", byte(color.r), byte(color.g), byte(color.b));
      const Vec2 p = pixel(mesh.points[a]), q = pixel(mesh.points[b]), r = pixel(mesh.points[c]);
      fmt::format_to(std::back_inserter(text),
                     "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" fill=\"{}\" stroke=\"{}\"/>\n",
                     p.x(), p.y(), q.x(), q.y(), r.x(), r.y(), paint, paint);
    }
  }

  void append_borders(std::string& text) const {
    const std::vector<OpenBorder>& borders = model_.summary().borders;
    for (std::size_t b = 0; b < borders.size(); ++b) {
      const std::string_view color = border_colors[static_cast<std::size_t>(borders[b].kind)];
      for (const Index chain : borders[b].chains) {
        std::string points;
        for (const Vec3& p : model_.features().chains[chain].polyline) {
          points += fmt::format("{:.1f},{:.1f} ", pixel(p).x(), pixel(p).y());
        }
        text += fmt::format("<polyline points=\"{}\" stroke=\"{}\"/>\n", points, color);
      }
      const Vec2 at = pixel(borders[b].place);
      text += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"{}\" stroke=\"none\">{}</text>\n", at.x(),
                          at.y(), color, b + 1);
    }
  }

  const CadModel& model_;
  const View& view_;
  const std::vector<Rgb>& face_colors_;
  Eigen::AlignedBox2d box_;
  double scale_ = 1, height_ = 1;
};

std::string legend(const CadModel& model, const std::map<std::string, std::size_t>& colors) {
  std::string text = "<p>";
  for (const auto& [name, index] : colors) {
    const Rgb color = palette_color(index);
    text +=
        fmt::format("<span class=\"key\"><b style=\"background:rgb({:.0f},{:.0f},{:.0f})\"></b>{}</span> ",
                    255 * color.r, 255 * color.g, 255 * color.b, name.empty() ? "(no name)" : escaped(name));
  }
  text += "</p>\n";
  const std::vector<OpenBorder>& borders = model.summary().borders;
  if (borders.empty()) return text + "<p>No open border.</p>\n";
  text += "<table><tr><th>border</th><th>what</th><th>length, m</th><th>near</th></tr>\n";
  for (std::size_t b = 0; b < borders.size(); ++b) {
    text += fmt::format("<tr><td style=\"color:{}\">{}</td><td>{}</td><td>{:.4g}</td><td>{}</td></tr>\n",
                        border_colors[static_cast<std::size_t>(borders[b].kind)], b + 1,
                        border_text(borders[b]), borders[b].length, place(borders[b].place));
  }
  return text + "</table>\n";
}

}  // namespace

void write_cad_report(std::ostream& out, const CadModel& model) {
  std::map<std::string, std::size_t> colors;
  std::vector<Rgb> face_colors;
  for (Index f = 0; f < model.face_count(); ++f) {
    const auto index = colors.emplace(model.face(f).group, colors.size()).first->second;
    face_colors.push_back(palette_color(index));
  }
  out << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>flowcage inspect: "
      << escaped(model.summary().files.front().name)
      << "</title>\n<style>body{font:15px "
         "sans-serif;margin:2em;max-width:60em}pre{background:#f4f4f4;padding:1em;"
         "overflow:auto}td,th{text-align:left;padding:.1em .8em}svg{border:1px solid #ccc}svg text{font:bold "
         "15px "
         "sans-serif}.key{margin-right:1em;white-space:nowrap}.key "
         "b{display:inline-block;width:1em;height:1em;"
         "margin-right:.3em;vertical-align:middle}</style></head><body>\n<h1>"
      << escaped(model.summary().files.front().name) << "</h1>\n";
  const std::vector<std::string>& problems = model.summary().warnings;
  out << fmt::format("<h2>Problems ({})</h2>\n<ul>\n", problems.size());
  for (const std::string& problem : problems) out << "<li>" << escaped(problem) << "</li>\n";
  out << "</ul>\n<h2>Pictures</h2>\n" << legend(model, colors);
  for (const View& view : views()) out << Picture(model, view, face_colors).svg();
  out << "<h2>Facts</h2>\n<pre>" << escaped(cad_table(model)) << "</pre>\n</body></html>\n";
}

}  // namespace flowcage
