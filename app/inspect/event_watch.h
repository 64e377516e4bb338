#pragma once

#include "app/inspect/node_children.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>

namespace gs::app {

/// Live statistics of a world's events: last time and rate of each eventOut. Costs nothing while not watching. Use on
/// the world's thread.
class EventWatch {
 public:
  struct Seen {
    double time = 0;            // time of the last event, in world time
    std::uint64_t count = 0;    // events since watching began
    double a_second = 0;        // events per second in the last interval
    std::uint64_t counted = 0;  // `count` at the start of the interval
  };
  EventWatch() = default;
  ~EventWatch();
  EventWatch(const EventWatch&) = delete;
  EventWatch& operator=(const EventWatch&) = delete;

  /// Watches this world instead of the former one; null watches none. The world must outlive this object or be replaced
  /// first.
  void watch(vrml::Execution* world);
  /// Updates the rates once a second of world time. Returns true if there is something new to show since the last call.
  bool take_news();
  /// Returns null if the eventOut has not sent anything.
  [[nodiscard]] const Seen* find(const NodeAt& node, const vrml::InterfaceDeclaration& event) const;
  /// Max number of eventOuts tracked; later ones are ignored.
  static constexpr std::size_t kMax = 100'000;
  [[nodiscard]] std::size_t size() const { return seen_.size(); }

 private:
  struct Key {
    vrml::NodeId node;
    const vrml::InterfaceDeclaration* event = nullptr;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Hash {
    std::size_t operator()(const Key& key) const {
      return std::hash<std::uint64_t>()(std::uint64_t{key.node.generation} << 32 | key.node.index) * 31 +
             std::hash<const void*>()(key.event);
    }
  };

  vrml::Execution* world_ = nullptr;
  std::unordered_map<Key, Seen, Hash> seen_;
  double second_ = 0;  // world time at which the present interval began
  bool news_ = false;
};

}  // namespace gs::app
