#pragma once

#include "app/formats/common/color_key.h"
#include "app/view/values/transfer_editor.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Tick mark of an axis.
struct Tick {
  double value = 0;
  double place = 0;  // 0..1 of the range
  std::string label;
};
/// Returns tick marks at multiples of 1, 2 or 5 times a power of ten: the finest step with at most `most` ticks in the
/// range. Returns the ends of the range if it is empty or `most` is below 2. Labels have as many digits as needed to
/// differ.
[[nodiscard]] std::vector<Tick> nice_ticks(std::pair<double, double> range, std::size_t most);

/// Legend that explains a picture's colours.
struct ColorBar {
  std::string title;  // "density (g/cm3)"; may be empty
  std::pair<double, double> range{0, 1};
  Transfer colors;  // colours over the range; opacities are ignored
};

/// Returns the legend of a volume; title and units come from its metadata. `transfer` is the displayed transfer
/// function.
[[nodiscard]] ColorBar color_bar_of(const qnv::Description& volume, const Transfer& transfer);
/// Returns the legend of surfaces with values as colours.
[[nodiscard]] ColorBar color_bar_of(const ColorKey& key);
/// Returns the unit of a volume's values from its file: NRRD `sample units`, FITS BUNIT, AVS `unit`, or `units` of a
/// stream. Returns "" if the file gives none.
[[nodiscard]] std::string value_unit(const qnv::Description& volume);
/// Returns the name of a volume's values from a VTK array or AVS field; may be empty.
[[nodiscard]] std::string value_name(const qnv::Description& volume);

/// Formats a number for people with `digits` significant digits: "12.5 K".
[[nodiscard]] std::string readable_value(double value, const std::string& unit = {}, int digits = 5);

}  // namespace gs::app
