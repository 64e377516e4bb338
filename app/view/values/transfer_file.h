#pragma once

#include "app/view/values/transfer_editor.h"

#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace gs::app {

/// Transfer function as stored in a file (docs/formats.md). Point values are data values, or fractions of the data's
/// range if the file has none.
struct TransferFile {
  bool has_values = false;
  std::string units;  // unit of the values; may be empty
  struct Point {
    double value = 0;
    qnv::Rgb8 color;
    float opacity = 0;
  };
  std::vector<Point> points;
};

/// Parses JSON text. `name` is for messages: "FILE:LINE:COLUMN: error: what, and what was expected". Safe for untrusted
/// text.
[[nodiscard]] std::variant<TransferFile, std::string> read_transfer_file(std::string_view text,
                                                                         const std::string& name);

/// Returns the function for data with this value range.
[[nodiscard]] Transfer transfer_over(const TransferFile& file, std::pair<float, float> value_range);

/// Writes a function over this value range as JSON that `read_transfer_file` reads.
[[nodiscard]] std::string transfer_text(const Transfer& transfer, std::pair<float, float> value_range,
                                        const std::string& units);

}  // namespace gs::app
