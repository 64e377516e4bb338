#include "app/script/program_calls.h"

#include "app/script/natives.h"
#include "app/script/program_text.h"

#include <js/CallAndConstruct.h>
#include <js/CompilationAndEvaluation.h>
#include <js/Exception.h>

#include <utility>

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

ProgramCalls::ProgramCalls(WorldView& view, Engine& engine, bool repeatable)
    : engine_(engine), faults_(engine, view), posted_(view, engine), changed_(engine.context()), clock_(repeatable) {}

void ProgramCalls::prepare(const Order& order) {
  now_ = order.now;
  seconds_ = order.seconds;
  heap_ = order.heap;
  image_pixels_ = order.image_pixels;
}

ProgramCalls::Call::Call(ProgramCalls& calls, Program& program)
    : calls_(calls), program_(program), outer_(std::exchange(calls.running_, &program)) {
  if (!outer_) calls_.clock_.begin_function(calls_.now_);
}

ProgramCalls::Call::~Call() {
  calls_.posted_.send_all(program_);
  calls_.running_ = outer_;
  calls_.engine_.rest();
}

Engine::Turn ProgramCalls::make_turn(const Program& program) {
  return Engine::Turn(engine_, seconds_, heap_, program.facts->late_message);
}

// Runs the promise jobs of a turn. They also run after an exception, as in web browsers, but not after a stop.
void ProgramCalls::run_jobs(Program& program, Engine::Turn& turn) {
  bool good = true;
  while (turn.stop() == Stop::none && turn.run_job(&good))
    if (!good || turn.stop() != Stop::none) faults_.report(program, turn, heap_);
}

void ProgramCalls::call(Program& program, const char* name) {
  run(program, [&] {
    JSContext* const context = engine_.context();
    JS::RootedValue function(context), ignored(context);
    if (!JS_GetProperty(context, program.global, name, &function)) return false;
    if (!function.isObject() || !JS::IsCallable(&function.toObject())) return true;
    return JS_CallFunctionValue(context, program.global, function, JS::HandleValueArray::empty(), &ignored);
  });
}

void ProgramCalls::call_event(Program& program, std::uint32_t interface, const vrml::FieldValue& value, double time) {
  // A copy is needed, because the program may change the original.
  const vrml::FieldValue copy = value;
  run(program, [&] {
    JSContext* const context = engine_.context();
    JS::RootedValue function(context), ignored(context);
    JS::RootedId name(context, program.names[interface]);
    // The name of an exposedField is its value; its handler has another name (contact_text()).
    const vrml::InterfaceDeclaration& declaration = program.interface(interface);
    const bool exposed = declaration.access == vrml::AccessType::exposedField;
    if (!exposed) {
      if (!JS_GetPropertyById(context, program.global, name, &function)) return false;
    } else if (program.language() == vrml::Language::x3d &&
               !JS_GetProperty(context, program.global, ("set_" + declaration.name).c_str(), &function)) {
      return false;
    } else if (function.isObject()) {
      // X3D: set_x() handles the events of the field x of type inputOutput.
    } else if (const std::string handler = std::string(kHandlerPrefix) + declaration.name;
               !JS_GetProperty(context, program.global, handler.c_str(), &function)) {
      return false;
    }
    if (!function.isObject() || !JS::IsCallable(&function.toObject())) return true;
    JS::RootedValueArray<2> arguments(context);
    if (!to_value(context, program.scene(), copy, {}, arguments[0])) return false;
    arguments[1].set(JS::DoubleValue(time));
    return JS_CallFunctionValue(context, program.global, function, JS::HandleValueArray(arguments), &ignored);
  });
}

Report ProgramCalls::evaluate(Program& program, const std::string& line) {
  JSContext* const context = engine_.context();
  Report result;
  const Call call(*this, program);
  Engine::Turn turn = make_turn(program);
  const JSAutoRealm realm(context, program.global);
  // Runs the promise jobs of the line. Returns false if one was stopped.
  const auto run_jobs_of_line = [&] {
    bool good = true;
    while (good && turn.stop() == Stop::none && turn.run_job(&good)) {
    }
    return good && turn.stop() == Stop::none;
  };
  const std::string modern = modern_text_of(program, line);
  JS::RootedScript compiled(context, compile_mended(context, modern, "console", {1, 1}));
  JS::RootedValue value(context);
  const bool good = compiled && JS_ExecuteScript(context, compiled, &value) && run_jobs_of_line() &&
                    changed_.flush(context) && text_of_result(context, value, result.text);
  result.good = good && turn.stop() == Stop::none;
  if (result.good) return result;
  bool recursion = false;
  const bool thrown = turn.stop() == Stop::none && JS_IsExceptionPending(context);
  const std::optional<Diagnostic> said = thrown ? take_exception(context, recursion) : std::nullopt;
  result.text = turn.stop() == Stop::memory ? "it exceeds the memory limit of programs"
                : turn.stop() == Stop::time ? "it exceeded the time limit"
                : said                      ? said->text()
                                            : "it failed";
  JS_ClearPendingException(context);
  if (!run_jobs_of_line() || !changed_.flush(context)) JS_ClearPendingException(context);
  return result;
}

void ProgramCalls::own_changed(Program& program, std::uint32_t place) {
  if (!program.changed[place]) program.to_tell.push_back(place);
  program.changed[place] = true;
  if (program.interface(place).access == vrml::AccessType::field || program.unsent[place]) return;
  program.unsent[place] = true;
  program.to_send.push_back(place);
}

}  // namespace gs::app::script
