#include "app/world/outline_handler.h"
#include "app/world/scene_handler.h"
#include "app/world/shared_image.h"

#include <algorithm>
#include <utility>

// Urls that are set in a running world. The node keeps its present content until new content is available or missing.
namespace gs::app {

void SceneHandler::load(const UrlRequest& request) {
  if (request.prototype) return load_prototype(request);
  Reference reference = refer(request.urls, request.source, request.fetched);
  const Arrivals::Place& at = request.place;
  if (request.as_text) return load_text(request, std::move(reference));
  switch (request.content) {
    case vrml::UrlContent::scene:
      return load_inline(request, std::move(reference));
    case vrml::UrlContent::image: {
      if (reference.places.empty()) return world_.image_arrived({{at}, nullptr});
      std::erase_if(world_.shared_images, [](const auto& one) { return one.second->is_spent(); });
      auto& shared = world_.shared_images[fetch_key(reference.places, reference.from)];
      const bool fresh = !shared || shared->has_none();
      if (fresh)
        shared = std::make_shared<WorldLoading::State::SharedImage>(world_, request.type, request.file,
                                                                    request.location, request.urls);
      shared->add(at);
      if (fresh) ask_for(std::move(reference), request.node, shared, Urgency::texture);
      return;
    }
    case vrml::UrlContent::vectors: {
      if (reference.places.empty()) return world_.cloud_arrived({at, {}, nullptr});
      auto handler = std::make_shared<CloudHandler>(
          world_, CloudHandler::Place{request.file, request.location, request.urls, true},
          [&world = world_, at](const std::shared_ptr<const qnv::Geometry>& cloud) {
            world.cloud_arrived({at, {}, cloud});
          },
          [&world = world_, at](double fraction) {
            world.note_progress({at.scene, at.node, fraction});
          });
      return ask_for(std::move(reference), request.node, std::move(handler), Urgency::vectors);
    }
    case vrml::UrlContent::outlines: {
      auto handler =
          std::make_shared<OutlineHandler>(world_, at, request.file, request.location, request.urls, nullptr);
      if (reference.places.empty()) return handler->give();
      return ask_for(std::move(reference), request.node, std::move(handler), Urgency::vectors);
    }
    case vrml::UrlContent::sound:
    case vrml::UrlContent::movie:
      return load_media(request, std::move(reference));
    case vrml::UrlContent::none:
      return;
  }
}

void SceneHandler::load_inline(const UrlRequest& request, Reference reference) {
  // The results of the former url are not needed any more.
  const auto is_former = [&](const std::shared_ptr<SceneHandler>& one) {
    return one->inline_node == request.place.node;
  };
  for (const auto& one : inner_)
    if (is_former(one)) world_.withdraw(*one);
  std::erase_if(inner_, is_former);
  if (reference.places.empty()) {
    world_.arrivals.contents.push_back({request.place, nullptr, {}});
    return;
  }
  auto inner = std::make_shared<SceneHandler>(world_, Role::inlined, this);
  inner->what = "Inline";
  inner->urls = request.urls;
  inner->inline_node = request.place.node;
  inner->given_to = request.place;
  inner->place_file = request.file;
  inner->place = request.location;
  inner_.push_back(inner);
  world_.withheld.push_back(inner);
  ask_for(std::move(reference), request.node, std::move(inner), Urgency::inline_scene);
}

}  // namespace gs::app
