#include "app/script/script_world.h"

#include "app/script/bounds/bounded_natives.h"
#include "app/script/bounds/field_memory.h"
#include "app/script/run_time_nodes.h"

#include <js/CallAndConstruct.h>
#include <js/CompilationAndEvaluation.h>
#include <js/CompileOptions.h>
#include <js/Date.h>
#include <js/ErrorReport.h>
#include <js/Exception.h>
#include <js/GCAPI.h>
#include <js/Object.h>
#include <js/Realm.h>
#include <js/RegExp.h>
#include <js/SourceText.h>
#include <js/friend/ErrorMessages.h>
#include <jsfriendapi.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

namespace gs::app::script {
namespace {

constexpr std::size_t kMaxMessages = 1000, kMaxSaid = 4000;
constexpr int kMaxFaults = 3;
constexpr std::size_t kWorthCollecting = 64;               // min nodes to count for one text of nodes
constexpr std::size_t kMaxCreated = std::size_t{4} << 20;  // max bytes of a text of nodes
constexpr std::size_t kTextOfNode = 16;                    // min bytes of text for a node

}  // namespace

namespace {

// Returns the time for Date, in microseconds since 1970: the world's time if results must be repeatable, else `now`.
double date_of(double now, JSContext* context) {
  const JS::Realm* const realm = js::GetContextRealm(context);
  const auto* const library =
      realm ? static_cast<ScriptLibrary*>(JS_GetCompartmentPrivate(js::GetContextCompartment(context))) : nullptr;
  return library && library->world->is_repeatable() ? library->world->date() * 1e6 : now;
}

}  // namespace

World::World(vrml::Execution& execution, Engine& engine, Settings settings)
    : execution_(execution),
      engine_(engine),
      settings_(settings),
      changed_(engine.context(), JS::StackGCVector<JSObject*>(engine.context())) {
  JS::SetReduceMicrosecondTimePrecisionCallback(date_of);
}

World::~World() {
  ends_ = true;
  // Shut down in the order in which the Scripts began (4.12.3).
  std::vector<vrml::EventNode> nodes;
  for (const auto& [node, program] : programs_) nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end());
  for (const vrml::EventNode node : nodes) end(node);
  for (const vrml::EventNode node : nodes) forget(node);
  for (const auto& [key, library] : libraries_) {
    library->link->execution = nullptr;
    if (!library->global) continue;
    const JSAutoRealm realm(engine_.context(), library->global);
    JS_SetCompartmentPrivate(js::GetContextCompartment(engine_.context()), nullptr);
  }
}

Program* World::program_of(vrml::EventNode node) const {
  const auto found = programs_.find(node);
  return found == programs_.end() ? nullptr : found->second.get();
}

// Compiles and runs the text of a program. `place` is the position of the text in its file, for messages.
bool World::load(Program& program, std::string_view text, const std::string& file, SourceLocation place) {
  JSContext* const context = engine_.context();
  bool good = false;
  run(program, [&] {
    const std::string modern = modern_text_of(program, text);
    program.undeclared = UndeclaredNames(modern);
    JS::RootedScript script(context, compile_mended(context, modern, file, place));
    JS::RootedValue ignored(context);
    if (!script) return false;
    good = true;
    return JS_ExecuteScript(context, script, &ignored);
  });
  return good;
}

template <class Do>
void World::run(Program& program, const Do& what) {
  if (program.off || !program.global) return;
  const auto began = std::chrono::steady_clock::now();
  JSContext* const context = engine_.context();
  Program* const outer = std::exchange(running_, &program);
  if (!outer) clock_looks_ = 0;
  const Limits& limits = execution_.scenes().root().limits();
  {
    Engine::Turn turn(engine_, limits.script_seconds, limits.script_heap, program.late_message);
    const JSAutoRealm realm(context, program.global);
    if (!what() || turn.stop() != Stop::none) report_failure(program, turn);
    run_jobs(program, turn);
    if (!flush_changed(context)) JS_ClearPendingException(context);
  }
  send_all(program);
  running_ = outer;
  engine_.rest();
  const auto took = std::chrono::steady_clock::now() - began;
  spent_ += took;
  if (took > longest_) {
    longest_ = took;
    slowest_ = program.node;
  }
}

