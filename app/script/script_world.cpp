#include "app/script/script_world.h"

#include "app/script/natives.h"
#include "app/script/program_text.h"
#include "vrml/scene/values/field_numbers.h"

#include <js/CallAndConstruct.h>
#include <js/CompilationAndEvaluation.h>
#include <js/CompileOptions.h>
#include <js/Date.h>
#include <js/Realm.h>
#include <js/SourceText.h>
#include <jsfriendapi.h>

#include <chrono>
#include <utility>

namespace gs::app::script {
namespace {

// Returns the time for Date, in microseconds since 1970: the world's time if results must be repeatable, else `now`.
double date_of(double now, JSContext* context) {
  const JS::Realm* const realm = js::GetContextRealm(context);
  const auto* const library =
      realm ? static_cast<ScriptLibrary*>(JS_GetCompartmentPrivate(js::GetContextCompartment(context))) : nullptr;
  return library && library->world->calls().clock().is_repeatable() ? library->world->calls().clock().date() * 1e6
                                                                    : now;
}

bool is_object(vrml::FieldType type) {
  return vrml::is_multiple(type) || vrml::number_count(type) > 1 || type == vrml::FieldType::SFImage;
}

}  // namespace

std::string modern_text_of(const Program& program, std::string_view text) {
  std::vector<std::string> values, exposed;
  for (const vrml::InterfaceDeclaration& declaration : program.facts->type->interfaces) {
    if (declaration.access != vrml::AccessType::eventIn && is_object(declaration.type))
      values.push_back(declaration.name);
    if (declaration.access == vrml::AccessType::exposedField) exposed.push_back(declaration.name);
  }
  return contact_text(modern_text(text, values), exposed, is_browser_method);
}

World::World(WorldAccess& world, Engine& engine, bool repeatable)
    : engine_(engine),
      view_(world),
      calls_(view_, engine, repeatable),
      libraries_(*this, view_, engine),
      checked_(engine.context()) {
  JS::SetReduceMicrosecondTimePrecisionCallback(date_of);
}

World::~World() {
  while (!programs_.empty()) forget(programs_.begin()->first);
}

Program* World::program_of(vrml::EventNode node) const {
  const auto found = programs_.find(node);
  return found == programs_.end() ? nullptr : found->second.get();
}

Report World::run(const Order& order) {
  const auto began = std::chrono::steady_clock::now();
  Report report = obey(order);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  return report;
}

Report World::obey(const Order& order) {
  view_.begin_function(order.gone);
  calls_.prepare(order);
  if (order.kind == Order::Kind::check) return check(order);
  if (order.kind == Order::Kind::start) return start(order);
  Program* const program = program_of(order.program);
  Report report;
  if (!program) return report;
  for (const auto& [place, value] : order.values)
    if (place < program->values.size()) program->values[place] = value;
  switch (order.kind) {
    case Order::Kind::event:
      if (program->runs && order.place < program->names.size())
        calls_.call_event(*program, order.place, order.value, order.time);
      break;
    case Order::Kind::call:
      if (program->runs) calls_.call(*program, order.text.c_str());
      break;
    case Order::Kind::end:
      if (std::exchange(program->runs, false)) calls_.call(*program, "shutdown");
      break;
    case Order::Kind::evaluate:
      if (program->runs && program->global) report = calls_.evaluate(*program, order.text);
      break;
    default:
      forget(order.program);
      return report;
  }
  report.runs = program->runs;
  report.off = program->off;
  report.has_processed = program->has_processed;
  report.has_prepare = program->has_prepare;
  report.faults = program->faults;
  return report;
}

// ---- Start of programs

Program& World::program_for(const Order& order) {
  auto& program = programs_[order.program];
  if (program) return *program;
  program = std::make_unique<Program>();
  program->world = this;
  program->node = order.program;
  program->serial = ++last_serial_;
  program->facts = order.facts;
  program->faults = order.facts->faults;
  program->off = program->faults >= kMaxFaults;
  const std::size_t places = order.facts->type->interfaces.size();
  program->values.resize(places);
  program->changed.resize(places);
  for (std::size_t i = 0; i < places; ++i)
    program->values[i] = vrml::initial_value(order.facts->type->interfaces[i].type);
  return *program;
}

Report World::start(const Order& order) {
  Report report;
  if (!order.facts || !order.facts->type) return report;
  Program& program = program_for(order);
  for (const auto& [place, value] : order.values)
    if (place < program.values.size()) program.values[place] = value;
  program.library = libraries_.of(*program.facts);
  report.no_memory = !program.library;
  report.good = program.library && start_text(program, order);
  report.runs = program.runs;
  report.off = program.off;
  report.has_processed = program.has_processed;
  report.has_prepare = program.has_prepare;
  report.faults = program.faults;
  return report;
}

bool World::load(Program& program, const Order& order) {
  JSContext* const context = engine_.context();
  bool good = false;
  calls_.run(program, [&] {
    const std::string modern = modern_text_of(program, order.text);
    program.undeclared = UndeclaredNames(modern);
    JS::RootedScript script(context, compile_mended(context, modern, order.file, order.at));
    JS::RootedValue ignored(context);
    if (!script) return false;
    good = true;
    return JS_ExecuteScript(context, script, &ignored);
  });
  return good;
}

bool World::start_text(Program& program, const Order& order) {
  JSContext* const context = engine_.context();
  if (!program.global && !make_global(context, program, calls_.clock().is_repeatable())) return false;
  if (!load(program, order)) return false;
  program.runs = true;
  calls_.run(program, [&] {
    JS::RootedValue function(context);
    if (!JS_GetProperty(context, program.global, "eventsProcessed", &function)) return false;
    program.has_processed = function.isObject() && JS::IsCallable(&function.toObject());
    if (program.language() != vrml::Language::x3d) return true;
    if (!JS_GetProperty(context, program.global, "prepareEvents", &function)) return false;
    program.has_prepare = function.isObject() && JS::IsCallable(&function.toObject());
    return true;
  });
  return true;
}

void World::forget(vrml::EventNode node) {
  const auto found = programs_.find(node);
  if (found == programs_.end()) return;
  if (Program* const program = found->second.get()) {
    for (const auto& list : program->lists)
      if (list) forget_program_of_list(*list_of(*list));
    if (program->global) forget_program(program->global);
    for (const std::size_t bytes : program->counted) engine_.add_bytes(-static_cast<std::ptrdiff_t>(bytes));
  }
  programs_.erase(found);
}

Report World::check(const Order& order) {
  JSContext* const context = engine_.context();
  Report report;
  if (!checked_) checked_ = new_global(context, nullptr, nullptr);
  report.no_memory = !checked_;
  if (!checked_) return report;
  const JSAutoRealm realm(context, checked_);
  report.good = compile_mended(context, order.text, order.file, order.at) != nullptr;
  if (report.good) return report;
  bool recursion = false;
  report.problem = take_exception(context, recursion);
  if (!report.problem)
    report.problem = Diagnostic{Severity::error, order.file, order.at, "the program cannot be compiled"};
  return report;
}

// Lets the engine and the C library read the time zone, because a confined process cannot read its file.
static void read_time_zone(JSContext* context) {
  JS::RootedObject global(context, new_global(context, nullptr, nullptr));
  if (!global) return JS_ClearPendingException(context);
  const JSAutoRealm realm(context, global);
  JS::CompileOptions options(context);
  JS::SourceText<mozilla::Utf8Unit> source;
  JS::RootedValue ignored(context);
  constexpr std::string_view kText = "new Date(0).toString() + new Date().getHours()";
  if (!source.init(context, kText.data(), kText.size(), JS::SourceOwnership::Borrowed) ||
      !JS::Evaluate(context, options, source, &ignored))
    JS_ClearPendingException(context);
}

std::unique_ptr<ProgramHost> make_programs(WorldAccess& world, bool repeatable) {
  Engine* const engine = Engine::of_this_thread();
  if (!engine) return nullptr;
  static thread_local const bool knows_time_zone = (read_time_zone(engine->context()), true);
  (void)knows_time_zone;
  return std::make_unique<World>(world, *engine, repeatable);
}

}  // namespace gs::app::script
