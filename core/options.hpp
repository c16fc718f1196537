#pragma once
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// A coordinate plane: axis 0, 1, 2 for x, y, z.
struct PlaneOption {
  int axis = 0;
  double value = 0;  ///< in output units
};

/// Everything that a user can set, for all commands. An empty string or optional: not given.
/// The option table below names, limits and explains each; values that were set through it hold its limits.
struct Options {
  std::vector<std::string> inputs;   ///< CAD files, or the cage, or the mesh
  std::vector<std::string> outputs;  ///< -o

  std::string cage = "auto";
  std::string outer;
  std::string farfield = "box";
  double farfield_size = 20;
  std::string blocks = "auto";
  std::optional<double> cage_size;
  std::string flow = "external";
  std::optional<PlaneOption> symmetry;

  std::optional<int> levels;
  double tolerance = 1e-4;
  std::optional<Offset> cells;
  int family = 1;
  double crease_angle = 20;
  bool unite = true;
  bool snap = true;
  int sample = 0;
  bool unstructured = false;
  bool limit = false;

  std::optional<double> first_height, growth, yplus, reynolds, length;
  std::optional<int> layers;

  std::vector<std::string> include, exclude, inlet, outlet;  ///< patterns of faces

  std::string unit = "m";
  std::string cad_unit, cage_unit;

  bool flow_case = false;
  double speed = 1;
  std::array<double, 3> direction{1, 0, 0};
  std::optional<double> viscosity;
  int order = 1;

  std::string out_dir, format = "vtu";
  int jobs = 1;

  std::string config, save_config, json, report, pictures;
  int threads = 0;
  Offset seed = 0;
  bool quiet = false, force = false;
};

/// The commands as bits, for OptionSpec::commands.
enum class Command : unsigned {
  mesh = 1,
  surface = 2,
  cage = 4,
  subdivide = 8,
  inspect = 16,
  quality = 32,
  convert = 64,
  completion = 128,
  man = 256
};

/// One row of the table: the command line, the help, the JSON and docs/options.md come from it.
struct OptionSpec {
  std::string name;        ///< "first-height": --first-height, JSON first_height
  std::string group;       ///< heading in the help
  std::string value_name;  ///< "N", "FILE", "box|sphere"; empty for a flag
  std::string unit;        ///< of the value; empty if it has none
  std::string help;
  std::string default_text;  ///< where the default is no single value: what happens without the option
  std::string range;         ///< "0 < T <= 1"; empty without limits
  unsigned commands = 0;     ///< bits of Command
  bool negatable = false;    ///< a flag with a --no- form
  bool repeatable = false;   ///< each use adds a value
  bool numeric = false;      ///< the value is a number

  /// Sets the value from text ("true" and "false" for flags); throws Error(usage) that names option, value
  /// and range.
  std::function<void(Options&, const std::string&)> set;
  /// The value as text; empty if not given.
  std::function<std::string(const Options&)> show;
  /// Of a repeatable option: its values in the order given.
  std::function<std::vector<std::string>(const Options&)> values;

  bool is_flag() const { return value_name.empty(); }
  bool belongs_to(Command command) const { return (commands & static_cast<unsigned>(command)) != 0; }
};

/// Every option with a long name, in the order of the help.
const std::vector<OptionSpec>& option_table();

/// Metres in one m, mm, in or ft. Throws Error(usage) for other names.
double metres_per_unit(std::string_view unit);

/// The table as a Markdown document: docs/options.md.
std::string options_markdown();

}  // namespace flowcage