// Runs the promise jobs of a turn. They also run after an exception, as in web browsers, but not after a stop.
void World::run_jobs(Program& program, Engine::Turn& turn) {
  bool good = true;
  while (turn.stop() == Stop::none && turn.run_job(&good))
    if (!good || turn.stop() != Stop::none) report_failure(program, turn);
}

void World::report_failure(Program& program, const Engine::Turn& turn) {
  JSContext* const context = engine_.context();
  if (turn.stop() == Stop::none && JS_IsExceptionPending(context)) {
    report_exception(program);
  } else if (turn.stop() == Stop::memory) {
    fault(program, "the program exceeds the " + std::to_string(execution_.scenes().root().limits().script_heap >> 20) +
                       " MiB limit for the programs of a world");
  } else {
    fault(program, turn.stop() == Stop::time ? kLate : "the program failed");
  }
  JS_ClearPendingException(context);
}

// Sends the events of eventOuts and nodes to which the function assigned (C.5.2, C.5.3). Called after the function.
void World::send_all(Program& program) {
  std::vector<Post> posts = std::exchange(posts_, {});
  engine_.add_bytes(-static_cast<std::ptrdiff_t>(std::exchange(post_bytes_, 0)));
  last_posts_.clear();
  for (const std::uint32_t place : std::exchange(program.to_send, {})) {
    program.unsent[place] = false;
    if (!ends_) execution_.cascade().send_own(program.node, place);
  }
  if (ends_) return;
  for (Post& post : posts)
    if (execution_.scenes().has(post.scene))
      (void)execution_.cascade().post(*post.scene, post.node, *post.event_in, std::move(post.value));
}

bool World::begin(vrml::EventNode node) {
  // A Script that replaces its own program keeps its number of faults.
  int faults = 0;
  if (const Program* const before = program_of(node)) {
    faults = before->faults;
    end(node);
    forget(node);
  }
  const vrml::NodePlace at = execution_.nodes().place_of(node);
  auto made = std::make_unique<Program>();
  made->world = this;
  made->node = node;
  made->id = at.node;
  made->scene = execution_.scenes().own(*at.scene);
  made->source = text_of_program(*made).source();
  made->faults = faults;
  made->off = faults >= kMaxFaults;
  made->late_message = late_message(*made);
  programs_[node] = std::move(made);
  return go_on(node);
}

