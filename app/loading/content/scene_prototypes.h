#pragma once

#include "app/loading/content/scene_context.h"
#include "app/loading/content/scene_references.h"
#include "app/loading/updates/external_prototypes.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace gs::app {

/// PROTOs for the EXTERNPROTOs of a scene.
class ScenePrototypes {
 public:
  ScenePrototypes(SceneHandler& handler, SceneContext& context) : handler_(handler), context_(context) {}

  /// Notes that a node of an EXTERNPROTO exists.
  void use(const vrml::NodeType& type) { used_types_.insert(&type); }
  /// Fetches the libraries of EXTERNPROTOs that are used.
  void look();
  /// Fetches the library of an EXTERNPROTO in a text that was read into the running world. Its types belong to that
  /// world.
  void load(const UrlRequest& request);
  /// Resolves EXTERNPROTOs, except those if fields of their instances are still being read.
  void resolve();
  /// Takes a library that was read.
  void take_library(SceneHandler& library);
  /// Handles a missing library. `why` is the reason, or nullopt if it was already reported.
  void miss(SceneHandler& library, const std::optional<std::string>& why);
  [[nodiscard]] bool wait_for_libraries() const { return awaited_libraries_ > 0; }
  [[nodiscard]] const std::vector<std::shared_ptr<SceneHandler>>& libraries() const { return libraries_; }

 private:
  using Libraries = std::unordered_map<std::string, SceneHandler*>;  // shared by the EXTERNPROTOs of one file

  [[nodiscard]] vrml::SceneGraph& scene() const;
  [[nodiscard]] bool is_given() const;
  [[nodiscard]] ReportAt reporter() const;
  bool ask_for(AwaitedPrototype& wanted, SceneReferences::Reference reference, UrlRequest request, Libraries& fresh);
  void use_types_inside();
  void take_own();
  bool stand_in(vrml::NodeType& type);
  void give(std::vector<AwaitedPrototype> awaited, std::unique_ptr<vrml::SceneGraph> library,
            std::optional<std::string> why);

  SceneHandler& handler_;
  SceneContext& context_;
  std::vector<std::shared_ptr<SceneHandler>> libraries_;
  std::vector<AwaitedPrototype> awaiting_;  // for a library: types of the outer scene that wait for it
  std::unordered_set<const vrml::NodeType*> used_types_, asked_types_;
  std::vector<std::pair<vrml::NodeType*, const vrml::NodeType*>> to_resolve_;  // pairs of EXTERNPROTO and PROTO
  std::vector<std::pair<vrml::NodeType*, std::string>> own_types_;  // EXTERNPROTOs and names of PROTOs in this file
  std::size_t awaited_libraries_ = 0;
};

}  // namespace gs::app
