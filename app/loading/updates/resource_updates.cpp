#include "app/loading/updates/resource_updates.h"

#include "app/formats/qnv/geometry_reader.h"

#include <iterator>
#include <utility>

namespace gs::app {

LoadedWorld::LoadedWorld() = default;
LoadedWorld::LoadedWorld(LoadedWorld&& other) noexcept = default;
LoadedWorld& LoadedWorld::operator=(LoadedWorld&& other) noexcept = default;
LoadedWorld::~LoadedWorld() = default;

Upright LoadedWorld::upright(const glm::vec3& size) const {
  constexpr float kFlat = 1e-3f;  // max ratio of depth to width or height of a picture
  Upright upright = stated_up.value_or(upright_of(up, size));
  if (stated_up && has_slices(up)) upright = facing_flat(upright, size);
  const auto extent = [&](const glm::vec3& direction) { return glm::dot(glm::abs(direction), size); };
  const bool picture = extent(upright.front) <= kFlat * std::min(extent(upright.right()), extent(upright.up));
  upright.three_quarter = upright.three_quarter || (!authored && !picture);
  return upright;
}

ResourceUpdates::ResourceUpdates() = default;
ResourceUpdates::ResourceUpdates(ResourceUpdates&& other) noexcept = default;
ResourceUpdates& ResourceUpdates::operator=(ResourceUpdates&& other) noexcept = default;
ResourceUpdates::~ResourceUpdates() = default;

void ResourceUpdates::append(ResourceUpdates&& later) {
  const auto move = [](auto& to, auto& from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  move(contents, later.contents);
  move(texts, later.texts);
  move(prototypes, later.prototypes);
  move(outlines, later.outlines);
  move(images, later.images);
  move(media, later.media);
  move(geometries, later.geometries);
  move(feeds, later.feeds);
  move(progress, later.progress);
  move(outside, later.outside);
  diagnostics.append(later.diagnostics);
}

void set_geometry(LoadedWorld& world, const ResourceUpdates::Geometry& update, Diagnostics& diagnostics) {
  vrml::SceneGraph& scene = *update.place.scene;
  const vrml::Node* node = &scene.node(update.place.node);
  std::shared_ptr<const qnv::Geometry>& held = world.geometries[node];
  if (update.image)
    world.images[node] = update.image;
  else
    world.images.erase(node);
  auto transfer = transfer_of(scene.get<vrml::MFFloat>(update.place.node, "transfer"));
  if (transfer.empty()) {
    held = update.geometry;
  } else {
    held = nullptr;
    if (has_room_for(*update.geometry, *scene.budget())) {
      qnv::Geometry own = *update.geometry;
      own.base().description.transfer = std::move(transfer);
      held = hold_geometry(std::move(own), scene.budget());
    }
    if (!held) {
      held = update.geometry;
      diagnostics.add(
          {Severity::warning, node->text->file_name(), node->location,
           "QNV: with its own transfer function, " + scene.budget()->refusal(Resource::vectors) + "; left out"});
    }
  }
  if (!update.fallback) return;
  vrml::Node& instance = scene.node(update.fallback);
  instance.expansion = {};
  instance.expansion.push_back(update.place.node);
}

void set_outlines(LoadedWorld& world, const ResourceUpdates::Outlines& update) {
  vrml::Node& node = update.place.scene->node(update.place.node);
  for (const auto& [field, value] : update.fields) node.values[field->slot] = value;
  world.outlines[&node] = update.held;
}

std::vector<ResourceUpdates::Place> take_in(LoadedWorld& world, ResourceUpdates&& updates) {
  std::vector<ResourceUpdates::Place> changed;
  for (const ResourceUpdates::Image& one : updates.images)
    for (const ResourceUpdates::Place& texture : one.textures) {
      const render::ImagePlace place(&texture.scene->node(texture.node), texture.url);
      if (one.image)
        world.images[place] = one.image;
      else
        world.images.erase(place);
      changed.push_back(texture);
    }
  for (const ResourceUpdates::Media& one : updates.media)
    for (const ResourceUpdates::Place& player : one.players) {
      const vrml::Node* node = &player.scene->node(player.node);
      if (one.media)
        world.media[node] = one.media;
      else
        world.media.erase(node);
      if (one.image)
        world.images[node] = one.image;
      else if (world.images.erase(node) == 0)
        continue;
      changed.push_back(player);
    }
  for (const ResourceUpdates::Geometry& one : updates.geometries) {
    if (one.geometry)
      set_geometry(world, one, world.diagnostics);
    else if (const vrml::Node* node = &one.place.scene->node(one.place.node); world.geometries.erase(node) > 0)
      world.images.erase(node);
    changed.push_back(one.place);
  }
  world.feeds.insert(world.feeds.end(), updates.feeds.begin(), updates.feeds.end());
  world.outside.insert(world.outside.end(), updates.outside.begin(), updates.outside.end());
  world.diagnostics.append(updates.diagnostics);
  return changed;
}

}  // namespace gs::app