bool World::go_on(vrml::EventNode node) {
  Program& program = *programs_.at(node);
  const vrml::Node& script = program.scene->node(program.id);
  const vrml::InterfaceDeclaration* const url = script.type->find_field("url");
  const vrml::MFString urls = url ? std::get<vrml::MFString>(script.values[url->slot]) : vrml::MFString{};
  program.library = library_of_source(program.source);
  if (!program.library) {
    report(Severity::error, program, "not enough memory for programs");
    return false;
  }
  const std::string file =
      url ? program.scene->nodes().text_of(program.id, url->slot).file_name() : script.text->file_name();
  const bool own_places = script.type->url_places.size() == urls.size() && url &&
                          &program.scene->nodes().text_of(program.id, url->slot) == script.text;
  const auto try_one = [&](std::string_view text, const std::string& name, SourceLocation at_place) {
    if (!program.global && !make_global(program)) return false;
    if (!load(program, text, name, at_place)) return false;
    program.runs = true;
    run(program, [&] {
      JSContext* const context = engine_.context();
      JS::RootedValue function(context);
      if (!JS_GetProperty(context, program.global, "eventsProcessed", &function)) return false;
      program.has_processed = function.isObject() && JS::IsCallable(&function.toObject());
      return true;
    });
    call(program, "initialize");
    return true;
  };
  const auto try_text = [&] {
    const auto text = texts_.extract(node);
    program.waits = false;
    return text.mapped().text && try_one(*text.mapped().text, text.mapped().url, {1, 1});
  };
  if (program.waits && try_text()) return true;
  while (program.next_url < urls.size()) {
    const ProgramPlace held = program_place(urls[program.next_url].view());
    if (held.kind == ProgramPlace::Kind::held) {
      SourceLocation at_place = own_places ? script.type->url_places[program.next_url] : script.location;
      const auto before = static_cast<std::uint32_t>(held.text.data() - urls[program.next_url].view().data());
      if (own_places) at_place.column += before + 1;
      ++program.next_url;
      if (try_one(held.text, file, at_place)) return true;
    } else if (held.kind == ProgramPlace::Kind::java) {
      report(Severity::warning, program, "a Java program, which is not run");
      ++program.next_url;
    } else if (held.kind == ProgramPlace::Kind::file) {
      ScriptRequest wanted;
      wanted.kind = ScriptRequest::Kind::program;
      wanted.scene = program.scene;
      wanted.node = program.id;
      wanted.location = script.location;
      wanted.origin = &text_of_program(program).origin();
      wanted.source = program.source;
      wanted.from_scene = program.scene;
      // Request all files up to the next inline program; the loader takes the first one that can be read.
      while (program.next_url < urls.size() &&
             program_place(urls[program.next_url].view()).kind == ProgramPlace::Kind::file)
        wanted.urls.push_back(urls[program.next_url++].str());
      if (texts_.contains(node)) {
        if (try_text()) return true;
        continue;
      }
      program.waits = true;
      requests_.push_back(std::move(wanted));
      return false;
    } else {
      if (!held.text.empty())
        report(Severity::warning, program,
               "a program in '" + std::string(held.text.substr(0, 40)) + "', which is not run");
      ++program.next_url;
    }
  }
  return false;
}

void World::call(Program& program, const char* name) {
  run(program, [&] {
    JSContext* const context = engine_.context();
    JS::RootedValue function(context), ignored(context);
    if (!JS_GetProperty(context, program.global, name, &function)) return false;
    if (!function.isObject() || !JS::IsCallable(&function.toObject())) return true;
    return JS_CallFunctionValue(context, program.global, function, JS::HandleValueArray::empty(), &ignored);
  });
}

bool World::deliver(vrml::EventNode node, std::uint32_t interface, const vrml::FieldValue& value, double time) {
  Program* const program = program_of(node);
  if (!program || !program->runs) return false;
  // A copy is needed, because the program may change the original.
  const vrml::FieldValue copy = value;
  run(*program, [&] {
    JSContext* const context = engine_.context();
    JS::RootedValue function(context), ignored(context);
    JS::RootedId name(context, program->names[interface]);
    // The name of an exposedField is its value; its handler has another name (contact_text()).
    const vrml::InterfaceDeclaration& declaration =
        *execution_.nodes().schema_of(node).interfaces[interface].declaration;
    if (declaration.access != vrml::AccessType::exposedField) {
      if (!JS_GetPropertyById(context, program->global, name, &function)) return false;
    } else if (const std::string handler = std::string(kHandlerPrefix) + declaration.name;
               !JS_GetProperty(context, program->global, handler.c_str(), &function)) {
      return false;
    }
    if (!function.isObject() || !JS::IsCallable(&function.toObject())) return true;
    JS::RootedValueArray<2> arguments(context);
    if (!to_value(context, program->scene, copy, {}, arguments[0])) return false;
    arguments[1].set(JS::DoubleValue(time));
    return JS_CallFunctionValue(context, program->global, function, JS::HandleValueArray(arguments), &ignored);
  });
  return program->has_processed;
}

void World::events_processed(vrml::EventNode node) {
  Program* const program = program_of(node);
  if (program && program->runs) call(*program, "eventsProcessed");
}

void World::end(vrml::EventNode node) {
  Program* const program = program_of(node);
  if (!program || !std::exchange(program->runs, false)) return;
  program->ended = true;
  call(*program, "shutdown");
}

