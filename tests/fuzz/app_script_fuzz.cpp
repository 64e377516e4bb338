// Fuzzes worlds with hostile Scripts (script_worlds.h). They run as in `ghostspace trace`, beside other worlds, and in
// a session that follows loadURL. Garbage is collected when a program prints "gc".
#include "app/loading/world_loader.h"
#include "app/loading/world_loading.h"
#include "app/script/engine/engine.h"
#include "app/session/session.h"
#include "app/simulation/simulation.h"
#include "tests/fuzz/app_targets.h"
#include "tests/fuzz/scripts/script_worlds.h"
#include "tests/net/memory_network.h"
#include "vrml/syntax/printer.h"

#include <js/GCAPI.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <memory>
#include <set>
#include <span>
#include <thread>
#include <tuple>

using namespace gs::app;

namespace gs::fuzz {
namespace {

constexpr char kFirst[] = "memory://a/world.wrl";
constexpr double kSeconds = 1, kPiece = 0.25;  // seconds of simulated time
constexpr std::clock_t kMaxProcessor = 4;      // seconds of processor time for a trace or a session
constexpr glm::ivec2 kSize(64, 64);

std::vector<std::byte> bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

LoadOptions site_of(const std::vector<WorldPart>& parts) {
  LoadOptions options;
  options.memory = net::MakeMemoryTransport{};
  options.limits.memory = std::size_t{64} << 20;
  options.limits.nodes = options.limits.expanded_nodes = 20'000;
  options.limits.script_seconds = 0.15;
  options.limits.script_heap = std::size_t{32} << 20;
  options.limits.files = 200;
  options.limits.inline_depth = 4;
  options.timeout_seconds = 5;
  for (const WorldPart& part : parts) {
    const std::string name(part.name);
    net::network_of(options.memory)
        .put(name.starts_with("b/") ? "memory://" + name : "memory://a/" + name,
             [body = bytes_of(part.text)](const net::TransferRequest&, unsigned) {
               net::MemoryAnswer answer;
               answer.head.content_length = body.size();
               answer.body = body;
               return answer;
             });
  }
  return options;
}

/// Reports whether a world has used its processor time. Programs may reach their limits repeatedly: each call that
/// exceeds the memory causes two garbage collections.
bool is_long(std::clock_t began) { return std::clock() - began > kMaxProcessor * CLOCKS_PER_SEC; }

void collect_garbage(const ScriptMessage& message) {
  if (!message.printed || message.diagnostic.message != "gc") return;
  if (script::Engine* const engine = script::Engine::of_this_thread()) JS_GC(engine->context());
}

/// Ends the program if a field refers to a node that its scene does not contain.
void check_nodes(const vrml::SceneGraph& scene) {
  const auto check = [&](vrml::NodeId id) { require(!id || scene.contains(id)); };
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::NodeId id = scene.nodes().id_at(i);
    if (!scene.contains(id)) continue;
    const vrml::Node& node = scene.node(id);
    for (const vrml::FieldValue& value : std::span(node.values, node.type->defaults.size())) {
      if (const auto* one = std::get_if<vrml::SFNode>(&value)) check(*one);
      if (const auto* list = std::get_if<vrml::MFNode>(&value)) std::for_each(list->begin(), list->end(), check);
    }
  }
}

/// Ends the program if a ROUTE refers to a removed node, or connects different types.
void check_routes(const vrml::Execution& execution) {
  for (const auto& placed : execution.routes().all()) {
    require(execution.scenes().has(placed.scene) && placed.scene->contains(placed.route.from));
    require(execution.scenes().has(placed.to_scene) && placed.to_scene->contains(placed.route.to));
    require(placed.route.event_out->type == placed.route.event_in->type);
  }
}

/// World that runs as in `ghostspace trace`.
class Trace {
 public:
  Trace(const LoadOptions& options, const std::string& url, bool verbose) : loading_(url, options) {
    LoadedWorld world = load_world(loading_, url);
    if (verbose)
      for (const Diagnostic& one : world.diagnostics.entries()) std::printf("%s\n", one.text().c_str());
    if (!world.scene) return;
    simulation_ = std::make_unique<Simulation>(std::move(world), kSize);
    simulation_->fetch_with(loading_);
    simulation_->execution().cascade().observe([this](const vrml::SentEvent& event) { check(event); });
    simulation_->observe_scripts([verbose](const ScriptMessage& message) {
      require(message.printed || !message.diagnostic.message.empty());
      if (verbose) std::printf("%s\n", message.diagnostic.text().c_str());
      collect_garbage(message);
    });
  }

