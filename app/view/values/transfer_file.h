#pragma once

#include "app/view/values/transfer_editor.h"

#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace gs::app {

/// Transfer function in the form of its file (docs/formats.md). The values of points are data values; if the file has
/// no `range`, they are fractions of the range of the data.
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

/// Parses the JSON text of a transfer function file. Returns an error message in the form "FILE:LINE:COLUMN: error:
/// ..."; `name` is its FILE. Safe for untrusted text.
[[nodiscard]] std::variant<TransferFile, std::string> read_transfer_file(std::string_view text,
                                                                         const std::string& name);

/// Converts the function of a file to the range of the data.
[[nodiscard]] Transfer transfer_over(const TransferFile& file, std::pair<float, float> value_range);

/// Formats a transfer function for data with this range as JSON text for read_transfer_file().
[[nodiscard]] std::string transfer_text(const Transfer& transfer, std::pair<float, float> value_range,
                                        const std::string& units);

}  // namespace gs::app
