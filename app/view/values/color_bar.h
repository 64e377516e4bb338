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
  double place = 0;  // position in the range, 0..1
  std::string label;
};
/// Returns tick marks at multiples of 1, 2 or 5 times a power of ten. Uses the finest step with at most `most` ticks in
/// the range. If the range is empty or `most` is below 2, returns ticks at the ends of the range. Labels have enough
/// digits to differ from each other.
[[nodiscard]] std::vector<Tick> nice_ticks(std::pair<double, double> range, std::size_t most);

/// Legend of the colours in a picture.
struct ColorBar {
  std::string title;  // "density (g/cm3)"; may be empty
  std::pair<double, double> range{0, 1};
  Transfer colors;  // colours over the range; opacities are not used
};

/// Returns the legend of a volume. Title and unit come from the metadata of the volume. `transfer` is the transfer
/// function in use.
[[nodiscard]] ColorBar color_bar_of(const qnv::Description& volume, const Transfer& transfer);
/// Returns the legend of surfaces with colours that stand for values.
[[nodiscard]] ColorBar color_bar_of(const ColorKey& key);
/// Returns the unit of a volume's values from the metadata of its file: `sample units` in NRRD, BUNIT in FITS, `unit`
/// in AVS, `units` in a stream. Returns "" if there is none.
[[nodiscard]] std::string value_unit(const qnv::Description& volume);
/// Returns the name of a volume's values: that of the VTK array or AVS field; empty if there is none.
[[nodiscard]] std::string value_name(const qnv::Description& volume);

/// Formats a number with `digits` significant digits and its unit, such as "12.5 K".
[[nodiscard]] std::string readable_value(double value, const std::string& unit = {}, int digits = 5);

}  // namespace gs::app
