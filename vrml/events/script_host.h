#pragma once

#include "vrml/events/behaviour.h"

#include <cstdint>

namespace gs::vrml {

/// Runs the programs of the Scripts of a world (VRML97 4.12), which are in a language that this room does not know.
///
/// Execution calls it on its own thread. Programs act on the world by Execution's functions for Scripts, whose events
/// go on when the program has returned.
class ScriptHost {
 public:
  ScriptHost() = default;
  virtual ~ScriptHost() = default;
  ScriptHost(const ScriptHost&) = delete;
  ScriptHost& operator=(const ScriptHost&) = delete;

  /// The Script is in the world, or its url is another one, or what was missing of it has come: runs its program and
  /// initialize() (4.12.3), or asks for what it needs. False where it has none (yet).
  virtual bool begin(EventNode script) = 0;
  /// An event of the time `time`. True where events_processed is to follow.
  virtual bool deliver(EventNode script, std::uint32_t interface, const FieldValue& value, double time) = 0;
  /// No more events are there for it now (4.12.4).
  virtual void events_processed(EventNode script) = 0;
  /// shutdown() (4.12.3).
  virtual void end(EventNode script) = 0;
  /// The node is gone.
  virtual void forget(EventNode script) = 0;
  /// Whether the program has not begun, or waits for what is being fetched: events are kept for it meanwhile.
  [[nodiscard]] virtual bool waits(EventNode script) const = 0;
  /// False: what is left of the time for programs in this step is needed for other things. Events are kept until the
  /// next one.
  [[nodiscard]] virtual bool has_time() = 0;
};

}  // namespace gs::vrml
