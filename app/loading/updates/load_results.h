#pragma once

#include "app/formats/qnv/surface_pictures.h"
#include "app/loading/updates/loaded_world.h"
#include "app/loading/updates/resource_updates.h"
#include "base/budget.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {

/// Results of loading. Until the hand-over they are added to the world that is being read. Afterwards they are updates,
/// which the thread of the running world applies.
class LoadResults {
 public:
  LoadResults(std::string path, bool network_allowed, WorldBudget budget);

  void add(ResourceUpdates::Geometry geometry);
  void add(ResourceUpdates::Image image);
  void add(ResourceUpdates::Media media);
  void add(ResourceUpdates::Text text);
  void add(ResourceUpdates::Outlines outlines);
  void add(ResourceUpdates::Content content);
  void add(ResourceUpdates::Prototypes prototypes);
  void add(const UrlProgress& progress);
  void add(std::shared_ptr<StreamFeed> feed) { feeds_.push_back(std::move(feed)); }
  /// Adds vectors of a QNV node's own records, with the transfer function of the node.
  void add_own(const ResourceUpdates::Place& place, std::shared_ptr<const qnv::Geometry> vectors);
  void report(Severity severity, const std::string& file, SourceLocation at, std::string message) {
    diagnostics_.add({severity, file, at, std::move(message)});
  }
  // Records a folder that the world must not read. Returns true if it was not recorded before.
  bool refuse_folder(const std::string& folder, const std::string& reference);

  /// Returns the world that is being read, or null after the hand-over.
  [[nodiscard]] LoadedWorld* world() { return std::get_if<LoadedWorld>(&results_); }
  [[nodiscard]] bool is_handed_over() const { return std::holds_alternative<ResourceUpdates>(results_); }
  /// Hands over the world with `scene`. Later results are updates.
  [[nodiscard]] LoadedWorld hand_over(std::unique_ptr<vrml::SceneGraph> scene);
  /// Returns the updates since the last call, except those of scenes that `is_withheld`.
  [[nodiscard]] ResourceUpdates take_updates(const std::function<bool(const vrml::SceneGraph*)>& is_withheld);

  /// Returns the messages. The reference stays valid over the hand-over.
  [[nodiscard]] Diagnostics& diagnostics() { return diagnostics_; }
  [[nodiscard]] const std::vector<std::shared_ptr<StreamFeed>>& feeds() const { return feeds_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] const std::string& title() const { return title_; }
  /// Name of the world's file in messages.
  [[nodiscard]] const std::string& file() const { return file_.empty() ? path_ : file_; }
  void set_file(std::string file) { file_ = std::move(file); }

  [[nodiscard]] bool changed() const { return changed_; }
  void set_changed(bool changed) { changed_ = changed; }

 private:
  [[nodiscard]] ResourceUpdates& updates() { return std::get<ResourceUpdates>(results_); }

  std::string path_, title_, file_;
  WorldBudget budget_;
  SurfacePictures pictures_;
  Diagnostics diagnostics_;                         // since the last hand-over
  std::vector<std::shared_ptr<StreamFeed>> feeds_;  // since the last hand-over
  std::vector<OutsideFolder> outside_;              // since the last hand-over
  bool live_ = false;                               // a running simulation replaces the world by newer steps
  std::variant<LoadedWorld, ResourceUpdates> results_;
  bool changed_ = false;  // something visible has changed
};

}  // namespace gs::app
