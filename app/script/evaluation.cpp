#include "app/script/script_world.h"

#include <js/CompilationAndEvaluation.h>
#include <js/Exception.h>
#include <js/RegExp.h>
#include <jsfriendapi.h>

#include <utility>

// Evaluation of lines that a user types in the console, in the name of a Script.
namespace gs::app::script {
namespace {

constexpr std::size_t kMaxText = 2000;  // max bytes of the text of a value

// Returns the text of a result. A string is put in quotes, as in a program.
bool text_of_result(JSContext* context, JS::HandleValue value, std::string& text) {
  if (value.isSymbol()) return text = "a symbol", true;
  if (!text_of_value(context, value, text)) return false;
  if (text.size() > kMaxText) text = text.substr(0, kMaxText) + "...";
  if (value.isString()) text = '"' + text + '"';
  return true;
}

}  // namespace

ScriptRunner::Evaluation World::evaluate(const vrml::SceneGraph& scene, vrml::NodeId script, const std::string& line) {
  const auto no = [](std::string why) { return Evaluation{std::move(why), true}; };
  const vrml::EventNode node = execution_.scenes().event_node(scene, script);
  Program* const program = node == 0 ? nullptr : program_of(node);
  if (!program) return no("not a Script, or its program has not started");
  if (program->waits) return no("the program of this Script is still loading");
  if (program->off) return no("the program of this Script is switched off after three faults");
  if (!program->runs || !program->global) return no("this Script has no running program");
  JSContext* const context = engine_.context();
  const Limits& limits = execution_.scenes().root().limits();
  Evaluation result;
  Program* const outer = std::exchange(running_, program);
  if (!outer) clock_looks_ = 0;
  {
    Engine::Turn turn(engine_, limits.script_seconds, limits.script_heap, program->late_message);
    const JSAutoRealm realm(context, program->global);
    JS::RootedScript compiled(context, compile_mended(context, modern_text_of(*program, line), "console", {1, 1}));
    JS::RootedValue value(context);
    bool good = compiled && JS_ExecuteScript(context, compiled, &value);
    // Runs the promise jobs of the line. Returns false if one was stopped.
    const auto run_jobs_of_line = [&] {
      bool done = true;
      while (done && turn.stop() == Stop::none && turn.run_job(&done)) {
      }
      return done && turn.stop() == Stop::none;
    };
    good = good && run_jobs_of_line() && flush_changed(context) && text_of_result(context, value, result.text);
    if (!good || turn.stop() != Stop::none) {
      result.failed = true;
      bool recursion = false;
      const bool thrown = turn.stop() == Stop::none && JS_IsExceptionPending(context);
      const std::optional<Diagnostic> said = thrown ? take_exception(context, recursion) : std::nullopt;
      result.text = turn.stop() == Stop::memory ? "it exceeds the memory limit of programs"
                    : turn.stop() == Stop::time ? "it exceeded the time limit"
                    : said                      ? said->text()
                                                : "it failed";
      JS_ClearPendingException(context);
      if (!run_jobs_of_line() || !flush_changed(context)) JS_ClearPendingException(context);
    }
  }
  send_all(*program);
  running_ = outer;
  engine_.rest();
  return result;
}

}  // namespace gs::app::script
