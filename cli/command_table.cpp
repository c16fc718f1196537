#include "cli/command_table.hpp"

#include <fmt/format.h>

namespace flowcage {
namespace {

constexpr const char* mesh_inputs_help =
    "an OpenFOAM case folder or X.foam, X.vtu, X.vtm, X.cgns, X.msh or X.su2";
constexpr const char* mesh_outputs_help =
    "a folder or X.foam (OpenFOAM polyMesh), X.vtu, X.vtm, X.cgns, X.msh (Gmsh), X.su2 or X.xyz (Plot3D, "
    "with X.nmf); may be repeated";

}  // namespace

const std::vector<CommandSpec>& command_table() {
  static const std::vector<CommandSpec> table{
      {Command::mesh, "mesh", "CAD and a cage to an all-hex volume mesh", "CAD", "STEP or IGES files", "OUT",
       mesh_outputs_help, "flowcage mesh wing.step --cage wing_cage.obj --symmetry y --levels 3 -o case",
       true},
      {Command::surface, "surface", "the fitted surface of a CAD and a cage: a mesh, or B-spline patches",
       "CAD", "STEP or IGES files", "OUT", "X.obj, X.vtp, X.stl or X.step; may be repeated",
       "flowcage surface wing.step --cage wing_cage.obj --levels 3 -o wing.obj", true},
      {Command::subdivide, "subdivide", "Catmull-Clark subdivision of a cage, without CAD", "CAGE",
       "the cage (OBJ)", "OUT", "X.obj", "flowcage subdivide cage.obj --levels 2 --limit -o limit.obj"},
      {Command::inspect, "inspect", "what is in a CAD file: units, size, faces, edges, names, problems",
       "CAD", "STEP or IGES files", "", "", "flowcage inspect wing.step --json wing.json", true},
      {Command::quality, "quality", "the quality table of a hex mesh and its worst cells", "MESH",
       mesh_inputs_help, "", "", "flowcage quality case --json quality.json"},
      {Command::cage, "cage", "proposes a cage and blocks for a CAD, to edit and give back to mesh", "CAD",
       "STEP or IGES files", "OUT", "X.obj (the cage) or X.vtu (the blocks); may be repeated",
       "flowcage cage part.step -o cage.obj -o blocks.vtu", true},
      {Command::convert, "convert", "one mesh format to another", "MESH", mesh_inputs_help, "OUT",
       mesh_outputs_help, "flowcage convert mesh.msh -o case -o mesh.vtu"},
      {Command::completion, "completion", "a shell's completion of commands, options and values, on stdout",
       "SHELL", "bash, zsh or fish", "", "",
       "flowcage completion bash > ~/.local/share/bash-completion/completions/flowcage"},
      {Command::man, "man", "the manual page, on stdout", "", "", "", "",
       "flowcage man > ~/.local/share/man/man1/flowcage.1"}};
  return table;
}

std::string option_notes(const OptionSpec& row) {
  const std::string value = row.is_flag() ? std::string() : row.show(Options{});
  std::string text = row.range;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  if (!row.unit.empty()) add("in " + row.unit);
  if (!row.default_text.empty()) {
    add("default: " + row.default_text);
  } else if (!value.empty()) {
    add("default: " + value);
  }
  if (row.is_flag() && row.negatable) add("default: on");
  return text.empty() ? row.help : fmt::format("{} [{}]", row.help, text);
}

std::vector<std::string> option_choices(const OptionSpec& row) {
  std::vector<std::string> words;
  // "x|y|z[=VALUE]": the part in brackets may follow.
  const std::string text = row.value_name.substr(0, row.value_name.find('['));
  if (text.find('|') == std::string::npos) return words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find('|', begin), text.size());
    words.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

bool takes_file(const OptionSpec& row) {
  return row.value_name.starts_with("FILE") || row.value_name == "DIR";
}

}  // namespace flowcage
