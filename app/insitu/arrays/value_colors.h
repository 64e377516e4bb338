#pragma once

#include "qnv/base/description.h"

#include <string>
#include <utility>

namespace gs::app::insitu {

/// Range of values that the colours of a surface stand for (docs/formats.md, "Colours that stand for values").
struct ValueColors {
  double low = 0, high = 0;
  std::string title;

  /// Extends the range. Ignores values that are not finite.
  void include(double value);
  /// Returns the colour of a value in the colour map Viridis; grey for NaN, or if there is no range.
  [[nodiscard]] qnv::Rgb8 color_of(double value) const;
  /// Returns the metadata of a stream, from which viewers map colours back to values.
  [[nodiscard]] std::pair<std::string, std::string> metadata() const;

 private:
  bool any_ = false;
};

/// Returns a number as text with up to nine digits.
[[nodiscard]] std::string number_text(double number);

}  // namespace gs::app::insitu
