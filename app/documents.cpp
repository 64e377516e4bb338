#include "app/documents.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

/// Looks for what the render list does not tell, through all Inlines.
void inspect(Document& document) {
  std::vector<const vrml::SceneGraph*> scenes{document.world.scene.get()};
  while (!scenes.empty()) {
    const vrml::SceneGraph& scene = *scenes.back();
    scenes.pop_back();
    for (std::uint32_t index = 1; index <= scene.node_count(); ++index) {
      const vrml::Node& node = scene.node(scene.id_at(index));
      if (node.in_prototype_body || node.type->kind != vrml::NodeType::Kind::built_in) continue;
      const std::string& type = node.type->name;
      document.viewer_dependent |= type == "LOD" || type == "Billboard";
      // Bindable nodes of Inlines are not bound at start (VRML97 4.6.10).
      document.has_navigation_info |= type == "NavigationInfo" && &scene == document.world.scene.get();
    }
    for (const auto& [node, content] : scene.inlines())
      if (content) scenes.push_back(content.get());
  }
}

}  // namespace

std::unique_ptr<Document> make_document(OpenedWorld world) {
  auto document = std::make_unique<Document>();
  document->world = std::move(world);
  if (!document->world.scene) return document;
  inspect(*document);
  document->list = render::collect(*document->world.scene, document->world.images, document->meshes,
                                   glm::vec3(0, 0, 10), document->world.clouds);
  if (document->viewer_dependent) {
    const auto& viewpoints = document->list.viewpoints;
    document->navigation.pose.position =
        viewpoints.empty() ? first_pose(document->list.bounds, {4, 3}).position
                           : pose_of(viewpoints[0].world_from_camera, viewpoints[0].field_of_view).position;
    follow_viewer(*document);
  }
  return document;
}

bool enter(Document& document, const glm::vec2& viewport, std::string_view viewpoint) {
  const auto& viewpoints = document.list.viewpoints;
  document.rules = document.has_navigation_info ? navigation_rules(document.list.navigation)
                                                : default_navigation_rules(document.list.bounds, !viewpoints.empty());
  document.headlight = document.list.navigation.headlight;
  const auto named = viewpoint.empty() ? std::nullopt : find_viewpoint(viewpoints, viewpoint);
  document.viewpoint = named ? named : viewpoints.empty() ? std::nullopt : std::optional<std::size_t>(0);
  if (document.viewpoint) {
    const render::ViewpointState& bound = viewpoints[*document.viewpoint];
    document.home = pose_of(bound.world_from_camera, bound.field_of_view);
  } else {
    document.home = first_pose(document.list.bounds, viewport);
  }
  document.navigation = start_navigation(document.rules, document.list.bounds, document.home);
  document.entered = true;
  return viewpoint.empty() || named.has_value();
}

bool follow_viewer(Document& document) {
  if (!document.viewer_dependent || !document.world.scene) return false;
  const glm::vec3 viewer = document.navigation.pose.position;
  // Large worlds are gathered again only where it is likely to show.
  const float tolerance = document.list.items.size() > 2000 ? document.navigation.scene_size * 0.002f : 0.0f;
  if (!(glm::distance(viewer, document.collected_for) > tolerance)) return false;
  document.collected_for = viewer;
  document.list =
      render::collect(*document.world.scene, document.world.images, document.meshes, viewer, document.world.clouds);
  if (document.viewpoint && *document.viewpoint >= document.list.viewpoints.size()) document.viewpoint.reset();
  return true;
}

void DocumentList::open(std::span<const std::string> paths) {
  bool first = true;
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    std::optional<std::size_t> index = find(path);
    if (index) {
      entries_[*index].stale = true;
    } else {
      index = entries_.size();
      entries_.push_back({path, true, nullptr});
    }
    if (std::exchange(first, false)) select(*index);
  }
}

void DocumentList::select(std::size_t index) {
  if (index >= entries_.size()) return;
  selected_ = index;
  if (entries_[index].document) shown_ = entries_[index].path;
}

void DocumentList::reload() {
  if (selected_ < entries_.size()) entries_[selected_].stale = true;
}

std::optional<std::string> DocumentList::begin_loading() {
  if (!loading_.empty() || selected_ >= entries_.size() || !entries_[selected_].stale) return std::nullopt;
  loading_ = entries_[selected_].path;
  entries_[selected_].stale = false;
  return loading_;
}

void DocumentList::deliver(std::unique_ptr<Document> document) {
  const std::optional<std::size_t> index = find(std::exchange(loading_, {}));
  if (!index) return;
  entries_[*index].document = std::move(document);
  if (*index == selected_) shown_ = entries_[*index].path;
}

void DocumentList::fail() {
  const std::optional<std::size_t> index = find(std::exchange(loading_, {}));
  if (!index || entries_[*index].document) return;
  entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(*index));
  if (selected_ > *index) {
    --selected_;
  } else if (selected_ == *index) {
    // Back to what is on the screen; at the start, on to the next file that was named.
    const std::optional<std::size_t> shown_index = find(shown_);
    selected_ = shown_index ? *shown_index : std::min(*index, entries_.empty() ? 0 : entries_.size() - 1);
  }
}

Document* DocumentList::shown() {
  const std::optional<std::size_t> index = find(shown_);
  return index ? entries_[*index].document.get() : nullptr;
}

std::optional<std::size_t> DocumentList::find(std::string_view path) const {
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (entries_[i].path == path && !path.empty()) return i;
  return std::nullopt;
}

std::string file_label(std::string_view path) {
  while (path.size() > 1 && path.back() == '/') path.remove_suffix(1);
  const std::size_t slash = path.find_last_of('/');
  return std::string(slash == std::string_view::npos || slash + 1 == path.size() ? path : path.substr(slash + 1));
}

}  // namespace gs::app
