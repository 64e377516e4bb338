#pragma once

#include "app/formats/content_types.h"
#include "app/loading/content/read_scene.h"
#include "app/loading/fetch/content_handler.h"
#include "app/loading/fetch/loading.h"
#include "render/scene/render_list.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Scene that a file is read into.
class SceneTarget {
 public:
  /// Completeness of the file itself, without its references.
  enum class Content : std::uint8_t { whole, cut_short, refused };

  /// Creates a target. `nodes_added` is called after nodes were added; with true, their urls are fetched.
  /// `in_x3d` is true for the content of an Inline in an X3D text.
  SceneTarget(Loading& loading, bool is_root, bool in_x3d, std::function<void(bool)> nodes_added)
      : loading_(loading), is_root_(is_root), in_x3d_(in_x3d), nodes_added_(std::move(nodes_added)) {}

  /// Begins with an empty scene.
  void begin(const Found& found);
  void replace_scene(std::unique_ptr<vrml::SceneGraph> scene);
  [[nodiscard]] Loading& loading() const { return loading_; }
  [[nodiscard]] const Found& found() const { return found_; }
  [[nodiscard]] bool is_root() const { return is_root_; }
  [[nodiscard]] bool in_x3d() const { return in_x3d_; }
  /// Returns the scene, or null before it begins. After the hand-over it is only an identity.
  [[nodiscard]] vrml::SceneGraph* scene() const { return read_scene_.get(); }
  [[nodiscard]] ReadScene& read_scene() { return read_scene_; }

  void add_nodes(bool with_references = true) { nodes_added_(with_references); }
  /// Reports a problem of the file.
  void report(Severity severity, SourceLocation at, std::string message);
  void cut_short() { content_ = refused() ? Content::refused : Content::cut_short; }
  void refuse() { content_ = Content::refused; }
  /// Refuses a file that exceeds the memory budget.
  void refuse_size();
  [[nodiscard]] Content content() const { return content_; }
  [[nodiscard]] bool refused() const { return content_ == Content::refused; }

  // Properties of the world, which only its root file sets.
  void set_type(const ContentType& type);
  void set_up(const std::optional<Upright>& up);

  /// Notes that a node has changed since it was shown.
  void node_changed(vrml::NodeId id);
  /// Drops the meshes of changed and of incomplete nodes.
  void forget_meshes(const std::vector<vrml::NodeId>& open, render::MeshCache& meshes);

 private:
  Loading& loading_;
  bool is_root_, in_x3d_;
  std::function<void(bool)> nodes_added_;
  Found found_;
  ReadScene read_scene_;
  Content content_ = Content::whole;
  std::vector<const vrml::Node*> shown_open_;  // nodes that were incomplete at the last picture
};

}  // namespace gs::app
