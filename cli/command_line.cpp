#include "cli/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <memory>

#include "cli/command_table.hpp"
#include "cli/config_file.hpp"
#include "core/base/error.hpp"
#include "core/base/suggestion.hpp"
#include "core/export/write_cgns.hpp"
#include "occ_bridge/occ_version.hpp"

namespace flowcage {
namespace {

void bind(CLI::App& app, const OptionSpec& row, Options& options) {
  const auto set = row.set;
  if (row.is_flag()) {
    app.add_flag_callback(
           "--" + row.name, [set, &options] { set(options, "true"); }, option_notes(row))
        ->group(row.group);
    if (row.negatable) {
      app.add_flag_callback(
             "--no-" + row.name, [set, &options] { set(options, "false"); }, "the opposite")
          ->group(row.group);
    }
    return;
  }
  if (row.repeatable) {
    app.add_option_function<std::vector<std::string>>(
           "--" + row.name,
           [set, &options](const std::vector<std::string>& values) {
             for (const std::string& value : values) set(options, value);
           },
           option_notes(row))
        ->type_name(row.value_name)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->group(row.group);
    return;
  }
  app.add_option_function<std::string>(
         "--" + row.name, [set, &options](const std::string& v) { set(options, v); }, option_notes(row))
      ->type_name(row.value_name)
      ->group(row.group);
}

CLI::App* add_command(CLI::App& app, const CommandSpec& spec, Options& options) {
  CLI::App* sub = app.add_subcommand(spec.name, spec.summary);
  if (!spec.input_name.empty()) {
    sub->add_option(spec.input_name, options.inputs, spec.input_help)
        ->required()
        ->type_name("")
        ->expected(spec.many_inputs ? -1 : 1);
  }
  if (!spec.output_name.empty()) {
    sub->add_option("-o,--output", options.outputs, spec.output_help)
        ->required(!spec.has_out_dir())
        ->type_name(spec.output_name)
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  }
  for (const OptionSpec& row : option_table()) {
    if (row.belongs_to(spec.command)) bind(*sub, row, options);
  }
  sub->footer("Example:\n  " + spec.example);
  return sub;
}

std::vector<std::string> command_names() {
  std::vector<std::string> names;
  for (const CommandSpec& spec : command_table()) names.push_back(spec.name);
  return names;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// "did you mean X?" as a remedy, or where to look.
std::string remedy_for(const std::string& word, const std::vector<std::string>& candidates,
                       const std::string& help) {
  const std::string meant = suggestion(word, candidates);
  return meant.empty() ? fmt::format("see {}", help) : fmt::format("did you mean {}? See {}", meant, help);
}

bool is_short_option(const CLI::App& app, const std::string& word) {
  return word.size() == 2 && word[0] == '-' && app.get_option_no_throw(word) != nullptr;
}

/// CLI11 takes an unknown option's value for an argument and complains about that; so names are checked
/// first.
void check_option_names(const CLI::App& app, const std::vector<std::string>& arguments,
                        const std::string& help) {
  for (std::size_t i = 0; i < arguments.size() && arguments[i] != "--"; ++i) {
    const std::string& word = arguments[i];
    if (!word.starts_with('-') || word.size() < 2) continue;
    const bool is_long = word.starts_with("--");
    const std::string name = is_long ? word.substr(0, word.find('=')) : word.substr(0, 2);
    const CLI::Option* option = app.get_option_no_throw(name);
    if (option == nullptr) {
      throw Error(ErrorKind::usage, fmt::format("unknown option {}", name),
                  remedy_for(name, option_names(app), help));
    }
    const bool takes_value = option->get_items_expected_max() > 0;
    if (!takes_value && is_long && word != name) {
      throw Error(ErrorKind::usage, fmt::format("{}: takes no value", name),
                  fmt::format("give {} alone", name));
    }
    const auto missing = [&] {
      return Error(ErrorKind::usage, fmt::format("{}: the value is missing", name),
                   fmt::format("give {} {}", name, option->get_type_name()));
    };
    if (takes_value && word == name + "=") throw missing();
    const bool value_follows = takes_value && word == name;
    if (!value_follows) continue;
    if (++i == arguments.size() || arguments[i].starts_with("--") || is_short_option(app, arguments[i])) {
      throw missing();
    }
  }
}

void check_opposites(const CLI::App& app) {
  for (const OptionSpec& row : option_table()) {
    if (row.negatable && app.get_option_no_throw("--" + row.name) != nullptr &&
        app.count("--" + row.name) > 0 && app.count("--no-" + row.name) > 0) {
      throw Error(ErrorKind::usage, fmt::format("--{0} and --no-{0} exclude each other", row.name),
                  "give one of them");
    }
  }
}

/// Where outputs go is said once.
void check_out_dir(const CommandSpec& spec, const Options& options) {
  if (!spec.has_out_dir()) return;
  if (options.out_dir.empty()) {
    const Options defaults;
    const char* alone = options.jobs != defaults.jobs       ? "--jobs"
                        : options.format != defaults.format ? "--format"
                                                            : nullptr;
    if (alone != nullptr) {
      throw Error(ErrorKind::usage, fmt::format("{} belongs to --out-dir, which is missing", alone),
                  "give --out-dir DIR, or leave it out");
    }
    if (!options.outputs.empty()) return;
    throw Error(ErrorKind::usage, "--output is required",
                fmt::format("give -o {}, see flowcage {} --help", spec.output_name, spec.name));
  }
  const std::string clash = !options.outputs.empty()    ? "-o"
                            : !options.json.empty()     ? "--json"
                            : !options.report.empty()   ? "--report"
                            : !options.pictures.empty() ? "--pictures"
                                                        : "";
  if (clash.empty()) return;
  throw Error(ErrorKind::usage, fmt::format("{} and --out-dir exclude each other", clash),
              "with --out-dir each file has its output in that folder, and its figures on stdout");
}

}  // namespace

std::string version_text() {
  return fmt::format("flowcage {}\nOpenCASCADE {}\nEigen {}.{}.{}\nCGNS {}\n", FLOWCAGE_VERSION,
                     occ_version(), EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
                     cgns_version());
}

Request parse_command_line(const std::vector<std::string>& arguments) {
  Request request;
  CLI::App app("CAD to all-hexahedral block-structured meshes for flow simulation", "flowcage");
  app.set_version_flag("--version", version_text(), "versions of flowcage and of its libraries");
  app.require_subcommand(1);
  app.get_formatter()->column_width(36);
  app.footer("Example:\n  " + command_table().front().example +
             "\n\n`flowcage COMMAND --help` explains a command.");
  std::vector<std::pair<const CommandSpec*, CLI::App*>> commands;
  for (const CommandSpec& spec : command_table())
    commands.emplace_back(&spec, add_command(app, spec, request.options));

  if (arguments.empty()) {
    throw Error(ErrorKind::usage, "no command given", "see flowcage --help");
  }
  const std::string& first = arguments.front();
  const auto named =
      std::find_if(commands.begin(), commands.end(), [&](const auto& c) { return c.first->name == first; });
  if (!first.starts_with('-') && named == commands.end()) {
    throw Error(ErrorKind::usage, fmt::format("unknown command \"{}\"", first),
                remedy_for(first, command_names(), "flowcage --help"));
  }
  const bool has_command = named != commands.end();
  CLI::App& active = has_command ? *named->second : app;
  const std::string help = has_command ? fmt::format("flowcage {} --help", first) : "flowcage --help";
  check_option_names(active, {arguments.begin() + (has_command ? 1 : 0), arguments.end()}, help);
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    check_opposites(active);
    request.command = named->first->command;
    if (!request.options.config.empty()) {
      const auto given = [&active](const OptionSpec& row) {
        return active.count("--" + row.name) > 0 || (row.negatable && active.count("--no-" + row.name) > 0);
      };
      read_config(*request.command, given, request.options);
    }
    check_out_dir(*named->first, request.options);
  } catch (const CLI::CallForHelp&) {
    request.text = has_command ? active.help("flowcage") : app.help();
  } catch (const CLI::CallForVersion&) {
    request.text = version_text();
  } catch (const CLI::ParseError& e) {
    throw Error(ErrorKind::usage, e.what(), "see " + help);
  }
  return request;
}

}  // namespace flowcage
