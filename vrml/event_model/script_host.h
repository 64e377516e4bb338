#pragma once

#include "base/noncopyable.h"
#include "vrml/event_model/behaviour.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

namespace gs::vrml {

/// Call of a program: of the function of an eventIn, or of eventsProcessed() (VRML97 4.12.4).
struct ScriptCall {
  static constexpr std::uint32_t kProcessed = UINT32_MAX;

  EventNode script = 0;
  std::uint32_t interface = kProcessed;  // eventIn; kProcessed means eventsProcessed()
  FieldValue value{};                    // of the event
  double time = 0;                       // timestamp of the event
};

/// Host that runs the programs of a world's Scripts (VRML97 4.12). Another room implements it, because this room has no
/// script language.
///
/// Execution calls it on its own thread. Programs act on the world through the Execution. Events that programs cause
/// are delivered after the program returns.
class ScriptHost : NonCopyable {
 public:
  virtual ~ScriptHost() = default;

  /// Called when the Script enters the world, when its url changes, and when a missing resource has loaded. Runs the
  /// program and its initialize() (4.12.3), or requests the missing resource. Returns false if the program is not ready
  /// yet.
  virtual bool begin(EventNode script) = 0;
  /// Delivers an event with the timestamp `time`. Returns true if the caller must call events_processed() later.
  virtual bool deliver(EventNode script, std::uint32_t interface, const FieldValue& value, double time) = 0;
  /// Called when no more events are pending for the Script. Calls eventsProcessed() of the program (4.12.4).
  virtual void events_processed(EventNode script) = 0;
  /// Reports whether calls of the program may wait for later calls, because the program changes no ROUTEs and adds no
  /// nodes. Such changes act before the program returns.
  [[nodiscard]] virtual bool may_wait(EventNode) const { return false; }
  /// Makes calls one after the other, as deliver() and events_processed() do. Calls `made` after each, with the result
  /// of deliver(). Ends before an event for which the programs have no time. Returns the number of calls made.
  [[nodiscard]] virtual std::size_t make_calls(std::span<const ScriptCall>,
                                               const std::function<void(const ScriptCall&, bool)>&) {
    return 0;
  }
  /// Called at the begin of each step, before any event of the step. Calls prepareEvents() of X3D programs.
  virtual void prepare_events() {}
  /// Reports whether a program must be called in each step.
  [[nodiscard]] virtual bool prepares_events() const { return false; }
  /// Calls shutdown() of the program (4.12.3).
  virtual void end(EventNode script) = 0;
  /// Discards the data of a removed Script.
  virtual void forget(EventNode script) = 0;
  /// Reports whether the program has not started, or waits for a resource. Execution queues events for it until then.
  [[nodiscard]] virtual bool waits(EventNode script) const = 0;
  /// Returns false if the programs have used up their time in this step. Execution then queues events until the next
  /// step.
  [[nodiscard]] virtual bool has_time() = 0;
};

}  // namespace gs::vrml
