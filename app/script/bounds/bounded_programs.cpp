#include "app/script/bounds/bounded_natives.h"

#include <js/CharacterEncoding.h>
#include <js/CompilationAndEvaluation.h>
#include <js/CompileOptions.h>
#include <js/Exception.h>
#include <js/Principals.h>
#include <js/SourceText.h>
#include <js/String.h>

#include <optional>

// Limits on the texts of programs. They are needed because compilation cannot be interrupted.
namespace gs::app::script {
namespace {

constexpr std::size_t kMaxUnicodeSets = 4096;  // max uses of \p in a program

bool may_evaluate(JSContext* context, JS::RuntimeCode, JS::HandleString text) {
  if (JS::GetStringLength(text) > kMaxEvaluated) return false;
  JSLinearString* const linear = JS_EnsureLinearString(context, text);
  if (!linear) return false;
  std::string bytes(JS::GetDeflatedUTF8StringLength(linear), ' ');
  bytes.resize(JS::DeflateStringToUTF8Buffer(linear, mozilla::Span(bytes.data(), bytes.size())));
  if (check_program(context, bytes) && check_integers(context, bytes)) return true;
  JS_ClearPendingException(context);  // SpiderMonkey throws its own EvalError
  return false;
}

bool in_literal(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '$';
}

// Replaces the final n of each possible BigInt literal by @, which is invalid in code. Returns nullopt if the text has
// no such literal.
std::optional<std::string> without_integers(std::string_view text) {
  std::optional<std::string> spoilt;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (!in_literal(text[i])) continue;
    const std::size_t begin = i;
    while (i < text.size() && in_literal(text[i])) ++i;
    if (text[i - 1] != 'n' || text[begin] < '0' || text[begin] > '9') continue;
    if (!spoilt) spoilt = text;
    (*spoilt)[i - 1] = '@';
  }
  return spoilt;
}

}  // namespace

void bound_evaluation(JSContext* context) {
  static constexpr JSSecurityCallbacks kCallbacks{may_evaluate, nullptr};
  JS_SetSecurityCallbacks(context, &kCallbacks);
}
bool check_program(JSContext* context, std::string_view text) {
  if (text.size() > kMaxProgram) return too_long(context, "a program", text.size(), kMaxProgram);
  std::size_t sets = 0;
  for (std::size_t i = 0; i + 1 < text.size(); ++i)
    if (text[i] == '\\' && (text[i + 1] == 'p' || text[i + 1] == 'P')) ++sets;
  if (sets > kMaxUnicodeSets) return fail_range(context, "a program has too many Unicode sets (\\p)");
  const std::size_t digits = longest_number(text.data(), text.size());
  return digits <= kMaxDigits || too_long(context, "a number", digits, kMaxDigits);
}

// Compiles the text with each possible BigInt literal made invalid. If this fails, the program has a BigInt literal.
// Matches inside strings, comments and regular expressions still compile.
bool check_integers(JSContext* context, std::string_view text) {
  const std::optional<std::string> spoilt = without_integers(text);
  if (!spoilt) return true;
  JS::SourceText<mozilla::Utf8Unit> source;
  if (!source.init(context, spoilt->data(), spoilt->size(), JS::SourceOwnership::Borrowed)) return false;
  if (JS::Compile(context, JS::CompileOptions(context), source)) return true;
  JS_ClearPendingException(context);
  return fail_range(context, "literals of BigInt (such as 1n) are not available in Scripts; use numbers");
}
}  // namespace gs::app::script
