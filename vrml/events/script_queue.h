#pragma once

#include "vrml/event_model/script_host.h"
#include "vrml/scene/scene_graph.h"

#include <vector>

namespace gs::vrml {

/// Scripts of a world (VRML97 4.12). Starts their programs before they receive events. Part of Execution.
class ScriptQueue {
 public:
  explicit ScriptQueue(Execution& execution) : execution_(execution) {}

  /// Sets the host that runs the programs of all Scripts, from the start of the world on. Null means that no programs
  /// run. The host must outlive this object, or must be replaced by null first; then it receives no end() calls.
  void set_host(ScriptHost* host) { host_ = host; }
  [[nodiscard]] ScriptHost* host() const { return host_; }
  /// Reports whether the world has ever had a Script.
  [[nodiscard]] bool has_scripts() const { return has_scripts_; }
  /// Reports whether the world has started and Scripts still wait for their start.
  [[nodiscard]] bool waits() const { return started_ && !new_.empty(); }

  /// Adds a Script that entered the world.
  void add(EventNode node);
  /// Reports that the Script's program, or a resource that it lacked, has loaded.
  void program_came(const SceneGraph& scene, NodeId script);
  /// Starts the Scripts of the world, all of them with the first timestamp.
  void begin_world();
  /// Starts new Scripts.
  void begin_new();
  /// Delivers an event to a Script with a running program. The call of the program may wait for flush().
  void deliver(EventNode node, std::uint32_t interface, const FieldValue& value);
  /// Calls eventsProcessed() of a Script. The call may wait for flush().
  void call_processed(EventNode node);
  /// Makes all calls that wait, in order. Must precede everything that these programs could notice or change.
  void flush() {
    if (!waiting_.empty()) make_waiting();
  }
  /// Ends Scripts before they are removed. Takes the list by value, because shutdown() may add nodes.
  void end(std::vector<EventNode> nodes);
  /// Discards removed Scripts.
  void forget_removed();

 private:
  [[nodiscard]] bool may_wait(EventNode node) const;
  void wait(ScriptCall call);
  void make_waiting();
  void keep(const ScriptCall& call);
  void owe_processed(EventNode node);

  Execution& execution_;
  ScriptHost* host_ = nullptr;
  bool has_scripts_ = false, started_ = false, starting_ = false;
  std::vector<EventNode> new_;
  std::vector<ScriptCall> waiting_, making_;  // calls for flush(), and those of a running flush()
};

}  // namespace gs::vrml
