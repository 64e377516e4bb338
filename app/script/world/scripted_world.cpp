#include "app/script/world/scripted_world.h"

#include "app/base/text_source.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

namespace gs::app::script {
namespace {

// Reports whether two values are equal without comparing the elements of arrays: equal arrays share their storage.
bool is_known(const vrml::FieldValue& a, const vrml::FieldValue& b) {
  return a.index() == b.index() && std::visit(
                                       [&](const auto& one) {
                                         using T = std::decay_t<decltype(one)>;
                                         const T& other = *std::get_if<T>(&b);
                                         if constexpr (requires { one.shares_with(other); })
                                           return one.shares_with(other);
                                         else
                                           return one == other;
                                       },
                                       a);
}

// Value of ScriptCall::interface for prepareEvents() of X3D programs.
constexpr std::uint32_t kPrepare = vrml::ScriptCall::kProcessed - 1;

// Reports whether a program mentions methods that change ROUTEs or add nodes. A program that hides their names is known
// after its first such call (WorldAnswers).
bool mentions_acts(std::string_view text) {
  constexpr std::array<std::string_view, 4> kActs = {"Route", "create", "rootNodes", "eval"};
  return std::ranges::any_of(kActs, [&](std::string_view act) { return text.find(act) != std::string_view::npos; });
}

Order order_of(const vrml::ScriptCall& call) {
  const bool is_event = call.interface < kPrepare;
  Order order{is_event ? Order::Kind::event : Order::Kind::call};
  if (!is_event) return order.text = call.interface == kPrepare ? "prepareEvents" : "eventsProcessed", order;
  order.place = call.interface;
  order.value = call.value;
  order.time = call.time;
  return order;
}

}  // namespace

ScriptedWorld::ScriptedWorld(vrml::Execution& execution, Settings settings)
    : execution_(execution),
      reads_(messages_),
      answers_(execution, messages_, requests_, reads_),
      time_(settings.step_seconds),
      loader_(*this, messages_, requests_) {}

ScriptedWorld::~ScriptedWorld() {
  answers_.begin_end();
  // Shut down in the order in which the Scripts began (4.12.3).
  std::vector<vrml::EventNode> nodes;
  for (const auto& [node, script] : scripts_) nodes.push_back(node);
  std::sort(nodes.begin(), nodes.end());
  for (const vrml::EventNode node : nodes) end(node);
}

ScriptRecord* ScriptedWorld::record_of(vrml::EventNode node) const {
  const auto found = scripts_.find(node);
  return found == scripts_.end() ? nullptr : found->second.get();
}

// ---- Orders

void ScriptedWorld::add_values(ScriptRecord& script, Order& order) {
  const auto& interfaces = execution_.nodes().schema_of(script.node).interfaces;
  const bool all = script.known.empty();
  if (all) script.known.resize(interfaces.size());
  for (std::uint32_t place = 0; place < interfaces.size(); ++place) {
    if (interfaces[place].slot < 0 && interfaces[place].out < 0) continue;
    const vrml::FieldValue& value = execution_.nodes().own_value(script.node, place);
    if (!all && is_known(script.known[place], value)) continue;
    script.known[place] = value;
    order.values.emplace_back(place, value);
  }
}

// Notes that the program did not receive the values of an order.
void ScriptedWorld::forget_values(const Order& order) {
  ScriptRecord* const script = record_of(order.program);
  if (!script) return;
  for (const auto& [place, value] : order.values) {
    // A value of another type differs from each value of the field.
    vrml::FieldValue other;
    if (value.index() == other.index()) other = vrml::MFNode{};
    if (place < script->known.size()) script->known[place] = other;
  }
}

void ScriptedWorld::complete(ScriptRecord& script, Order& order) {
  const Limits& limits = execution_.scenes().root().limits();
  order.program = script.node;
  order.now = execution_.now();
  order.seconds = limits.script_seconds;
  order.heap = limits.script_heap;
  order.image_pixels = limits.image_pixels;
  order.gone = answers_.take_gone();
  add_values(script, order);
}

Report ScriptedWorld::run(ScriptRecord& script, Order order) {
  complete(script, order);
  const auto began = std::chrono::steady_clock::now();
  answers_.set_running(&script);
  const bool counts = order.kind != Order::Kind::evaluate;
  const Report report = host_->run(order);
  answers_.set_running(nullptr);
  if (counts) time_.add(script.node, std::chrono::steady_clock::now() - began);
  note(script, report);
  note_stop(script);
  return report;
}

void ScriptedWorld::note(ScriptRecord& script, const Report& report) {
  script.runs = report.runs;
  script.off = report.off;
  script.has_processed = report.has_processed;
  script.has_prepare = report.has_prepare;
  script.faults = report.faults;
}

void ScriptedWorld::note_stop(const ScriptRecord& script) {
  if (!stopped_.empty() || (stopped_ = host_->stopped()).empty()) return;
  messages_.report(
      Severity::error, script,
      stopped_ + (stopped_ == kLateProgram ? " and cannot be interrupted" : "") + "; all programs of this world end");
  for (const auto& [node, one] : scripts_) one->runs = one->waits = one->has_prepare = one->has_processed = false;
  answers_.release_all();
}

void ScriptedWorld::call(ScriptRecord& script, const char* function) {
  if (script.off) return;
  Order order{Order::Kind::call};
  order.text = function;
  (void)run(script, std::move(order));
}

bool ScriptedWorld::start_text(ScriptRecord& script, std::string_view text, const std::string& file,
                               SourceLocation place) {
  auto facts = std::make_shared<ProgramFacts>();
  facts->node = answers_.ref(*script.scene, script.id);
  facts->type = pointer_to(*script.scene->node(script.id).type);
  facts->language = script.language;
  facts->library = library_key(origin_of(script.source));
  facts->late_message = late_message_of(script);
  facts->faults = script.faults;
  Order order{Order::Kind::start};
  order.facts = std::move(facts);
  order.text = text;
  order.file = file;
  order.at = place;
  if (!stopped_.empty()) return false;
  script.acts_at_once = script.acts_at_once || mentions_acts(text);
  const Report report = run(script, std::move(order));
  if (report.no_memory) messages_.report(Severity::error, script, "not enough memory for programs");
  if (report.good) call(script, "initialize");
  return report.good;
}

// ---- Calls of the Execution

bool ScriptedWorld::begin(vrml::EventNode node) {
  // A Script that replaces its own program keeps its number of faults.
  int faults = 0;
  if (const ScriptRecord* const before = record_of(node)) {
    faults = before->faults;
    end(node);
    forget(node);
  }
  const vrml::NodePlace at = execution_.nodes().place_of(node);
  auto made = std::make_unique<ScriptRecord>();
  made->node = node;
  made->id = at.node;
  made->scene = execution_.scenes().own(*at.scene);
  made->language = text_of_program(*made).language();
  made->source = text_of_program(*made).source();
  made->faults = faults;
  made->off = faults >= kMaxFaults;
  ScriptRecord& script = *(scripts_[node] = std::move(made));
  return stopped_.empty() && loader_.start(script);
}

bool ScriptedWorld::deliver(vrml::EventNode node, std::uint32_t interface, const vrml::FieldValue& value, double time) {
  ScriptRecord* const script = record_of(node);
  if (!script || !script->runs) return false;
  if (script->off) return script->has_processed;
  (void)run(*script, order_of({node, interface, value, time}));
  return script->has_processed;
}

void ScriptedWorld::events_processed(vrml::EventNode node) {
  ScriptRecord* const script = record_of(node);
  if (script && script->runs) call(*script, "eventsProcessed");
}

// ---- Calls together

bool ScriptedWorld::may_wait(vrml::EventNode node) const {
  const ScriptRecord* const script = record_of(node);
  return script && !script->acts_at_once;
}

bool ScriptedWorld::makes_call(vrml::EventNode node) const {
  const ScriptRecord* const script = record_of(node);
  return script && script->runs && !script->off;
}

std::size_t ScriptedWorld::make_calls(std::span<const vrml::ScriptCall> calls, const Made& made) {
  std::size_t done = 0;
  while (done < calls.size() &&
         (done == 0 || calls[done].interface == vrml::ScriptCall::kProcessed || time_.has_time()))
    done += make_together(calls.subspan(done), made);
  return done;
}

std::size_t ScriptedWorld::make_together(std::span<const vrml::ScriptCall> calls, const Made& made) {
  std::vector<Order> orders;
  std::vector<std::size_t> ends;  // for each order: number of the calls before and with it
  for (std::size_t i = 0; i < calls.size(); ++i) {
    if (!makes_call(calls[i].script)) continue;
    orders.push_back(order_of(calls[i]));
    complete(*record_of(calls[i].script), orders.back());
    ends.push_back(i + 1);
  }
  std::size_t done = 0, reported = 0;
  const auto finish = [&](std::size_t end) {
    for (; done < end; ++done) {
      const ScriptRecord* const script = record_of(calls[done].script);
      made(calls[done], script && script->runs && script->has_processed);
    }
  };
  using Duration = StepTime::Duration;
  const auto began = std::chrono::steady_clock::now();
  Duration added{};
  const auto run_next = [&] {
    answers_.set_running(reported < orders.size() ? record_of(orders[reported].program) : nullptr);
  };
  run_next();
  if (!orders.empty())
    host_->run_all(orders, [&](const Report& report) {
      const std::size_t one = reported++;
      // The process of the programs may be hostile, so its times cannot exceed the real one.
      const Duration left = std::chrono::steady_clock::now() - began - added;
      const double most = std::chrono::duration<double>(left).count();
      const Duration took =
          !(report.seconds < most)
              ? left
              : std::chrono::duration_cast<Duration>(std::chrono::duration<double>(std::max(0.0, report.seconds)));
      added += took;
      time_.add(orders[one].program, took);
      if (ScriptRecord* const script = record_of(orders[one].program)) note(*script, report);
      finish(ends[one]);
      run_next();
      return reported == orders.size() || calls[ends[one]].interface == vrml::ScriptCall::kProcessed ||
             time_.has_time();
    });
  answers_.set_running(nullptr);
  time_.add(std::chrono::steady_clock::now() - began - added);
  const bool stops = !host_->stopped().empty();
  if (stops && !orders.empty())
    if (const ScriptRecord* const last =
            record_of(orders[std::min(reported + host_->unreported(), orders.size() - 1)].program))
      note_stop(*last);
  for (std::size_t i = reported; i < orders.size(); ++i) forget_values(orders[i]);
  if (stops || reported == 0 || reported == orders.size()) finish(calls.size());
  return done;
}

void ScriptedWorld::prepare_events() {
  // prepareEvents() may add Scripts, but it begins none.
  std::vector<vrml::ScriptCall> calls;
  for (const auto& [node, script] : scripts_)
    if (script->runs && script->has_prepare && !script->off) calls.push_back({node, kPrepare});
  std::ranges::sort(calls, {}, &vrml::ScriptCall::script);
  if (!calls.empty() && time_.has_time()) (void)make_calls(calls, [](const vrml::ScriptCall&, bool) {});
}

bool ScriptedWorld::prepares_events() const {
  return std::any_of(scripts_.begin(), scripts_.end(),
                     [](const auto& one) { return one.second->runs && one.second->has_prepare && !one.second->off; });
}

void ScriptedWorld::end(vrml::EventNode node) {
  ScriptRecord* const script = record_of(node);
  if (!script || !std::exchange(script->runs, false)) return;
  script->ended = true;
  if (stopped_.empty()) (void)run(*script, {Order::Kind::end});
}

void ScriptedWorld::forget(vrml::EventNode node) {
  loader_.forget(node);
  const auto found = scripts_.find(node);
  if (found == scripts_.end()) return;
  Order order{Order::Kind::forget};
  order.program = node;
  order.gone = answers_.take_gone();
  if (stopped_.empty() && !found->second->known.empty()) (void)host_->run(order);
  scripts_.erase(found);
}

bool ScriptedWorld::waits(vrml::EventNode node) const {
  const ScriptRecord* const script = record_of(node);
  return !script || script->waits;
}

void ScriptedWorld::begin_step() {
  if (const vrml::EventNode slowest = time_.begin(); slowest != 0)
    if (const ScriptRecord* const script = record_of(slowest))
      messages_.report(Severity::warning, *script,
                       "used the time for programs in this step; remaining events wait for the next step");
}

void ScriptedWorld::found(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
                          const std::string& url) {
  const vrml::EventNode node = execution_.scenes().event_node(scene, script);
  ScriptRecord* const record = node == 0 ? nullptr : record_of(node);
  if (!record || !record->waits) return;
  loader_.provide(node, std::move(text), url);
  (void)loader_.start(*record);
  execution_.scripts().program_came(scene, script);
}

void ScriptedWorld::provide(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
                            const std::string& url) {
  if (const vrml::EventNode node = execution_.scenes().event_node(scene, script))
    loader_.provide(node, std::move(text), url);
}

ScriptRunner::Evaluation ScriptedWorld::evaluate(const vrml::SceneGraph& scene, vrml::NodeId script,
                                                 const std::string& line) {
  const auto no = [](std::string why) { return Evaluation{std::move(why), true}; };
  const vrml::EventNode node = execution_.scenes().event_node(scene, script);
  ScriptRecord* const record = node == 0 ? nullptr : record_of(node);
  if (!record) return no("not a Script, or its program has not started");
  if (!stopped_.empty()) return no("the programs of this world have ended: " + stopped_);
  if (record->waits) return no("the program of this Script is still loading");
  if (record->off) return no("the program of this Script is switched off after three faults");
  if (!record->runs) return no("this Script has no running program");
  Order order{Order::Kind::evaluate};
  order.text = line;
  const Report report = run(*record, std::move(order));
  return {report.text, !report.good};
}

}  // namespace gs::app::script