  [[nodiscard]] bool good() const { return simulation_ != nullptr; }
  void plan(std::string_view rows) {
    if (!simulation_) return;
    Diagnostics ignored;
    (void)simulation_->plan(read_input_rows(rows, "input", ignored), "input", ignored);
    simulation_->press_sensors();
  }
  void run(double until) {
    if (!simulation_) return;
    for (; time_ < until; time_ += kPiece) {
      simulation_->run(time_ + kPiece, [this] { return !is_long(began_); });
      if (is_long(began_)) return;
      (void)simulation_->execution().lifetime().remove_unheld();
      (void)simulation_->look();
      check_nodes(*simulation_->world().scene);
      check_routes(simulation_->execution());
    }
  }

 private:
  // Checks that an eventOut sends at most one event per timestamp (VRML97 4.10.4), and that time never goes back.
  void check(const vrml::SentEvent& event) {
    const vrml::Execution& execution = simulation_->execution();
    require(execution.scenes().has(event.scene) && event.scene->contains(event.node));
    require(vrml::type_of(*event.value) == event.event->type);
    require(event.time >= last_time_);
    if (event.time > last_time_) sent_.clear();
    last_time_ = event.time;
    require(sent_.insert({event.scene, event.node.index, event.node.generation, event.event}).second);
    text_.clear();
    vrml::print_value(text_, *event.value, *event.scene);
  }

  WorldLoading loading_;
  std::clock_t began_ = std::clock();
  std::string text_;
  double last_time_ = 0, time_ = 0;
  std::set<std::tuple<const void*, std::uint32_t, std::uint32_t, const void*>> sent_;
  std::unique_ptr<Simulation> simulation_;
};

std::string_view part_of(const std::vector<WorldPart>& parts, std::string_view name) {
  for (const WorldPart& part : parts)
    if (part.name == name) return part.text;
  return {};
}

bool has(const std::vector<WorldPart>& parts, std::string_view name) {
  return std::any_of(parts.begin(), parts.end(), [&](const WorldPart& part) { return part.name == name; });
}

/// Runs a session that follows loadURL. Other threads read its worlds, so steps wait for them.
void visit(const LoadOptions& options, std::string_view console) {
  SessionOptions how;
  how.files = {kFirst};
  Session session(how, options, [] {});
  SensorTour tour(session);
  SessionInput input;
  input.area = Viewport{0, 0, kSize.x, kSize.y};
  constexpr int kSteps = 24, kWaits = 300;
  const std::clock_t began = std::clock();
  for (int i = 0; i < kSteps && !is_long(began); ++i) {
    const double now = kSimulatedStart + i * 0.05;
    Frame frame = session.step(now, input);
    for (int waits = 0; frame.loading && waits < kWaits; ++waits) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      frame = session.step(now, input);
    }
    tour.step();
    const View* const seen = session.view();
    if (!seen || !seen->document->runtime) continue;
    WorldRuntime& runtime = *seen->document->runtime;
    runtime.programs().observe(collect_garbage);
    const vrml::SceneGraph& scene = *seen->document->world.scene;
    for (std::uint32_t at = 1; !console.empty() && i % 8 == 7 && at <= scene.nodes().count(); ++at) {
      const vrml::NodeId id = scene.nodes().id_at(at);
      if (!scene.contains(id) || scene.node(id).name != "S0") continue;
      (void)runtime.programs().evaluate(scene, id, std::string(console));
      (void)runtime.programs().evaluate(scene, {}, std::string(console));
      break;
    }
  }
}

}  // namespace

bool play_script_world(std::string_view text, bool verbose) {
  const std::vector<WorldPart> parts = world_parts(text);
  // Reject worlds that could use a network.
  if (parts.empty() || text.find("tp:") != text.npos || text.find("tps:") != text.npos) return false;
  const LoadOptions options = site_of(parts);
  bool good = false;
  {
    auto first = std::make_unique<Trace>(options, kFirst, verbose);
    good = first->good();
    first->plan(part_of(parts, "input"));
    first->run(kSeconds);
    if (has(parts, "beside.wrl")) {
      Trace other(options, "memory://a/beside.wrl", verbose);
      other.plan({});
      other.run(kSeconds / 2);
      first->run(kSeconds + kPiece);
      other.run(kSeconds / 2 + kPiece);
      first.reset();
      other.run(kSeconds);
    }
  }
  if (has(parts, "next.wrl")) {
    Trace next(options, "memory://a/next.wrl", verbose);
    next.plan({});
    next.run(kSeconds / 2);
  }
  if (has(parts, "console")) visit(options, part_of(parts, "console"));
  if (script::Engine* const engine = script::Engine::of_this_thread()) JS_GC(engine->context());
  return good;
}

bool run_script_world(std::span<const std::byte> bytes) { return play_script_world(text_of(bytes), false); }

}  // namespace gs::fuzz
