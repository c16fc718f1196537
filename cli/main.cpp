#include <exception>
#include <new>
#include <string>
#include <vector>

#include "cli/batch.hpp"
#include "cli/command_line.hpp"
#include "cli/commands/commands.hpp"
#include "cli/config_file.hpp"
#include "cli/interruption.hpp"
#include "cli/man_page.hpp"
#include "cli/output_names.hpp"
#include "cli/shell_completion.hpp"
#include "cli/terminal.hpp"
#include "core/base/atomic_file.hpp"
#include "core/base/parallel.hpp"

namespace flowcage {
namespace {

/// Before the work: also a run that fails can be repeated.
void save_config(Command command, const Options& options) {
  if (options.save_config.empty()) return;
  AtomicFile file(options.save_config);
  file.stream() << config_text(command, options);
  file.commit();
}

int run(const Request& request, const Interruption& interruption) {
  if (!request.command) {
    print(request.text);
    return 0;
  }
  const Options& options = request.options;
  check_output_names(*request.command, options);
  save_config(*request.command, options);
  set_thread_count(options.threads);
  TerminalProgress progress(interruption, options.quiet);
  switch (*request.command) {
    case Command::subdivide:
      return run_subdivide(options, progress);
    case Command::inspect:
      return run_inspect(options, progress);
    case Command::quality:
      return run_quality(options, progress);
    case Command::surface:
      return run_surface(options, progress);
    case Command::mesh:
      return options.out_dir.empty() ? run_mesh(options, progress) : run_batch(options, progress);
    case Command::cage:
      return run_cage(options, progress);
    case Command::convert:
      return run_convert(options, progress);
    case Command::completion:
      print(completion_script(options.inputs.front()));
      return 0;
    case Command::man:
      print(man_page());
      return 0;
  }
  throw Error(ErrorKind::usage, "this command is not in this version", "see flowcage --help");
}

}  // namespace
}  // namespace flowcage

int main(int argc, char** argv) {
  using flowcage::Error;
  using flowcage::ErrorKind;
  const auto defect = [](const std::string& what) {
    return Error(ErrorKind::internal, "internal error: " + what,
                 "this is a defect of flowcage: please report it with the command and its input files");
  };
  const flowcage::Interruption interruption;
  try {
    try {
      const std::vector<std::string> arguments(argv + (argc > 0 ? 1 : 0), argv + argc);
      return flowcage::run(flowcage::parse_command_line(arguments), interruption);
    } catch (const Error&) {
      throw;
    } catch (const std::bad_alloc&) {
      throw Error(ErrorKind::internal, "out of memory",
                  "use fewer levels, a coarser cage or a larger machine");
    } catch (const std::exception& e) {
      throw defect(e.what());
    } catch (...) {
      throw defect("an unknown exception");
    }
  } catch (const Error& error) {
    flowcage::print_error(error);
    return static_cast<int>(error.kind());
  }
}
