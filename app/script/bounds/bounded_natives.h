#pragma once

#include <jsapi.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

// Bounds on the work of single native calls. SpiderMonkey checks the time limit between operations and in loops, but
// not inside native calls. So each call must be short.
namespace gs::app::script {

/// Max characters of a string that a program passes to fields, nodes and the browser.
inline constexpr std::size_t kMaxCharacters = std::size_t{1} << 24;
/// Max characters of a Script's text, and of a text for eval() and Function().
inline constexpr std::size_t kMaxProgram = std::size_t{1} << 22, kMaxEvaluated = std::size_t{1} << 20;
/// Max digits of a number in a text that is compiled or parsed; the engine takes quadratic time to read it.
inline constexpr std::size_t kMaxDigits = std::size_t{1} << 16;

/// Wraps the slow built-in functions of the current global. A wrapper throws a RangeError if the call would take long.
/// Names, lengths and results stay the same.
bool bound_natives(JSContext* context, JS::HandleObject global);
/// Bounds the text of eval(), Function() and their relatives in all globals of the context.
void bound_evaluation(JSContext* context);

/// Returns the length of the longest run of characters that can be part of a number.
template <class Characters>
std::size_t longest_number(const Characters* characters, std::size_t length) {
  std::size_t run = 0, longest = 0;
  for (std::size_t i = 0; i < length; ++i) {
    const auto c = characters[i];
    run = (c >= '0' && c <= '9') || c == '.' || c == '_' ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

/// Throws a RangeError. Returns false.
bool fail_range(JSContext* context, const std::string& why);
/// Throws a RangeError about a length. Returns false.
bool too_long(JSContext* context, const char* what, std::size_t length, std::size_t most);
/// Throws if a program has a text or a number that is too long to compile. Returns false then.
bool check_program(JSContext* context, std::string_view text);
/// Rejects BigInt literals such as 1n, because operators of BigInt take quadratic time. Throws and returns false if the
/// program has one. The program must compile without them.
bool check_integers(JSContext* context, std::string_view text);

}  // namespace gs::app::script
