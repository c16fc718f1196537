#include "core/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>

#include "core/base/error.hpp"

namespace flowcage {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

constexpr unsigned mesh = static_cast<unsigned>(Command::mesh);
constexpr unsigned surface = static_cast<unsigned>(Command::surface);
constexpr unsigned subdivide = static_cast<unsigned>(Command::subdivide);
constexpr unsigned inspect = static_cast<unsigned>(Command::inspect);
constexpr unsigned quality = static_cast<unsigned>(Command::quality);
constexpr unsigned cage = static_cast<unsigned>(Command::cage);
constexpr unsigned convert = static_cast<unsigned>(Command::convert);
constexpr unsigned every_command = mesh | surface | cage | subdivide | inspect | quality | convert;

/// Limits of a number; `open`: the lower one is not allowed itself.
struct Range {
  double low = -infinite, high = infinite;
  bool open = false;

  bool holds(double x) const { return (open ? x > low : x >= low) && x <= high; }
  std::string text(const std::string& symbol) const {
    std::string out = symbol;
    if (low != -infinite) out = fmt::format("{:g} {} ", low, open ? "<" : "<=") + out;
    if (high != infinite) out += fmt::format(" <= {:g}", high);
    return out == symbol ? std::string() : out;
  }
};

[[noreturn]] void refuse(const OptionSpec& row, const std::string& text, const std::string& why) {
  throw Error(ErrorKind::usage, fmt::format("--{}: \"{}\" {}", row.name, text, why),
              row.range.empty() ? fmt::format("give --{} {}", row.name, row.value_name)
                                : fmt::format("give --{} {} with {}", row.name, row.value_name, row.range));
}

template <typename Number>
Number parse_number(const OptionSpec& row, const std::string& text, const Range& range) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);
  if (code == std::errc::result_out_of_range) refuse(row, text, "is out of range");
  if (code != std::errc() || stop != end || !std::isfinite(static_cast<double>(value))) {
    refuse(row, text, std::is_integral_v<Number> ? "is no whole number" : "is no number");
  }
  if (!range.holds(static_cast<double>(value))) refuse(row, text, "is out of range");
  return value;
}

template <typename T>
struct Unwrapped {
  using type = T;
};
template <typename T>
struct Unwrapped<std::optional<T>> {
  using type = T;
};

template <typename Field>
std::string shown_number(const Field& field) {
  if constexpr (std::is_arithmetic_v<Field>) {
    return fmt::format("{}", field);
  } else {
    return field ? fmt::format("{}", *field) : std::string();
  }
}

/// Rows are built by kind; `row` has its texts already.
template <typename Field>
OptionSpec number(OptionSpec row, Field Options::*field, const Range& range) {
  row.range = range.text(row.value_name);
  row.numeric = true;
  row.set = [row, field, range](Options& options, const std::string& text) {
    options.*field = parse_number<typename Unwrapped<Field>::type>(row, text, range);
  };
  row.show = [field](const Options& options) { return shown_number(options.*field); };
  return row;
}

OptionSpec flag(OptionSpec row, bool Options::*field) {
  row.set = [row, field](Options& options, const std::string& text) {
    if (text != "true" && text != "false") refuse(row, text, "is neither true nor false");
    options.*field = text == "true";
  };
  row.show = [field](const Options& options) { return options.*field ? "true" : "false"; };
  return row;
}

OptionSpec text(OptionSpec row, std::string Options::*field) {
  row.set = [row, field](Options& options, const std::string& value) {
    if (value.empty()) refuse(row, value, "is empty");
    options.*field = value;
  };
  row.show = [field](const Options& options) { return options.*field; };
  return row;
}

/// Each use adds one.
OptionSpec texts(OptionSpec row, std::vector<std::string> Options::*field) {
  row.repeatable = true;
  row.set = [row, field](Options& options, const std::string& value) {
    if (value.empty()) refuse(row, value, "is empty");
    (options.*field).push_back(value);
  };
  row.show = [field](const Options& options) { return fmt::format("{}", fmt::join(options.*field, ", ")); };
  row.values = [field](const Options& options) { return options.*field; };
  return row;
}

/// One of the words of value_name, "a|b|c".
OptionSpec choice(OptionSpec row, std::string Options::*field) {
  row.set = [row, field](Options& options, const std::string& value) {
    const std::string padded = "|" + row.value_name + "|";
    if (value.empty() || value.find('|') != std::string::npos ||
        padded.find("|" + value + "|") == std::string::npos) {
      refuse(row, value, "is no such choice");
    }
    options.*field = value;
  };
  row.show = [field](const Options& options) { return options.*field; };
  return row;
}

