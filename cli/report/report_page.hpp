#pragma once
#include <ostream>
#include <string>
#include <vector>

#include "cli/json_report.hpp"
#include "cli/report/scene.hpp"

namespace flowcage {

/// What a report says beside its pictures.
struct ReportText {
  std::string command;                ///< mesh, surface, inspect
  const Options& options;             ///< of it: inputs, unit
  std::vector<std::string> warnings;  ///< as they were given, places in brackets
  Json facts;                         ///< what --json writes
};

/// Writes one HTML page that needs no other file and no network: three.js, scripts, style and data are in it,
/// and its content security policy forbids the browser to load anything. Names from files reach it as JSON in
/// which no markup can begin, and the page shows them as text only. The same bytes for the same result: what
/// differs from run to run (seconds, memory) is left out of the facts.
void write_report_page(std::ostream& out, const ReportText& text, const Scene& scene);

}  // namespace flowcage
