#include "app/loading/content/scene_target.h"

#include "app/base/text_source.h"

namespace gs::app {

void SceneTarget::begin(const Found& found) {
  found_ = found;
  if (is_root_) loading_.results.set_file(found.path);
  read_scene_.hold(std::make_unique<vrml::SceneGraph>(found.path, loading_.budget));
  scene()->set_source(source_of(found.origin));
}

void SceneTarget::replace_scene(std::unique_ptr<vrml::SceneGraph> read) {
  read_scene_.hold(std::move(read));
  scene()->set_source(source_of(found_.origin));
  loading_.results.set_changed(true);
}

void SceneTarget::report(Severity severity, SourceLocation at, std::string message) {
  const bool is_own = scene() && !read_scene_.is_given();
  loading_.results.report(severity, is_own ? scene()->file_name() : found_.path, at, std::move(message));
}

void SceneTarget::refuse_size() {
  report(Severity::error, {}, loading_.budget->refusal(Resource::files) + "; left out");
  refuse();
}

void SceneTarget::set_type(const ContentType& type) {
  LoadedWorld* const world = is_root_ ? loading_.results.world() : nullptr;
  if (!world) return;
  world->type = type.name;
  world->up = type.up;
  world->authored = type.content == ContentClass::vrml;
}

void SceneTarget::set_up(const std::optional<Upright>& up) {
  if (LoadedWorld* const world = is_root_ ? loading_.results.world() : nullptr) world->stated_up = up;
}

void SceneTarget::node_changed(vrml::NodeId id) {
  shown_open_.push_back(&scene()->node(id));
  loading_.results.set_changed(true);
}

void SceneTarget::forget_meshes(const std::vector<vrml::NodeId>& open, render::MeshCache& meshes) {
  for (const vrml::Node* node : shown_open_) meshes.forget(node);
  shown_open_.clear();
  const auto forget = [&](vrml::NodeId id) {
    shown_open_.push_back(&scene()->node(id));
    meshes.forget(shown_open_.back());
  };
  for (const vrml::NodeId id : open) {
    forget(id);
    // An OutlineGroup also changes the group that it refines.
    if (scene()->node(id).type->url_content != vrml::UrlContent::outlines) continue;
    const auto refined = scene()->resolve_as(scene()->get<vrml::SFNode>(id, "refines"), vrml::NodeKind::outline_group);
    if (refined) forget(refined);
  }
}

}  // namespace gs::app
