#include "app/script/bounds/bounded_natives.h"
#include "app/script/program_text.h"

#include <js/CompilationAndEvaluation.h>
#include <js/CompileOptions.h>
#include <js/ErrorReport.h>
#include <js/Exception.h>
#include <js/SourceText.h>
#include <js/friend/ErrorMessages.h>

#include <algorithm>
#include <utility>

// Compilation of programs, and conversion of exceptions to diagnostics.
namespace gs::app::script {

namespace {

JSScript* compile(JSContext* context, const JS::CompileOptions& options, const std::string& text) {
  JS::SourceText<mozilla::Utf8Unit> source;
  if (!source.init(context, text.data(), text.size(), JS::SourceOwnership::Borrowed)) return nullptr;
  return JS::Compile(context, options, source);
}

}  // namespace

JSScript* compile_mended(JSContext* context, const std::string& text, const std::string& file, SourceLocation place) {
  JS::CompileOptions options(context);
  options.setFileAndLine(file.c_str(), std::max(1U, place.line));
  options.setColumn(place.column > 0 ? place.column - 1 : 0);
  if (!check_program(context, text)) return nullptr;
  JS::RootedScript made(context, compile(context, options, text));
  if (made) return check_integers(context, text) ? made.get() : nullptr;
  if (!JS_IsExceptionPending(context)) return nullptr;
  JS::AutoSaveExceptionState first(context);
  const std::string mended = mended_text(text);
  made = compile(context, options, mended);
  if (!made) return nullptr;
  first.drop();
  return check_integers(context, mended) ? made.get() : nullptr;
}

/// Clears the pending exception and returns its text and position. Returns nullopt if it has no text.
std::optional<Diagnostic> take_exception(JSContext* context, bool& recursion) {
  JS::ExceptionStack stack(context);
  JS::ErrorReportBuilder builder(context);
  if (!JS::StealPendingExceptionStack(context, &stack) ||
      !builder.init(context, stack, JS::ErrorReportBuilder::NoSideEffects)) {
    JS_ClearPendingException(context);
    return std::nullopt;
  }
  const JSErrorReport* const found = builder.report();
  Diagnostic one{Severity::error, found && found->filename ? found->filename : std::string(), {}, {}};
  if (found) one.location = {found->lineno, found->lineno == 0 ? 0 : std::max(1U, found->column)};
  one.message = builder.toStringResult() ? builder.toStringResult().c_str() : "the program failed";
  constexpr std::size_t kMaxText = 400;
  if (one.message.size() > kMaxText) one.message.resize(kMaxText);
  recursion = found && found->errorNumber == JSMSG_OVER_RECURSED;
  return one;
}

}  // namespace gs::app::script
