#pragma once

#include "app/script/program.h"
#include "base/diagnostic.h"

#include <jsapi.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

// Text of programs: its older forms, its compilation, and the exceptions of its programs.
namespace gs::app::script {

/// Compiles a program. If this fails, tries again with mended_text(). If both fail, throws the exception of the
/// original text and returns null.
JSScript* compile_mended(JSContext* context, const std::string& text, const std::string& file, SourceLocation place);
/// Clears the pending exception and returns its text; nullopt if it has none. Sets `recursion` if endless recursion
/// caused the exception.
std::optional<Diagnostic> take_exception(JSContext* context, bool& recursion);

// legacy_vrmlscript.cpp
/// Rewrites assignments so that they copy, as in Annex C. `values` holds the names of the fields and eventOuts with
/// values that ECMAScript would share. Keeps line numbers.
[[nodiscard]] std::string modern_text(std::string_view text, const std::vector<std::string>& values);
/// Corrects constructs that the engine refuses. These are line ends in strings, names that became reserved words, VRML
/// comments, comments without an end, and unbalanced braces. Also rewrites `for each` of JavaScript 1.6 and functions
/// without braces of JavaScript 1.8.
[[nodiscard]] std::string mended_text(std::string_view text);
/// Returns the text of a program's code in modern ECMAScript; see modern_text() and contact_text().
[[nodiscard]] std::string modern_text_of(const Program& program, std::string_view text);

}  // namespace gs::app::script