OptionSpec plane(OptionSpec row, std::optional<PlaneOption> Options::*field) {
  row.set = [row, field](Options& options, const std::string& value) {
    if (value.empty() || value[0] < 'x' || value[0] > 'z' || (value.size() > 1 && value[1] != '=')) {
      refuse(row, value, "names no coordinate plane");
    }
    PlaneOption p{value[0] - 'x', 0};
    if (value.size() > 1) p.value = parse_number<double>(row, value.substr(2), {});
    options.*field = p;
  };
  row.show = [field](const Options& options) {
    const auto& p = options.*field;
    return p ? fmt::format("{}={}", "xyz"[p->axis], p -> value) : std::string();
  };
  return row;
}

/// Three numbers, not all zero: "X,Y,Z".
OptionSpec direction(OptionSpec row, std::array<double, 3> Options::*field) {
  row.set = [row, field](Options& options, const std::string& value) {
    std::array<double, 3> parsed{};
    std::size_t begin = 0;
    for (int d = 0; d < 3; ++d) {
      const std::size_t end = d < 2 ? value.find(',', begin) : value.size();
      if (end == std::string::npos) refuse(row, value, "is no three numbers");
      parsed[d] = parse_number<double>(row, value.substr(begin, end - begin), {});
      begin = end + 1;
    }
    if (std::hypot(parsed[0], parsed[1], parsed[2]) == 0) refuse(row, value, "has no direction");
    options.*field = parsed;
  };
  row.show = [field](const Options& options) { return fmt::format("{}", fmt::join(options.*field, ",")); };
  return row;
}

OptionSpec row(std::string name, std::string value_name, unsigned commands, std::string help) {
  OptionSpec r;
  r.name = std::move(name);
  r.value_name = std::move(value_name);
  r.commands = commands;
  r.help = std::move(help);
  return r;
}

OptionSpec without(OptionSpec r, std::string default_text) {
  r.default_text = std::move(default_text);
  return r;
}
OptionSpec in_unit(OptionSpec r, std::string unit) {
  r.unit = std::move(unit);
  return r;
}
OptionSpec negatable(OptionSpec r) {
  r.negatable = true;
  return r;
}

