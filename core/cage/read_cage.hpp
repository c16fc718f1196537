#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "core/cage/lint_report.hpp"
#include "core/mesh/cage.hpp"

namespace flowcage {

/// Cages are Wavefront OBJ files (docs/cages.md):
///   v x y z [...]            vertex; further values (weight, colour) are read and dropped
///   f a b c [...]            face of three or more vertices, counted from 1; -1 is the latest; a/t, a//n,
///   a/t/n accepted t crease 2/1/0 A B S     crease of sharpness S, vertices counted from 0 (OpenSubdiv's
///   tags; 10: infinitely t corner 1/1/0 A S       sharp); 2n/1/0, 2n/n/0 and n/1/0, n/n/0 list several l a b
///   c [...]            infinitely sharp crease along a polyline, counted from 1 g, usemtl, o NAME patch of
///   the faces that follow: g's name, without it usemtl's, without both o's
/// `\` at the end continues a line, `#` starts a comment; lines end in LF, CRLF or CR. Texture and normal
/// data, smoothing groups and display attributes are read over. Vertices may follow the faces that use them.

/// Reads and checks a cage: the result passes find_manifold_defect. Coordinates are in the file's unit.
/// Throws Error(input), "FILE:LINE: ...", for anything that is no usable cage.
Cage read_cage(const std::filesystem::path& file);

/// The same for text in memory; `source` is what messages call it.
Cage parse_cage(std::string_view text, const std::string& source);

/// A cage and what was put right in it while reading.
struct MendedCage {
  Cage cage;
  LintReport mended;
};

/// The same, but faces that run against their neighbours are reversed (rule "face_direction") where the
/// surface can be oriented at all; otherwise that is refused as above.
MendedCage read_mended_cage(const std::filesystem::path& file);
MendedCage parse_mended_cage(std::string_view text, const std::string& source);

/// Coordinates times `factor` (> 0), for example 0.001 for a cage drawn in millimetres.
Cage scale_cage(Cage cage, double factor);

}  // namespace flowcage
