#pragma once

#include "vrml/event_model/behaviour.h"

#include <cstdint>

namespace gs::vrml {

/// Runs the programs of a world's Scripts (VRML97 4.12), in languages that this room does not know.
///
/// Execution calls it on its own thread. Programs act on the world through the Execution; the
/// events that they cause are delivered after the program returns.
class ScriptHost {
 public:
  ScriptHost() = default;
  virtual ~ScriptHost() = default;
  ScriptHost(const ScriptHost&) = delete;
  ScriptHost& operator=(const ScriptHost&) = delete;

  /// Called when the Script enters the world, its url changes, or a missing resource has loaded. Runs the program and
  /// initialize() (4.12.3), or requests what it needs. Returns false if there is no program yet.
  virtual bool begin(EventNode script) = 0;
  /// Delivers an event with timestamp `time`. Returns true if events_processed() must follow.
  virtual bool deliver(EventNode script, std::uint32_t interface, const FieldValue& value, double time) = 0;
  /// Called when no more events are pending for the Script (4.12.4).
  virtual void events_processed(EventNode script) = 0;
  /// Calls shutdown() (4.12.3).
  virtual void end(EventNode script) = 0;
  /// Forgets a removed node.
  virtual void forget(EventNode script) = 0;
  /// Reports whether the program has not started or waits for a fetch. Execution queues its events meanwhile.
  [[nodiscard]] virtual bool waits(EventNode script) const = 0;
  /// Returns false if this step's time for programs is used up. Execution then queues events until the next step.
  [[nodiscard]] virtual bool has_time() = 0;
};

}  // namespace gs::vrml
