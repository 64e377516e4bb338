#include "app/world/updates/arrivals.h"

#include "app/formats/qnv/cloud_reader.h"

#include <iterator>
#include <utility>

namespace gs::app {

OpenedWorld::OpenedWorld() = default;
OpenedWorld::OpenedWorld(OpenedWorld&& other) noexcept = default;
OpenedWorld& OpenedWorld::operator=(OpenedWorld&& other) noexcept = default;
OpenedWorld::~OpenedWorld() = default;

Arrivals::Arrivals() = default;
Arrivals::Arrivals(Arrivals&& other) noexcept = default;
Arrivals& Arrivals::operator=(Arrivals&& other) noexcept = default;
Arrivals::~Arrivals() = default;

void Arrivals::append(Arrivals&& later) {
  const auto move = [](auto& to, auto& from) {
    to.insert(to.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
  };
  move(contents, later.contents);
  move(texts, later.texts);
  move(prototypes, later.prototypes);
  move(outlines, later.outlines);
  move(images, later.images);
  move(media, later.media);
  move(clouds, later.clouds);
  move(feeds, later.feeds);
  move(progress, later.progress);
  move(outside, later.outside);
  diagnostics.append(later.diagnostics);
}

void set_cloud(OpenedWorld& world, const Arrivals::Cloud& arrival) {
  vrml::SceneGraph& scene = *arrival.place.scene;
  const vrml::Node* node = &scene.node(arrival.place.node);
  std::shared_ptr<const qnv::Geometry>& held = world.clouds[node];
  if (arrival.image)
    world.images[node] = arrival.image;
  else
    world.images.erase(node);
  auto transfer = transfer_of(scene.get<vrml::MFFloat>(arrival.place.node, "transfer"));
  if (transfer.empty()) {
    held = arrival.cloud;
  } else {
    held = nullptr;
    if (has_room_for(*arrival.cloud, *scene.budget())) {
      qnv::Geometry own = *arrival.cloud;
      own.base().description.transfer = std::move(transfer);
      held = hold_geometry(std::move(own), scene.budget());
    }
    if (!held) {
      held = arrival.cloud;
      world.diagnostics.add(
          {Severity::warning, node->text->file_name(), node->location,
           "QNV: with its own transfer function, " + scene.budget()->refusal(Resource::vectors) + "; left out"});
    }
  }
  if (!arrival.fallback) return;
  vrml::Node& instance = scene.node(arrival.fallback);
  instance.expansion = {};
  instance.expansion.push_back(arrival.place.node);
}

void set_outlines(OpenedWorld& world, const Arrivals::Outlines& arrival) {
  vrml::Node& node = arrival.place.scene->node(arrival.place.node);
  for (const auto& [field, value] : arrival.fields) node.values[field->slot] = value;
  world.outlines[&node] = arrival.held;
}

std::vector<Arrivals::Place> take_in(OpenedWorld& world, Arrivals&& arrivals) {
  std::vector<Arrivals::Place> changed;
  for (const Arrivals::Image& one : arrivals.images)
    for (const Arrivals::Place& texture : one.textures) {
      const render::ImagePlace place(&texture.scene->node(texture.node), texture.url);
      if (one.image)
        world.images[place] = one.image;
      else
        world.images.erase(place);
      changed.push_back(texture);
    }
  for (const Arrivals::Media& one : arrivals.media)
    for (const Arrivals::Place& player : one.players) {
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
  for (const Arrivals::Cloud& one : arrivals.clouds) {
    if (one.cloud)
      set_cloud(world, one);
    else if (const vrml::Node* node = &one.place.scene->node(one.place.node); world.clouds.erase(node) > 0)
      world.images.erase(node);
    changed.push_back(one.place);
  }
  world.feeds.insert(world.feeds.end(), arrivals.feeds.begin(), arrivals.feeds.end());
  world.outside.insert(world.outside.end(), arrivals.outside.begin(), arrivals.outside.end());
  world.diagnostics.append(arrivals.diagnostics);
  return changed;
}

}  // namespace gs::app
