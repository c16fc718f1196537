#include "cli/config_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <toml++/toml.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/suggestion.hpp"
#include "core/export/file_text.hpp"

namespace flowcage {
namespace {

/// A file that names files of its kind would have no end.
bool may_stand_in_file(const OptionSpec& row, Command command) {
  return row.belongs_to(command) && row.name != "config" && row.name != "save-config";
}

std::vector<OptionSpec> rows_of(Command command) {
  std::vector<OptionSpec> rows;
  for (const OptionSpec& row : option_table()) {
    if (may_stand_in_file(row, command)) rows.push_back(row);
  }
  return rows;
}

long line_of(const toml::source_region& source) {
  return static_cast<long>(source.begin.line);
}

std::string expected(const OptionSpec& row) {
  if (row.is_flag()) return "true or false";
  if (row.numeric) return "a number without quotes";
  return row.repeatable ? "text in quotes or a list of it" : "text in quotes";
}

class ConfigReader {
 public:
  ConfigReader(std::string file, Command command) : file_(std::move(file)), rows_(rows_of(command)) {}

  const OptionSpec& row_of(const toml::key& key) const {
    const auto named =
        std::ranges::find_if(rows_, [&](const OptionSpec& row) { return row.name == key.str(); });
    if (named != rows_.end()) return *named;
    std::vector<std::string> names;
    for (const OptionSpec& row : rows_) names.push_back(row.name);
    const std::string meant = suggestion(std::string(key.str()), names);
    throw input_error(file_, line_of(key.source()), fmt::format("unknown option \"{}\"", key.str()),
                      meant.empty() ? "see docs/options.md for the options of this command"
                                    : fmt::format("did you mean {}?", meant));
  }

  /// The value as the command line would have it, one for each use.
  std::vector<std::string> values_of(const OptionSpec& row, const toml::node& value) const {
    std::vector<std::string> values;
    const toml::array* list = value.as_array();
    if (list == nullptr || !row.repeatable) {
      values.push_back(text_of(row, value));
    } else {
      for (const toml::node& item : *list) values.push_back(text_of(row, item));
    }
    return values;
  }

  void set(const OptionSpec& row, const toml::node& value, Options& options) const {
    try {
      for (const std::string& text : values_of(row, value)) row.set(options, text);
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::usage) throw;
      throw input_error(file_, line_of(value.source()), e.what(), e.remedy());
    }
  }

 private:
  std::string text_of(const OptionSpec& row, const toml::node& value) const {
    if (row.is_flag()) {
      if (const auto* flag = value.as_boolean()) return flag->get() ? "true" : "false";
    } else if (row.numeric) {
      if (const auto* integer = value.as_integer()) return fmt::format("{}", integer->get());
      if (const auto* real = value.as_floating_point()) return fmt::format("{}", real->get());
    } else if (const auto* text = value.as_string()) {
      return text->get();
    }
    throw input_error(file_, line_of(value.source()),
                      fmt::format("{}: the value has the wrong type", row.name),
                      fmt::format("give {}", expected(row)));
  }

  std::string file_;
  std::vector<OptionSpec> rows_;
};

toml::table parsed(const std::string& file) {
  const std::string text = read_whole_file(file);
  try {
    return toml::parse(std::string_view(text));
  } catch (const toml::parse_error& e) {
    throw input_error(file, line_of(e.source()), std::string(e.description()), "correct the TOML there");
  }
}

/// As a basic string of TOML.
std::string toml_string(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\u{:04X}", byte);
    } else {
      out += c;
    }
  }
  return out + '"';
}

}  // namespace

void read_config(Command command, const std::function<bool(const OptionSpec&)>& given, Options& options) {
  const toml::table table = parsed(options.config);
  const ConfigReader reader(options.config, command);
  Options checked_only;
  for (const auto& [key, value] : table) {
    const OptionSpec& row = reader.row_of(key);
    reader.set(row, value, given(row) ? checked_only : options);
  }
}

std::string config_text(Command command, const Options& options) {
  std::string out = "# Options of flowcage, to be read with --config\n";
  for (const OptionSpec& row : rows_of(command)) {
    std::string value = row.show(options);
    if (row.repeatable) {
      std::vector<std::string> items = row.values(options);
      std::ranges::transform(items, items.begin(), toml_string);
      value = items.empty() ? "" : fmt::format("[{}]", fmt::join(items, ", "));
    } else if (!row.is_flag() && !row.numeric && !value.empty()) {
      value = toml_string(value);
    }
    if (!value.empty()) out += fmt::format("{} = {}\n", row.name, value);
  }
  return out;
}

}  // namespace flowcage
