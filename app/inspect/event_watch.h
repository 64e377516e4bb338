#pragma once

#include "app/inspect/node_children.h"
#include "base/noncopyable.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>

namespace gs::app {

/// eventOut of a node in a world.
struct WatchedEvent {
  vrml::NodeId node;
  const vrml::InterfaceDeclaration* event = nullptr;
  friend bool operator==(const WatchedEvent&, const WatchedEvent&) = default;
};
struct HashWatchedEvent {
  std::size_t operator()(const WatchedEvent& one) const {
    return std::hash<std::uint64_t>()(std::uint64_t{one.node.generation} << 32 | one.node.index) * 31 +
           std::hash<const void*>()(one.event);
  }
};

/// Live statistics of a world's events: the last time and the rate of each eventOut. Costs nothing unless it watches a
/// world. World's thread.
class EventWatch : NonCopyable {
 public:
  struct Seen {
    double time = 0;  // timestamp of the last event
    std::uint64_t count = 0;  // number of events since watch()
    double a_second = 0;  // events per second in the last complete interval
    std::uint64_t counted = 0;  // value of `count` at the start of the current interval
  };
  ~EventWatch();

  /// Watches this world instead of the previous one. Null ends watching. The world must outlive this object, or be
  /// replaced before it ends.
  void watch(vrml::Execution* world);
  /// Updates the rates once per second of world time. Returns true if anything changed since the last call.
  bool take_news();
  /// Returns the statistics of an eventOut, or null if it has sent nothing.
  [[nodiscard]] const Seen* find(const NodeAt& node, const vrml::InterfaceDeclaration& event) const;
  /// Maximum number of eventOuts with statistics. Further ones are ignored.
  static constexpr std::size_t kMax = 100'000;
  [[nodiscard]] std::size_t size() const { return seen_.size(); }

 private:
  vrml::Execution* world_ = nullptr;
  std::unordered_map<WatchedEvent, Seen, HashWatchedEvent> seen_;
  double second_ = 0;  // world time at the start of the current interval
  bool news_ = false;
};

}  // namespace gs::app