void World::forget(vrml::EventNode node) {
  const auto found = programs_.find(node);
  texts_.erase(node);
  if (found == programs_.end()) return;
  if (Program* const program = found->second.get()) {
    for (const auto& list : program->lists)
      if (list) forget_program_of_list(*list_of(*list));
    if (program->global) forget_program(program->global);
    for (const std::size_t bytes : program->counted) engine_.add_bytes(-static_cast<std::ptrdiff_t>(bytes));
  }
  programs_.erase(found);
}

bool World::waits(vrml::EventNode node) const {
  const Program* const program = program_of(node);
  return !program || program->waits;
}

bool World::has_time() {
  if (settings_.step_seconds <= 0) return true;
  const bool has = spent_ < std::chrono::duration<double>(settings_.step_seconds);
  late_ = late_ || !has;
  return has;
}

void World::begin_step() {
  if (const Program* const slowest = late_ ? program_of(slowest_) : nullptr)
    report(Severity::warning, *slowest,
           "used the time for programs in this step; remaining events wait for the next step");
  spent_ = longest_ = {};
  late_ = false;
}

void World::found(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
                  const std::string& url) {
  const vrml::EventNode node = execution_.scenes().event_node(scene, script);
  Program* const program = node == 0 ? nullptr : program_of(node);
  if (!program || !program->waits) return;
  texts_[node] = {std::move(text), url};
  (void)go_on(node);
  execution_.scripts().program_came(scene, script);
}

void World::provide(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
                    const std::string& url) {
  if (const vrml::EventNode node = execution_.scenes().event_node(scene, script)) texts_[node] = {std::move(text), url};
}

// ---- Assignments by programs

void World::own_changed(Program& program, std::uint32_t place) {
  const auto& interface = execution_.nodes().schema_of(program.node).interfaces[place];
  execution_.cascade().own_value_changed(program.node, place);
  if (interface.declaration->access == vrml::AccessType::field || program.unsent[place]) return;
  program.unsent[place] = true;
  program.to_send.push_back(place);
}

bool World::post(JSContext* context, vrml::SceneGraph& scene, vrml::NodeId node,
                 const vrml::InterfaceDeclaration& event_in, vrml::FieldValue value) {
  if (!running_->told_direct) {
    running_->told_direct = true;
    const vrml::Node& script = running_->scene->node(running_->id);
    const vrml::InterfaceDeclaration* const direct = script.type->find_field("directOutput");
    if (direct && !std::get<vrml::SFBool>(script.values[direct->slot]))
      report(Severity::warning, *running_, "writes to other nodes with directOutput FALSE (VRML97 4.12.5)");
  }
  const std::size_t bytes = bytes_of(value);
  if (!engine_.may_have(bytes)) {
    JS_ReportOutOfMemory(context);
    return false;
  }
  const auto count = [&](std::size_t replaced) {
    post_bytes_ += bytes - replaced;
    engine_.add_bytes(static_cast<std::ptrdiff_t>(bytes) - static_cast<std::ptrdiff_t>(replaced));
  };
  // Only the last value for an eventIn is sent (C.5.2). But events that add or remove children are all sent.
  const bool each = event_in.access == vrml::AccessType::eventIn && event_in.type == vrml::FieldType::MFNode;
  const PostKey key{{scene.serial(), node}, &event_in};
  if (!each)
    if (const auto known = last_posts_.find(key); known != last_posts_.end()) {
      count(bytes_of(posts_[known->second].value));
      posts_[known->second].value = std::move(value);
      return true;
    }
  if (!each) last_posts_[key] = posts_.size();
  posts_.push_back({&scene, node, &event_in, std::move(value)});
  count(0);
  return true;
}

const vrml::FieldValue* World::posted(const vrml::SceneGraph& scene, vrml::NodeId node,
                                      const vrml::InterfaceDeclaration& event_in) const {
  const auto known = last_posts_.find(PostKey{{scene.serial(), node}, &event_in});
  return known == last_posts_.end() ? nullptr : &posts_[known->second].value;
}

bool World::note_changed(JSContext* context, JS::HandleObject list) {
  if (changed_.get().append(list)) return true;
  JS_ReportOutOfMemory(context);
  return false;
}

