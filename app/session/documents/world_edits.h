#pragma once

#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Change of one field of a node by the user. The node may have been removed since.
struct WorldEdit {
  const vrml::SceneGraph* scene = nullptr;
  vrml::NodeId node;
  const vrml::InterfaceDeclaration* event_in = nullptr;  // eventIn or exposedField that sets the field
  const vrml::InterfaceDeclaration* field = nullptr;
  vrml::FieldValue before, after;
  double time = 0;            // seconds since 1970
  std::uint64_t gesture = 0;  // edits of one gesture count as one edit; 0 means none
};

/// Edits of one world by the user, for undo, redo and saving. World's thread.
class WorldEdits {
 public:
  static constexpr std::size_t kMaxUndone = 1000;  // max edits that can be undone

  /// Records an edit. Combines it with the previous one if both belong to the same field and gesture.
  void note(WorldEdit edit);
  /// Returns the edit that is undone (-1) or redone (1), and moves to the other list; nullopt if there is none.
  [[nodiscard]] std::optional<WorldEdit> go(int direction);
  /// Returns the time of the edit that go() would return; nullopt if there is none.
  [[nodiscard]] std::optional<double> time_of(int direction) const;

  /// Returns true if the world has edits that are not saved.
  [[nodiscard]] bool unsaved() const { return saved_ != done_.size(); }
  void mark_saved() { saved_ = done_.size(); }
  /// Returns the last edit of each field, in the order of the first edits.
  [[nodiscard]] std::vector<WorldEdit> latest() const;

  /// Text of the world's file before the first edit; null if there is none. See app/saving/world_text.h.
  std::shared_ptr<const std::string> source;
  bool has_source = false;  // `source` was read, even if there is no text

 private:
  std::vector<WorldEdit> done_, undone_;  // the next edit to undo or redo is the last one
  std::vector<WorldEdit> settled_;        // oldest edits, which cannot be undone
  std::size_t saved_ = 0;  // size of `done_` when the world was saved; above it means that this state is lost
};

}  // namespace gs::app
