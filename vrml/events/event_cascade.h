#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/scene/scene_graph.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

namespace gs::vrml {

/// Event that an eventOut or exposedField has sent.
struct SentEvent {
  double time = 0;  // timestamp: seconds since 1970-01-01 00:00 GMT (VRML97 4.11)
  const SceneGraph* scene = nullptr;
  NodeId node;  // sending node in `scene`; a PROTO instance and its body nodes send separate events
  const InterfaceDeclaration* event = nullptr;  // declaration in the interface of the node's type
  const FieldValue* value = nullptr;
};

/// Event cascades of a world (VRML97 4.10.3, 4.10.4): timestamps, and the delivery of events along ROUTEs and IS. Part
/// of Execution.
///
/// A cascade has one timestamp, and each eventOut sends at most one event per timestamp, which ends loops. Events of
/// one timestamp are delivered in sending order, along ROUTEs in order of creation.
class EventCascade {
 public:
  using Observer = std::function<void(const SentEvent&)>;

  explicit EventCascade(Execution& execution);

  [[nodiscard]] double now() const { return now_; }
  /// Returns the time of the previous step. In the first step, returns now().
  [[nodiscard]] double previous() const { return previous_; }
  /// Returns the serial number of the present timestamp.
  [[nodiscard]] std::uint64_t stamp() const { return stamp_; }
  /// Begins the timestamp `now`, or the last timestamp if `now` is earlier. `first` marks the first step of the world.
  void begin(double now, bool first = false);
  /// Begins a new timestamp for the next events from outside: the next larger double. Each eventOut may then send again
  /// (4.10.4). Running nodes get the new time in the next step.
  void begin_update();
  /// Delivers the events sent so far, and all events that result from them. Then ends the cascade.
  void drain();

  /// Registers an observer. The observer receives each event at delivery, even events without a ROUTE. `who` is the key
  /// of the observer: each key has one observer, and an empty observer unregisters the previous one. Observers must not
  /// modify the Execution or register observers.
  void observe(Observer observer, const void* who = nullptr);
  [[nodiscard]] bool is_observed() const { return !observers_.empty(); }
  /// Returns the sender of the event that is being delivered; 0 if there is none.
  [[nodiscard]] EventNode source() const { return source_; }

  /// Delivers an event from outside the world, and all resulting events; see Execution::send.
  bool send(const SceneGraph& scene, NodeId node, const InterfaceDeclaration& event_in, const FieldValue& value);
  /// Queues an event for a node of this world. If the caller is a running program, the event is delivered in this
  /// cascade, after the events already sent. Otherwise EventCascade::drain() delivers the event. Returns false like
  /// send().
  bool post(const SceneGraph& scene, NodeId node, const InterfaceDeclaration& event_in, FieldValue value);
  /// Returns storage for a value, which the caller writes to send it. Returns null if the eventOut has sent an event
  /// with this timestamp. `event` is an index in Behaviour::events.
  [[nodiscard]] FieldValue* place_to_send(EventNode node, int event);
  /// Sends the current EventNodes::own_value() of an eventOut or exposedField.
  void send_own(EventNode node, std::uint32_t interface);
  /// Reports that the caller changed a value through EventNodes::own_value().
  void own_value_changed(EventNode node, std::uint32_t interface);
  /// Reports whether an interface has sent an event with the present timestamp.
  [[nodiscard]] bool has_sent_own(EventNode node, std::uint32_t interface) const;
  /// Queues the event of an interface that already has its value. Does nothing if the event was sent with this
  /// timestamp.
  void queue(EventNode node, std::uint32_t interface);
  /// Returns the last value of an eventOut, or the value of a field; null if there is no value.
  [[nodiscard]] const FieldValue* last_value(const SceneGraph& scene, NodeId node,
                                             const InterfaceDeclaration& interface);

 private:
  struct Sent {
    EventNode node;
    std::uint32_t interface;
    std::uint32_t posted = 0;  // if not 0: 1 + index in posted_ of an event for the node
  };

  /// Returns the node that receives the event, and the index of the interface there. The node is 0 if the event cannot
  /// be delivered.
  [[nodiscard]] std::pair<EventNode, std::uint32_t> receiver(const SceneGraph& scene, NodeId node,
                                                             const InterfaceDeclaration& event_in,
                                                             const FieldValue& value);
  void deliver(Sent sent);
  void walk(std::uint32_t first, const FieldValue& value);
  void receive(EventNode node, std::uint32_t interface, const FieldValue& value);
  void pass_up(EventNode node, std::uint32_t interface, const FieldValue& value);

  Execution& execution_;
  std::vector<std::pair<const void*, Observer>> observers_;
  double now_, previous_;
  std::uint64_t stamp_ = 1;
  std::vector<Sent> queue_;
  std::size_t queue_next_ = 0;
  EventNode source_ = 0;
  std::deque<FieldValue> posted_;
  std::vector<std::uint32_t> path_;  // stack of walk()
};

}  // namespace gs::vrml
