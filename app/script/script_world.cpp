#include "app/script/script_world.h"

#include "app/script/natives.h"

#include <js/Date.h>
#include <js/Realm.h>
#include <jsfriendapi.h>

#include <algorithm>
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

}  // namespace

World::World(vrml::Execution& execution, Engine& engine, Settings settings)
    : execution_(execution),
      engine_(engine),
      reads_(messages_),
      calls_(execution, engine, settings, messages_),
      libraries_(*this, execution, engine),
      loader_(execution, engine, libraries_, calls_, messages_, requests_) {
  JS::SetReduceMicrosecondTimePrecisionCallback(date_of);
}

World::~World() {
  calls_.begin_end();
  // Shut down in the order in which the Scripts began (4.12.3).
  std::vector<vrml::EventNode> nodes;
  for (const auto& [node, program] : programs_) nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end());
  for (const vrml::EventNode node : nodes) end(node);
  for (const vrml::EventNode node : nodes) forget(node);
}

Program* World::program_of(vrml::EventNode node) const {
  const auto found = programs_.find(node);
  return found == programs_.end() ? nullptr : found->second.get();
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
  made->language = text_of_program(*made).language();
  made->source = text_of_program(*made).source();
  made->faults = faults;
  made->off = faults >= ProgramFaults::kMax;
  made->late_message = late_message_of(*made);
  programs_[node] = std::move(made);
  return loader_.start(*programs_[node]);
}

bool World::deliver(vrml::EventNode node, std::uint32_t interface, const vrml::FieldValue& value, double time) {
  Program* const program = program_of(node);
  if (!program || !program->runs) return false;
  calls_.call_event(*program, interface, value, time);
  return program->has_processed;
}

void World::events_processed(vrml::EventNode node) {
  Program* const program = program_of(node);
  if (program && program->runs) calls_.call(*program, "eventsProcessed");
}

void World::prepare_events() {
  // prepareEvents() may add Scripts, but it begins none.
  std::vector<vrml::EventNode> nodes;
  for (const auto& [node, program] : programs_)
    if (program->runs && program->has_prepare && !program->off) nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end());
  for (const vrml::EventNode node : nodes)
    if (Program* const program = program_of(node); program && program->runs && calls_.time().has_time())
      calls_.call(*program, "prepareEvents");
}

bool World::prepares_events() const {
  return std::any_of(programs_.begin(), programs_.end(),
                     [](const auto& one) { return one.second->runs && one.second->has_prepare && !one.second->off; });
}

void World::end(vrml::EventNode node) {
  Program* const program = program_of(node);
  if (!program || !std::exchange(program->runs, false)) return;
  program->ended = true;
  calls_.call(*program, "shutdown");
}

void World::forget(vrml::EventNode node) {
  const auto found = programs_.find(node);
  loader_.forget(node);
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

void World::begin_step() {
  if (const vrml::EventNode slowest = calls_.time().begin(); slowest != 0)
    if (const Program* const program = program_of(slowest))
      messages_.report(Severity::warning, *program,
                       "used the time for programs in this step; remaining events wait for the next step");
}

void World::found(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
                  const std::string& url) {
  const vrml::EventNode node = execution_.scenes().event_node(scene, script);
  Program* const program = node == 0 ? nullptr : program_of(node);
  if (!program || !program->waits) return;
  loader_.provide(node, std::move(text), url);
  (void)loader_.start(*program);
  execution_.scripts().program_came(scene, script);
}

void World::provide(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
                    const std::string& url) {
  if (const vrml::EventNode node = execution_.scenes().event_node(scene, script))
    loader_.provide(node, std::move(text), url);
}

ScriptRunner::Evaluation World::evaluate(const vrml::SceneGraph& scene, vrml::NodeId script, const std::string& line) {
  const auto no = [](std::string why) { return Evaluation{std::move(why), true}; };
  const vrml::EventNode node = execution_.scenes().event_node(scene, script);
  Program* const program = node == 0 ? nullptr : program_of(node);
  if (!program) return no("not a Script, or its program has not started");
  if (program->waits) return no("the program of this Script is still loading");
  if (program->off) return no("the program of this Script is switched off after three faults");
  if (!program->runs || !program->global) return no("this Script has no running program");
  return calls_.evaluate(*program, line);
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
