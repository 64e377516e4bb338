#pragma once

#include "app/view/values/transfer_editor.h"

#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace gs::app {

/// A transfer function as a file has it (docs/formats.md): the values of its points are those of the data, or, where it
/// has no range, parts of whatever range the data have.
struct TransferFile {
  bool has_values = false;
  std::string units;  // of the values; may be empty
  struct Point {
    double value = 0;
    qnv::Rgb8 color;
    float opacity = 0;
  };
  std::vector<Point> points;
};

/// Reads the JSON text of a file of this name, for messages: "FILE:LINE:COLUMN: error: what, and what was expected".
/// Safe for untrusted text.
[[nodiscard]] std::variant<TransferFile, std::string> read_transfer_file(std::string_view text,
                                                                         const std::string& name);

/// The function over data with these values.
[[nodiscard]] Transfer transfer_over(const TransferFile& file, std::pair<float, float> value_range);

/// The text of a file that has the function as it is over these values, which `read_transfer_file` reads.
[[nodiscard]] std::string transfer_text(const Transfer& transfer, std::pair<float, float> value_range,
                                        const std::string& units);

}  // namespace gs::app
