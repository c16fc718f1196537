#include "cli/report/embedded_files.hpp"

// The assembler copies the bytes: a compiler takes minutes for a literal of this size. FLOWCAGE_EMBED_... are
// the files' names, from CMake.
// NOLINTBEGIN(bugprone-macro-parentheses): the name becomes a part of a literal
#define FLOWCAGE_EMBED(symbol, file)                                                     \
  __asm__(".pushsection .rodata\n.global " #symbol "\n.global " #symbol "_end\n" #symbol \
          ":\n.incbin \"" file "\"\n" #symbol "_end:\n.byte 0\n.popsection\n");          \
  extern "C" const char symbol[] __attribute__((visibility("hidden")));                  \
  extern "C" const char symbol##_end[] __attribute__((visibility("hidden")));
// NOLINTEND(bugprone-macro-parentheses)

FLOWCAGE_EMBED(flowcage_report_page, FLOWCAGE_EMBED_FOLDER "/report.html")
FLOWCAGE_EMBED(flowcage_report_style, FLOWCAGE_EMBED_FOLDER "/report.css")
FLOWCAGE_EMBED(flowcage_report_scene, FLOWCAGE_EMBED_FOLDER "/scene.js")
FLOWCAGE_EMBED(flowcage_report_viewer, FLOWCAGE_EMBED_FOLDER "/viewer.js")
FLOWCAGE_EMBED(flowcage_report_tables, FLOWCAGE_EMBED_FOLDER "/tables.js")
FLOWCAGE_EMBED(flowcage_report_three, FLOWCAGE_EMBED_THREE)
FLOWCAGE_EMBED(flowcage_report_orbit, FLOWCAGE_EMBED_ORBIT)

namespace flowcage {

EmbeddedFiles embedded_files() {
  return {.page = {flowcage_report_page, flowcage_report_page_end},
          .style = {flowcage_report_style, flowcage_report_style_end},
          .scene = {flowcage_report_scene, flowcage_report_scene_end},
          .viewer = {flowcage_report_viewer, flowcage_report_viewer_end},
          .tables = {flowcage_report_tables, flowcage_report_tables_end},
          .three = {flowcage_report_three, flowcage_report_three_end},
          .orbit_controls = {flowcage_report_orbit, flowcage_report_orbit_end}};
}

}  // namespace flowcage
