// Cages drawn by hand for files of many CAD systems, where their folder is there. The limits are the figures
// of docs/theory.md ("Real files") with half as much again, for other compilers' rounding.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "core/cage/read_cage.hpp"
#include "core/refit/fit_surface.hpp"
#include "occ_bridge/cad_model.hpp"
#include "tests/catch.hpp"

using namespace flowcage;

namespace {

struct RealFile {
  const char* cad;
  const char* cage;
  double max_deviation, rms_deviation;  ///< at level 3, relative to the CAD's diagonal
  double coverage_factor = 1.5;         ///< coverage over max_deviation: every tip and pocket is covered
  double crease_angle_degrees = 20;
  Index left_out = 0;  ///< chains of the CAD that no crease follows
};

const RealFile files[] = {
    {"esp_wingsew1.stp", "esp_wingsew1.obj", 2.4e-6, 2.4e-7},
    {"tigl_simplewing.brep", "tigl_simplewing.obj", 7.7e-5, 3.6e-6, 1.5, 3},  // its kink is sharp at the nose
    {"wigley.step", "wigley.obj", 4.9e-6, 7.7e-7},
    {"series60.iges", "series60.obj", 6.2e-5, 1.1e-6},
    {"iea15_nacelle.step", "iea15_nacelle.obj", 2.8e-5, 1.7e-6},
    {"nist_11.stp", "nist_11.obj", 5.8e-6, 6.1e-7},
};

const std::filesystem::path cad_folder = FLOWCAGE_REAL_CAD_DIR;
const std::filesystem::path cage_folder = FLOWCAGE_SOURCE_DIR "/tests/refit/cages";

SurfaceFit fitted(const RealFile& file, const CadModel& model) {
  const Cage drawn = read_cage((cage_folder / file.cage).string());
  FitSettings settings;
  settings.levels = 3;
  Progress silent;
  return fit_surface(scale_cage(drawn, model.summary().files[0].unit_in_metres), model, settings, silent);
}

}  // namespace

TEST_CASE("hand-drawn cages are fitted to real files: deviation, coverage, folds, features", "[fit][cad]") {
  if (!std::filesystem::is_directory(cad_folder)) {
    std::puts("skipped: no folder of real CAD files");
    return;
  }
  for (const RealFile& file : files) {
    DYNAMIC_SECTION(file.cad) {
      const std::string name = (cad_folder / file.cad).string();
      if (!std::filesystem::exists(name)) {
        fmt::print("skipped: no {}\n", file.cad);
        continue;
      }
      Progress silent;
      CadReadSettings settings;
      settings.crease_angle_degrees = file.crease_angle_degrees;
      const CadModel model = read_cad({&name, 1}, settings, silent);
      const SurfaceFit fit = fitted(file, model);
      INFO("max " << fit.max_deviation << " at " << fit.worst_place.transpose() << " m, rms "
                  << fit.rms_deviation << ", coverage " << fit.coverage_deviation << " at "
                  << fit.worst_coverage_place.transpose() << " m");
      REQUIRE(fit.levels.size() == 4);
      for (const FittedLevel& level : fit.levels) {
        INFO("level " << level.report.level);
        CHECK(level.report.folds == 0);
      }
      CHECK(fit.max_deviation < 1.5 * file.max_deviation);
      CHECK(fit.rms_deviation < 1.5 * file.rms_deviation);
      CHECK(fit.coverage_deviation < file.coverage_factor * std::max(fit.max_deviation, file.max_deviation));
      CHECK(static_cast<Index>(fit.unmatched_chains.size()) == file.left_out);
    }
  }
}