bool World::flush_changed(JSContext* context) {
  bool good = true;
  for (std::size_t i = 0; i < changed_.get().length(); ++i) {
    JS::RootedObject list(context, changed_.get()[i]);
    const JSAutoRealm realm(context, list);  // the list may belong to another library than this turn
    good = flush_list(context, list) && good;
  }
  changed_.get().clear();
  return good;
}

bool World::create_from_string(JSContext* context, std::string_view text, vrml::MFNode& nodes,
                               vrml::SceneGraph*& scene) {
  scene = running_->scene;
  if (text.size() > kMaxCreated)
    return fail_range(context, "a text of " + std::to_string(text.size()) + " bytes is too long to create nodes from");
  if (ends_ || running_->ended) return fail(context, "shutdown() cannot create nodes");
  Diagnostics diagnostics;
  vrml::RunTimeNodes made =
      make_nodes(execution_, *scene, label(*running_), text, diagnostics, &text_of_program(*running_));
  for (const Diagnostic& one : diagnostics.entries())
    if (said_.size() < kMaxSaid && said_.insert(one.text()).second) tell({one, false});
  if (made.outcome == vrml::ParseOutcome::refused) return fail(context, "not VRML97 text");
  engine_.note_nodes(std::max({kWorthCollecting, made.roots.size(), text.size() / kTextOfNode}));
  nodes = std::move(made.roots);
  // Make an object for each node now. The object holds the node, so that garbage collection cannot remove it.
  for (const vrml::NodeId id : nodes)
    if (!object_of_node(context, *scene, id)) return false;
  return true;
}

// ---- Messages

std::string World::label(const Program& program) const {
  const vrml::Node& node = program.scene->node(program.id);
  return node.name.empty() ? std::string("Script") : "Script " + std::string(node.name);
}

void World::report(Severity severity, const Program& program, std::string message, std::optional<Diagnostic> at) {
  const vrml::Node& node = program.scene->node(program.id);
  Diagnostic one = at.value_or(Diagnostic{severity, node.text->file_name(), node.location, {}});
  one.severity = severity;
  one.message = label(program) + ": " + std::move(message);
  if (said_.size() < kMaxSaid && said_.insert(one.text()).second) tell({std::move(one), false});
}

void World::tell(ScriptMessage message) {
  if (observer_) return observer_(message);
  if (messages_.size() < kMaxMessages) messages_.push_back(std::move(message));
}

void World::fault(Program& program, const std::string& why, std::optional<Diagnostic> at) {
  const bool last = ++program.faults >= kMaxFaults;
  report(Severity::error, program,
         why + (last ? "; this third fault switches the program off"
                     : " (fault " + std::to_string(program.faults) + " of " + std::to_string(kMaxFaults) + ")"),
         std::move(at));
  program.off = last;
}

void World::report_exception(Program& program) {
  const bool no_memory = JS_IsThrowingOutOfMemory(engine_.context());
  bool recursion = false;
  std::optional<Diagnostic> at = take_exception(engine_.context(), recursion);
  if (no_memory) return fault(program, "the program exceeds the memory limit");
  if (!at) return fault(program, "the program failed");
  const vrml::Node& node = program.scene->node(program.id);
  if (at->file.empty()) at->file = node.text->file_name();
  if (at->location.line == 0) at->location = node.location;
  std::string text = std::move(at->message);
  if (recursion) return fault(program, text, std::move(at));
  report(Severity::error, program, std::move(text), std::move(at));
}

}  // namespace gs::app::script

namespace gs::app {

std::unique_ptr<ScriptRunner> ScriptRunner::make(vrml::Execution& execution, Settings settings) {
  script::Engine* const engine = script::Engine::of_this_thread();
  if (!engine) return nullptr;
  return std::make_unique<script::World>(execution, *engine, settings);
}

void ScriptRunner::on_overdue(std::function<void(const std::string&)> observer) {
  script::Engine::on_overdue(std::move(observer));
}

}  // namespace gs::app
