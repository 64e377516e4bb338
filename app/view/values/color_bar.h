#pragma once

#include "app/formats/common/color_key.h"
#include "app/view/values/transfer_editor.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// A mark of an axis.
struct Tick {
  double value = 0;
  double place = 0;  // 0..1 of the range
  std::string label;
};
/// Marks at multiples of 1, 2 or 5 times a power of ten, the densest of which no more than `most` lie in the range;
/// both ends where it is no range or `most` is less than 2. The labels have as many digits as tell them apart.
[[nodiscard]] std::vector<Tick> nice_ticks(std::pair<double, double> range, std::size_t most);

/// What colours of a picture mean.
struct ColorBar {
  std::string title;  // "density (g/cm3)"; may be empty
  std::pair<double, double> range{0, 1};
  Transfer colors;  // over the range; opacities count for nothing
};

/// Of a volume: its title and units are those of its metadata. `transfer`: what it is shown with.
[[nodiscard]] ColorBar color_bar_of(const qnv::Description& volume, const Transfer& transfer);
/// Of surfaces whose colours stand for values.
[[nodiscard]] ColorBar color_bar_of(const ColorKey& key);
/// The unit of a volume's values, as its file has it: NRRD `sample units`, FITS BUNIT, AVS `unit`, `units` of a stream.
/// Empty: it says nothing of it.
[[nodiscard]] std::string value_unit(const qnv::Description& volume);
/// What a volume's values are, by the name that a VTK array or an AVS field gives them; may be empty.
[[nodiscard]] std::string value_name(const qnv::Description& volume);

/// "12.5 K": a number as people read it, of `digits` digits that count.
[[nodiscard]] std::string readable_value(double value, const std::string& unit = {}, int digits = 5);

}  // namespace gs::app
