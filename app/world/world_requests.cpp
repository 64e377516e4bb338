#include "app/world/scene_handler.h"
#include "app/world/world_loading.h"

#include <algorithm>
#include <iterator>
#include <utility>

// Urls that are set in a running world. This code does not read the world's nodes.
namespace gs::app {

void WorldLoading::State::request(std::vector<UrlRequest> requests) {
  if (!root || !taken) return;
  const auto time = std::chrono::duration<double>(std::clamp(options.timeout_seconds, 0.0, 1e6));
  limit = LoadLimit(
      std::chrono::steady_clock::now() + std::chrono::duration_cast<std::chrono::steady_clock::duration>(time),
      options.cancelled);
  // Starts a new count of files if no earlier fetch continues.
  if (fetches.empty()) {
    files = 0;
    phase = Phase::done;
  }
  for (const UrlRequest& one : requests)
    if (SceneHandler* const handler = root->handler_of(one.place.scene)) handler->load(one);
}

void WorldLoading::State::withdraw(const SceneHandler& handler) {
  for (const auto& one : fetches) {
    // A fetch that was withdrawn earlier may belong to a handler that no longer exists.
    if (std::find(ended.begin(), ended.end(), one.get()) != ended.end()) continue;
    const SceneHandler* const of = one->handler->makes_nodes_of();
    if (!of || !of->is_inside(handler)) continue;
    std::erase(local, one.get());
    ledger->end(one->row, LoadStage::cancelled, "another URL was set");
    stop_cells(one.get());
    if (by_request.erase(one->request.value) > 0) loader->cancel(one->request);
    ended.push_back(one.get());
  }
  std::erase_if(withheld, [&](const auto& one) { return one->is_inside(handler); });
}

// Hands over the content of an Inline with its meshes, so that the drawing thread need not make them.
void WorldLoading::State::give_content(SceneHandler& handler) {
  ResourceUpdates::Content update{*handler.given_to, handler.give_content(), {}};
  if (update.content) (void)render::collect(*update.content, {}, update.meshes, viewer, {});
  updates.contents.push_back(std::move(update));
}

// Returns the updates. They include the content of an Inline once its own file is complete.
ResourceUpdates WorldLoading::State::take_updates() {
  give_outlines();
  const auto goes_on = [&](const SceneHandler& handler) {
    return !handler.nothing_more_comes() && std::any_of(fetches.begin(), fetches.end(), [&](const auto& fetch) {
      return fetch->handler.get() == &handler && std::find(ended.begin(), ended.end(), fetch.get()) == ended.end();
    });
  };
  // Handing over a content appends its inner Inlines to the list.
  for (std::size_t i = 0; i < withheld.size();) {
    if (goes_on(*withheld[i])) {
      ++i;
      continue;
    }
    const std::shared_ptr<SceneHandler> one = withheld[i];
    withheld.erase(withheld.begin() + static_cast<std::ptrdiff_t>(i));
    give_content(*one);
  }
  ResourceUpdates taken_now = std::exchange(updates, {});
  const auto is_withheld = [&](const vrml::SceneGraph* scene) {
    return std::any_of(withheld.begin(), withheld.end(), [&](const auto& one) { return one->handler_of(scene); });
  };
  const auto keep = [&](auto& from, auto& to, const auto& scene_of) {
    const auto kept =
        std::stable_partition(from.begin(), from.end(), [&](const auto& one) { return !is_withheld(scene_of(one)); });
    to.insert(to.end(), std::make_move_iterator(kept), std::make_move_iterator(from.end()));
    from.erase(kept, from.end());
  };
  if (!withheld.empty()) {
    keep(taken_now.outlines, updates.outlines, [](const ResourceUpdates::Outlines& one) { return one.place.scene; });
    keep(taken_now.clouds, updates.clouds, [](const ResourceUpdates::Cloud& one) { return one.place.scene; });
    keep(taken_now.texts, updates.texts, [](const ResourceUpdates::Text& one) { return one.place.scene; });
    keep(taken_now.progress, updates.progress, [](const UrlProgress& one) { return one.scene; });
    for (ResourceUpdates::Image& one : taken_now.images) {
      ResourceUpdates::Image kept{{}, one.image};
      keep(one.textures, kept.textures, [](const ResourceUpdates::Place& place) { return place.scene; });
      if (!kept.textures.empty()) updates.images.push_back(std::move(kept));
    }
    for (ResourceUpdates::Media& one : taken_now.media) {
      ResourceUpdates::Media kept{{}, one.media, one.image};
      keep(one.players, kept.players, [](const ResourceUpdates::Place& place) { return place.scene; });
      if (!kept.players.empty()) updates.media.push_back(std::move(kept));
    }
  }
  taken_now.feeds = std::exchange(world.feeds, {});
  taken_now.outside = std::exchange(world.outside, {});
  taken_now.diagnostics = std::exchange(world.diagnostics, Diagnostics());
  return taken_now;
}

}  // namespace gs::app
