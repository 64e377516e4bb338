#pragma once

#include "base/noncopyable.h"

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace gs::vrml {

/// Text of a printed scene, which is passed on in pieces of about one megabyte. One thread.
class TextOutput : NonCopyable {
 public:
  /// `write` returns false to stop.
  explicit TextOutput(std::function<bool(std::string_view)> write) : write_(std::move(write)) {}

  /// Passes the text on if it is large.
  void drain() {
    if (text.size() > kPiece) flush();
  }
  void flush() {
    wanted_ = wanted_ && write_(text);
    text.clear();
  }
  /// Starts a line with this indentation, in levels of two blanks.
  void start_line(std::size_t levels) {
    text += '\n';
    indent(levels);
  }
  void indent(std::size_t levels) { text.append(blanks(levels), ' '); }
  /// Returns the blanks at the start of a line. They are limited, because most of a text with a thousand levels would
  /// be blanks otherwise.
  [[nodiscard]] static std::size_t blanks(std::size_t levels) {
    return levels < kMaxIndent ? 2 * levels : 2 * kMaxIndent;
  }

  std::string text;  // text that has not been passed on

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 20, kMaxIndent = 40;
  std::function<bool(std::string_view)> write_;
  bool wanted_ = true;
};

}  // namespace gs::vrml
