#pragma once

#include "base/budget.h"
#include "base/noncopyable.h"

// Declares the functions that limit the expansion of entities.
#ifndef XML_DTD
#define XML_DTD
#endif
#include <expat.h>

#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace gs::vrml::xml {

/// Hardened Expat parser for UTF-8 text: it loads nothing, it limits the expansion of entities, and it charges its
/// memory to a budget. Handlers may throw. One thread.
class ExpatParser : NonCopyable {
 public:
  struct Handlers {
    /// Receives the name of a start tag, and its attributes: alternating names and values, then null.
    std::function<void(std::string_view name, const char** attributes)> begin;
    std::function<void()> end;
    std::function<void(std::string_view text)> text;
  };
  ExpatParser(std::shared_ptr<Budget> budget, Handlers handlers);
  ~ExpatParser();

  /// Parses the next part of the text. Returns false after an error or after stop(); parsing then ends.
  [[nodiscard]] bool parse(std::string_view text, bool last);
  /// Ends parsing, from a handler.
  void stop();
  /// Returns the error of the last parse(), for diagnostics.
  [[nodiscard]] std::string error() const;
  /// Returns the error of an end tag without a start tag, in the words of error().
  [[nodiscard]] static std::string mismatch_error() { return XML_ErrorString(XML_ERROR_TAG_MISMATCH); }
  /// Reports whether parsing ended because the budget has no memory left.
  [[nodiscard]] bool is_out_of_memory() const;

 private:
  template <class Work>
  void guarded(Work&& work) noexcept;
  static void begin_element(void* user, const XML_Char* name, const XML_Char** attributes);
  static void end_element(void* user, const XML_Char* name);
  static void take_text(void* user, const XML_Char* text, int length);

  Share memory_;
  Handlers handlers_;
  XML_Parser parser_ = nullptr;
  std::exception_ptr thrown_;
};

}  // namespace gs::vrml::xml
