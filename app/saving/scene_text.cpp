#include "app/saving/scene_text.h"

#include "app/encode/outline_model.h"
#include "app/saving/moved_urls.h"
#include "vrml/printing/print_scene.h"

#include <optional>
#include <string_view>
#include <utility>

namespace gs::app {
namespace {

/// Guard: during its lifetime, fields have values for the file instead of those in the world.
class FileValues {
 public:
  explicit FileValues(vrml::SceneGraph& scene) : scene_(scene) {}
  ~FileValues() {
    for (auto& [field, value] : changed_) *field = std::move(value);
  }
  FileValues(const FileValues&) = delete;
  FileValues& operator=(const FileValues&) = delete;

  void set(vrml::NodeId id, std::string_view field, vrml::FieldValue value) {
    const vrml::Node& node = scene_.node(id);
    vrml::FieldValue& present = node.values[node.type->find_field(field)->slot];
    changed_.emplace_back(&present, std::exchange(present, std::move(value)));
  }

 private:
  vrml::SceneGraph& scene_;
  std::vector<std::pair<vrml::FieldValue*, vrml::FieldValue>> changed_;  // fields with their values in the world
};

// Sets the field `complete`, which only the browser sets, to its default, and the urls of embedded textures.
void set_file_values(LoadedWorld& world, FileValues& values) {
  vrml::SceneGraph& scene = *world.scene;
  std::optional<TextureUrls> urls;  // made for the first texture, because it is slow
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::NodeId id = scene.nodes().id_at(i);
    if (!scene.contains(id) || scene.node(id).in_prototype_body) continue;
    const vrml::NodeKind kind = scene.node(id).type->read_as;
    if (kind == vrml::NodeKind::outline_group) values.set(id, "complete", false);
    if (kind != vrml::NodeKind::image_texture || !scene.get<vrml::MFString>(id, "url").empty()) continue;
    const auto image = world.images.find(&scene.node(id));
    if (image == world.images.end()) continue;
    if (!urls) urls = texture_urls(world);
    const auto url = urls->find(image->second.get());
    if (url == urls->end()) continue;
    vrml::MFString list;
    list.push_back(url->second);
    values.set(id, "url", std::move(list));
  }
}

}  // namespace

SceneText scene_text(LoadedWorld& world, vrml::Grammar grammar, const std::string& target) {
  FileValues values(*world.scene);
  set_file_values(world, values);
  SceneText made;
  vrml::PrintOptions options{grammar};
  if (!have_one_folder(world.path, target))
    options.moved_urls = [&](const vrml::MFString& urls) { return moved_list(urls, world.path, target); };
  made.losses = vrml::print_scene(*world.scene, options, [&](std::string_view piece) {
    made.text += piece;
    return true;
  });
  return made;
}

}  // namespace gs::app
