#pragma once

#include "app/world/opened_world.h"
#include "vrml/scene/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace gs::app {

/// What has come for a world that lives already: made by the thread that reads, taken in by the one that owns the
/// world.
struct Arrivals {
  struct Place {
    vrml::SceneGraph* scene = nullptr;  // the root or the content of an Inline; touched by the world's thread only
    vrml::NodeId node;
    std::size_t url = 0;  // of NodeType::url_fields, for images
  };
  struct Image {
    std::vector<Place> textures;
    std::shared_ptr<const render::Image> image;
  };
  struct Cloud {
    Place place;            // of a QNV node
    vrml::NodeId fallback;  // the PROTO instance in whose place it is shown; null: none
    std::shared_ptr<const qnv::Cloud> cloud;
  };
  std::vector<Image> images;
  std::vector<Cloud> clouds;
  std::vector<std::shared_ptr<StreamFeed>> feeds;
  std::vector<UrlProgress> progress;
  vrml::Diagnostics diagnostics;
  std::vector<OutsideFolder> outside;

  [[nodiscard]] bool empty() const {
    return images.empty() && clouds.empty() && feeds.empty() && progress.empty() && diagnostics.entries().empty() &&
           outside.empty();
  }
  /// Puts what has come later behind.
  void append(Arrivals&& later);
};

/// Gives a QNV node its vectors; a transfer function of its own goes before that of the stream.
void set_cloud(OpenedWorld& world, const Arrivals::Cloud& arrival);
/// Gives all to the world but `progress`, which is its events'. The nodes that look otherwise from then on.
[[nodiscard]] std::vector<Arrivals::Place> take_in(OpenedWorld& world, Arrivals&& arrivals);

}  // namespace gs::app
