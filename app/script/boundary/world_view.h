#pragma once

#include "app/script/boundary/world_access.h"

#include <cstddef>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace gs::app::script {

/// World as a running function sees it. Keeps answers until the function ends, because other nodes change only after it
/// (VRML97 C.5.2). One thread.
class WorldView {
 public:
  explicit WorldView(WorldAccess& world) : world_(world) {}

  /// Begins a call of a program. `gone` are scenes that left the world.
  void begin_function(const std::vector<std::uint64_t>& gone);
  /// Reports whether a scene is part of the world.
  [[nodiscard]] bool lives(std::uint64_t scene) const { return scene != 0 && !gone_.contains(scene); }

  [[nodiscard]] Answer ask(const Question& question);
  void tell(const Notice& notice) { world_.tell(notice); }
  /// Returns the value of a field, or the last value of an eventOut. Returns nullopt if there is none, or if the
  /// program may not read it.
  [[nodiscard]] std::optional<vrml::FieldValue> read(const NodeRef& node, std::uint32_t place);
  [[nodiscard]] const BrowserFacts& browser();

  /// Holds a node for an object of a program. Calls are counted here, so that the world learns only of the first one
  /// and of the release of the last one.
  void hold(const NodeRef& node);
  void release(const NodeRef& node);
  void print(std::string text);
  void report(Severity severity, std::string text, std::optional<Diagnostic> at = {});

 private:
  WorldAccess& world_;
  std::unordered_set<std::uint64_t> gone_;
  std::unordered_map<PlaceRef, std::optional<vrml::FieldValue>, HashPlaceRef> values_;
  std::shared_ptr<const BrowserFacts> browser_;
  std::unordered_map<NodeRef, std::size_t, HashNodeRef> held_;
};

}  // namespace gs::app::script