std::vector<OptionSpec> make_table() {
  std::vector<OptionSpec> table;
  const auto group = [&table](const char* heading, std::vector<OptionSpec> rows) {
    for (OptionSpec& r : rows) {
      r.group = heading;
      table.push_back(std::move(r));
    }
  };
  const unsigned fitting = mesh | surface;

  group(
      "Cage and blocks",
      {text(without(row("cage", "FILE", fitting,
                        "inner polyhedron (OBJ, see docs/cages.md), or blocks: a coarse hex mesh file"),
                    "mesh: blocks are made without one; surface: required"),
            &Options::cage),
       text(without(row("outer", "FILE", mesh,
                        "outer polyhedron (OBJ), of the inner one's topology in any numbering"),
                    "--farfield"),
            &Options::outer),
       choice(
           row("farfield", "box|sphere|bullet", mesh,
               "outer boundary where there is no --outer; bullet: half a sphere toward -x, then a cylinder"),
           &Options::farfield),
       number(in_unit(row("farfield-size", "X", mesh | cage, "distance of the far field"), "body lengths"),
              &Options::farfield_size, {1, 1e6, true}),
       choice(row("blocks", "auto|shell|swept|ambient", mesh,
                  "where the blocks come from; shell: between inner and outer surface; swept: C-H blocks of "
                  "wings and blades; ambient: a grid that follows any CAD"),
              &Options::blocks),
       number(in_unit(without(row("cage-size", "X", mesh | cage, "edge length of the cage's quads"),
                              "from the CAD's size"),
                      "output units"),
              &Options::cage_size, {0, infinite, true}),
       choice(row("flow", "external|internal", mesh | cage, "the fluid is outside or inside of the CAD"),
              &Options::flow),
       plane(in_unit(without(row("symmetry", "x|y|z[=VALUE]", mesh,
                                 "half model cut by that plane; the cage is open there"),
                             "off"),
                     "output units"),
             &Options::symmetry)});
  group("Fit",
        {number(without(row("levels", "N", fitting | subdivide, "subdivision levels"),
                        "chosen to meet the tolerance; subdivide: required"),
                &Options::levels, {0, 10}),
         number(in_unit(row("tolerance", "T", fitting,
                            "largest distance of the fitted surface from the CAD: a gate"),
                        "bounding-box diagonals of the CAD"),
                &Options::tolerance, {0, 1, true}),
         number(without(row("cells", "N", mesh, "stop refining at the level nearest to N cells"), "none"),
                &Options::cells, {1, 2e9}),
         number(row("family", "N", mesh,
                    "nested meshes of one fit: the finest as asked, each coarser one has every second point; "
                    "written as NAME_1 (coarsest) to NAME_N"),
                &Options::family, {1, 10}),
         number(in_unit(row("crease-angle", "DEG", fitting | cage | inspect,
                            "CAD edges sharper than this are features"),
                        "degrees"),
                &Options::crease_angle, {0, 180, true}),
         flag(negatable(row("unite", "", fitting | inspect,
                            "CAD bodies that overlap or touch become one: their outer skin")),
              &Options::unite),
         flag(negatable(row("snap", "", fitting, "put the final wall vertices exactly on the CAD")),
              &Options::snap),
         number(row("sample", "N", surface,
                    "write the fitted limit surface itself: each face of the last level split N more times, "
                    "no snap"),
                &Options::sample, {0, 8}),
         flag(row("unstructured", "", mesh | convert, "CGNS with one unstructured zone instead of blocks"),
              &Options::unstructured),
         number(row("order", "N", mesh,
                    "order of the cells: 2 to 4 are curved hexes with their wall nodes on the CAD, in .vtu, "
                    ".msh and .cgns"),
                &Options::order, {1, 4}),
         flag(row("limit", "", subdivide,
                  "write the limit points of the vertices instead of the control points"),
              &Options::limit)});
  group("Wall spacing",
        {number(in_unit(without(row("first-height", "H", mesh, "height of the first cell off the wall"),
                                "the size of the wall's cells"),
                        "output units"),
                &Options::first_height, {0, infinite, true}),
         number(without(row("growth", "R", mesh,
                            "ratio of neighbouring heights in the layers, after two equal cells"),
                        "1.2"),
                &Options::growth, {1, 10}),
         number(
             without(row("layers", "N", mesh, "layers of that growth; behind them the rest is filled evenly"),
                     "growth follows from the distance"),
             &Options::layers, {1, 1000}),
         number(without(
                    row("yplus", "Y", mesh,
                        "y+ of the first points off the wall: with --reynolds and --length the first height"),
                    "off"),
                &Options::yplus, {0, 1e6, true}),
         number(without(row("reynolds", "RE", mesh, "Reynolds number of --length"), "off"),
                &Options::reynolds, {0, 1e12, true}),
         number(in_unit(without(row("length", "L", mesh, "reference length, the chord say"), "off"),
                        "output units"),
                &Options::length, {0, infinite, true})});
  group(
      "Flow case",
      {flag(row("case", "", mesh,
                "beside an OpenFOAM polyMesh: all that potentialFoam and simpleFoam need to start; replaces "
                "an older case's files"),
            &Options::flow_case),
       number(in_unit(row("speed", "V", mesh, "of the free stream, or at the inlets"), "m/s"),
              &Options::speed, {0, infinite, true}),
       direction(
           row("direction", "X,Y,Z", mesh, "of the free stream; internal flow enters normal to its inlets"),
           &Options::direction),
       number(in_unit(without(row("viscosity", "NU", mesh, "kinematic viscosity"),
                              "from --reynolds and --length, else 1.5e-05 (air)"),
                      "m2/s"),
              &Options::viscosity, {0, infinite, true})});
  group("Many files",
        {text(without(row("out-dir", "DIR", mesh,
                          "mesh each CAD file by itself into this folder; one line of JSON a file on stdout; "
                          "files that are done and unchanged are skipped"),
                      "off"),
              &Options::out_dir),
         text(row("format", "EXT", mesh, "with --out-dir: ending of the outputs; foam: a case folder each"),
              &Options::format),
         number(row("jobs", "N", mesh, "with --out-dir: so many files at once"), &Options::jobs, {1, 1024})});
  group(
      "Faces of the CAD",
      {texts(without(row("include", "PATTERN", fitting | cage | inspect,
                         "take only the faces that match: a wildcard for name, layer or colour, or face:1-4 "
                         "(docs/cad.md); may be repeated"),
                     "all"),
             &Options::include),
       texts(without(row("exclude", "PATTERN", fitting | cage | inspect,
                         "leave out the faces that match; may be repeated"),
                     "none"),
             &Options::exclude),
       texts(
           without(row("inlet", "PATTERN", mesh | cage | inspect,
                       "the faces that match are an inlet, each use one of its own; their borders are kept"),
                   "faces named inlet or inflow"),
           &Options::inlet),
       texts(without(row("outlet", "PATTERN", mesh | cage | inspect, "the same for outlets"),
                     "faces named outlet or outflow"),
             &Options::outlet)});
  group("Units",
        {choice(row("unit", "m|mm|in|ft", fitting | cage, "unit of the output"), &Options::unit),
         choice(without(row("cad-unit", "m|mm|in|ft", fitting | cage | inspect,
                            "overrules the unit that the CAD file states"),
                        "the file's"),
                &Options::cad_unit),
         choice(without(row("cage-unit", "m|mm|in|ft", fitting | cage, "unit of the cage and outer files"),
                        "the CAD's"),
                &Options::cage_unit)});
  group(
      "General",
      {text(without(row("config", "FILE.toml", every_command,
                        "options by their long names; the command line wins"),
                    "none"),
            &Options::config),
       text(without(row("save-config", "FILE.toml", every_command,
                        "write the options in force, to be read with --config"),
                    "none"),
            &Options::save_config),
       number(without(row("threads", "N", every_command, "threads; the result does not depend on it"),
                      "all cores"),
              &Options::threads, {0, 1024}),
       number(row("seed", "N", fitting, "start of every random choice (this version makes none)"),
              &Options::seed, {0, infinite}),
       flag(row("quiet", "", every_command, "errors only: no progress, no warnings"), &Options::quiet),
       text(without(
                row("json", "FILE", fitting | cage | inspect | quality, "the numbers of the result as JSON"),
                "none"),
            &Options::json),
       text(without(row("report", "FILE.html", fitting | inspect,
                        "a page with the result in 3-D, its figures and its problems marked"),
                    "none"),
            &Options::report),
       text(without(row("pictures", "DIR", fitting, "the pictures of the report as PNG files in this folder"),
                    "none"),
            &Options::pictures),
       flag(row("force", "", fitting | cage, "write a mesh that misses its gates (the exit code stays 4)"),
            &Options::force)});
  return table;
}

