#pragma once

#include "app/inspect/node_children.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <unordered_map>

namespace gs::app {

/// The events of a world as they go by: which eventOut has sent when, and how many a second. Costs nothing while nobody
/// watches. One thread, that of the world.
class EventWatch {
 public:
  struct Seen {
    double time = 0;            // of the last one, as worlds count it
    std::uint64_t count = 0;    // since it is watched
    double a_second = 0;        // in the last whole second
    std::uint64_t counted = 0;  // until that began
  };
  EventWatch() = default;
  ~EventWatch();
  EventWatch(const EventWatch&) = delete;
  EventWatch& operator=(const EventWatch&) = delete;

  /// Watches this world in place of the former; null: none. It must outlive this, or be taken away before.
  void watch(vrml::Execution* world);
  /// Counts what a second has brought; the present time of the world. True: something was sent since the last call.
  bool take_news();
  /// Null: it has sent nothing.
  [[nodiscard]] const Seen* find(const NodeAt& node, const vrml::InterfaceDeclaration& event) const;
  /// Eventouts that are remembered; of more than so many, the first.
  static constexpr std::size_t kMost = 100'000;
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
  double second_ = 0;  // when the present one began
  bool news_ = false;
};

}  // namespace gs::app
