#pragma once

#include "vrml/scene/scene_graph.h"

#include <memory>
#include <utility>
#include <variant>

namespace gs::app {

/// Scene that the reader thread makes, and its way to its owner:
///
///   none -> own -> attached to another scene -> taken back -> given
///
/// Each step is one call. A given scene belongs to the thread of the running world; here it is only an identity.
class ReadScene {
 public:
  /// Begins with a scene, or replaces it.
  void hold(std::unique_ptr<vrml::SceneGraph> scene) {
    identity_ = scene.get();
    owner_ = std::move(scene);
  }
  /// Returns the scene, or null if there is none yet.
  [[nodiscard]] vrml::SceneGraph* get() const { return identity_; }
  [[nodiscard]] bool is_given() const { return std::holds_alternative<Given>(owner_); }
  /// Returns true if this object holds a scene with nodes.
  [[nodiscard]] bool has_own_nodes() const {
    const auto* own = std::get_if<Own>(&owner_);
    return own && !(*own)->roots().empty();
  }

  /// Makes the scene the content of an Inline of `outer`.
  void attach(vrml::SceneGraph& outer, vrml::NodeId inline_node) {
    outer.inlines().attach(inline_node, std::move(std::get<Own>(owner_)));
    owner_ = Attached{};
  }
  /// Makes the scene a library of `outer`.
  [[nodiscard]] const vrml::SceneGraph& attach_library(vrml::SceneGraph& outer) {
    const vrml::SceneGraph& attached = outer.attach_library(std::move(std::get<Own>(owner_)));
    owner_ = Attached{};
    return attached;
  }
  [[nodiscard]] bool is_attached(const vrml::SceneGraph& outer, vrml::NodeId inline_node) const {
    return identity_ && outer.inlines().of(inline_node) == identity_;
  }
  /// Takes the content of an Inline back, to be read further while another thread owns `outer`.
  void take_back(vrml::SceneGraph& outer, vrml::NodeId inline_node) {
    owner_ = outer.inlines().all().at(inline_node.index);
    outer.inlines().attach(inline_node, nullptr);
  }

  /// Marks the content of an Inline as given, because `outer`, which holds it, is handed over.
  void give_with(const vrml::SceneGraph& outer, vrml::NodeId inline_node) {
    owner_ = Given{outer.inlines().all().at(inline_node.index)};
  }
  void give_with_library() { owner_ = Given{}; }
  /// Gives a root scene or library. Returns null if there is none.
  [[nodiscard]] std::unique_ptr<vrml::SceneGraph> give() {
    auto* own = std::get_if<Own>(&owner_);
    std::unique_ptr<vrml::SceneGraph> scene = own ? std::move(*own) : nullptr;
    owner_ = Given{};
    return scene;
  }
  /// Gives the content of an Inline. Returns null and keeps everything if there is none.
  [[nodiscard]] std::shared_ptr<vrml::SceneGraph> give_content() {
    std::shared_ptr<vrml::SceneGraph> content;
    if (auto* own = std::get_if<Own>(&owner_)) content = std::move(*own);
    if (auto* taken_back = std::get_if<TakenBack>(&owner_)) content = std::move(*taken_back);
    if (content) owner_ = Given{content};
    return content;
  }
  /// Returns a given content while its world still has it.
  [[nodiscard]] std::shared_ptr<vrml::SceneGraph> given_content() const {
    const auto* given = std::get_if<Given>(&owner_);
    return given ? given->content.lock() : nullptr;
  }

 private:
  struct None {};
  using Own = std::unique_ptr<vrml::SceneGraph>;
  struct Attached {};
  using TakenBack = std::shared_ptr<vrml::SceneGraph>;
  struct Given {
    std::weak_ptr<vrml::SceneGraph> content;  // of an Inline
  };

  vrml::SceneGraph* identity_ = nullptr;
  std::variant<None, Own, Attached, TakenBack, Given> owner_;
};

}  // namespace gs::app
