#pragma once

#include <jsapi.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

// Limits on the work of single native calls. SpiderMonkey checks the time limit between operations and in loops, but
// not inside native functions. Therefore each native call must be short.
namespace gs::app::script {

/// Max characters of a string that a Script passes to fields, nodes and the Browser object.
inline constexpr std::size_t kMaxCharacters = std::size_t{1} << 24;
/// Max characters of the text of a Script, and of a text for eval() and Function().
inline constexpr std::size_t kMaxProgram = std::size_t{1} << 22, kMaxEvaluated = std::size_t{1} << 20;
/// Max digits of a number in a program or JSON text. SpiderMonkey parses numbers in quadratic time.
inline constexpr std::size_t kMaxDigits = std::size_t{1} << 16;

/// Replaces slow built-in functions of the current global by bounded ones. These throw a RangeError if the call would
/// take too long. Otherwise their names, lengths and results are those of the originals.
bool bound_natives(JSContext* context, JS::HandleObject global);
/// Limits the texts that eval(), Function() and similar functions compile, in all globals of the context.
void bound_evaluation(JSContext* context);

/// Returns the length of the longest run of characters that could be part of one number.
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

/// Throws a RangeError with the message `why`. Always returns false.
bool fail_range(JSContext* context, const std::string& why);
/// Throws a RangeError: `what` has `length` characters, more than `most`. Always returns false.
bool too_long(JSContext* context, const char* what, std::size_t length, std::size_t most);
/// Checks the length of a program and of the numbers in it. Throws and returns false if one is too long to compile.
bool check_program(JSContext* context, std::string_view text);
/// Rejects BigInt literals such as 1n, because BigInt operators take quadratic time. Throws and returns false if the
/// program has such a literal. The caller must have compiled the program successfully.
bool check_integers(JSContext* context, std::string_view text);

}  // namespace gs::app::script
