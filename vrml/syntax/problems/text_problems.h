#pragma once

#include "base/diagnostic.h"
#include "vrml/scene/source_text.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace gs::vrml {

/// Reporter of the problems of one text. It adds the file name. One thread.
class TextProblems {
 public:
  /// `text` and `diagnostics` must outlive this object.
  TextProblems(const SourceText& text, Diagnostics& diagnostics) : text_(text), diagnostics_(diagnostics) {}

  void report(Severity severity, SourceLocation location, std::string message) {
    diagnostics_.add({severity, text_.file_name(), location, std::move(message)});
  }
  void error(SourceLocation location, std::string message) { report(Severity::error, location, std::move(message)); }
  void warn(SourceLocation location, std::string message) { report(Severity::warning, location, std::move(message)); }
  void warn_once(bool& said, SourceLocation location, std::string message) {
    if (!std::exchange(said, true)) warn(location, std::move(message));
  }

 private:
  const SourceText& text_;
  Diagnostics& diagnostics_;
};

/// Returns a word for messages: in quotes, shortened, without control characters.
[[nodiscard]] inline std::string quoted(std::string_view word) {
  constexpr std::size_t kMaxShown = 40;
  std::string text = "'";
  for (const char c : word.substr(0, kMaxShown)) text += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
  return text + (word.size() > kMaxShown ? "...'" : "'");
}

}  // namespace gs::vrml
