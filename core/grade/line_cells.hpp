#pragma once
#include <span>
#include <vector>

#include "core/base/types.hpp"

namespace flowcage {

/// Wall spacing that was asked for.
struct LayerSettings {
  double first_height = 0;  ///< metres, > 0: distance of the first points from the wall
  double growth = 1.2;      ///< > 1, from cell to cell after two constant cells
  Index layers = 0;         ///< cells that follow first_height and growth exactly; 0: the first two
  Index multiple = 1;       ///< the number of cells along a line is a multiple of it: for nested families
};

/// Sizes of the cells that follow height and growth exactly: at most half of a line of that length.
std::vector<double> exact_cells(double length, const LayerSettings& settings);

/// Cell sizes along one line: `lengths` (ascending from 0) is where its points are. With f(s) the wanted size
/// at s, first height, growth, then the line's own sizes, cell limits are where the integral of 1 / f is a
/// whole number; the growth is lowered until it is one at the end,
/// and their number a multiple of settings.multiple.
std::vector<double> graded_cells(std::span<const double> lengths, const LayerSettings& settings);

/// Places of `count` cells, from 0 to the line's end, that have the line's own sizes at its end and toward
/// its start are finer by a constant ratio a cell of its own: with t its own layer coordinate, 0 .. n, there
/// are exp(c (n - t)) cells a unit of t, c such that they are `count`. So the outer points stay near their
/// places however many cells there are. Precondition: count >= 1.
std::vector<double> relaxed_spacing(std::span<const double> lengths, Index count);

}  // namespace flowcage