std::string command_names(unsigned commands) {
  static constexpr std::array names{
      std::pair{Command::mesh, "mesh"},       std::pair{Command::surface, "surface"},
      std::pair{Command::cage, "cage"},       std::pair{Command::subdivide, "subdivide"},
      std::pair{Command::inspect, "inspect"}, std::pair{Command::quality, "quality"},
      std::pair{Command::convert, "convert"}};
  std::string out;
  for (const auto& [command, name] : names) {
    if ((commands & static_cast<unsigned>(command)) != 0)
      out += (out.empty() ? "" : ", ") + std::string(name);
  }
  return out;
}

/// '|' would end a table's cell.
std::string escaped(std::string text) {
  for (std::size_t i = text.find('|'); i != std::string::npos; i = text.find('|', i + 2))
    text.insert(i, 1, '\\');
  return text;
}

}  // namespace

const std::vector<OptionSpec>& option_table() {
  static const std::vector<OptionSpec> table = make_table();
  return table;
}

double metres_per_unit(std::string_view unit) {
  static constexpr std::array units{
      std::pair<std::string_view, double>{"m", 1.0}, std::pair<std::string_view, double>{"mm", 1e-3},
      std::pair<std::string_view, double>{"in", 0.0254}, std::pair<std::string_view, double>{"ft", 0.3048}};
  for (const auto& [name, metres] : units) {
    if (name == unit) return metres;
  }
  throw Error(ErrorKind::usage, fmt::format("unknown unit \"{}\"", unit), "units are m, mm, in and ft");
}

std::string options_markdown() {
  std::string out =
      "# Options\n\nMade from the table in `core/options.cpp`; `flowcage COMMAND --help` shows the same.\n";
  auto append = std::back_inserter(out);
  std::string group;
  const Options defaults;
  for (const OptionSpec& r : option_table()) {
    if (r.group != group) {
      group = r.group;
      fmt::format_to(append,
                     "\n## {}\n\n| option | meaning | unit | range | default | commands |\n| --- | --- | --- "
                     "| --- | --- | --- |\n",
                     group);
    }
    const std::string name =
        "--" + r.name + (r.is_flag() ? "" : " " + r.value_name) + (r.negatable ? ", --no-" + r.name : "");
    const std::string value = r.is_flag() ? (r.show(defaults) == "true" ? "on" : "off") : r.show(defaults);
    fmt::format_to(append, "| `{}` | {} | {} | {} | {} | {} |\n", escaped(name), escaped(r.help), r.unit,
                   r.range, r.default_text.empty() ? value : r.default_text, command_names(r.commands));
  }
  return out;
}

}  // namespace flowcage
