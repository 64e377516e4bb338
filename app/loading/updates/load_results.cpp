#include "app/loading/updates/load_results.h"

#include "app/loading/updates/live_data.h"

#include "app/media/media_file.h"
#include "base/text.h"
#include "net/base/url_signature.h"

#include <algorithm>
#include <iterator>

namespace gs::app {
namespace {

std::string title_of(const vrml::SceneGraph& scene) {
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const vrml::NodeId id = scene.nodes().id_at(i);
    const vrml::Node& node = scene.nodes().at(i);
    if (node.in_prototype_body || node.type->read_as != vrml::NodeKind::world_info) continue;
    std::string title = scene.get<vrml::SFString>(id, "title").str();
    if (!title.empty()) return title;
  }
  return std::string(scene.x3d().meta("title"));
}

// Returns all messages except those about steps that a simulation has dropped. A newer step follows.
Diagnostics without_gone(const Diagnostics& all) {
  const auto is_gone = [](const Diagnostic& one) { return one.message.find("410 Gone") != std::string::npos; };
  if (std::ranges::none_of(all.entries(), is_gone)) return all;  // with the number of those that were not stored
  Diagnostics kept;
  for (const Diagnostic& one : all.entries())
    if (!is_gone(one)) kept.add(one);
  return kept;
}

}  // namespace

LoadResults::LoadResults(std::string path, bool network_allowed, WorldBudget budget)
    : path_(std::move(path)), title_(file_name(net::without_signature(path_))), budget_(std::move(budget)) {
  if (net::is_presigned(path_)) file_ = net::without_signature(path_);
  world()->network_allowed = network_allowed;
}

void LoadResults::add(ResourceUpdates::Geometry geometry) {
  changed_ = true;
  if (const auto* mesh = geometry.geometry ? geometry.geometry->as<qnv::IndexedMesh>() : nullptr; mesh && mesh->picture)
    geometry.image = pictures_.image_of(mesh->picture, budget_);
  if (LoadedWorld* const read = world()) return set_geometry(*read, geometry, diagnostics_);
  for (ResourceUpdates::Geometry& earlier : updates().geometries)
    if (earlier.place.scene == geometry.place.scene && earlier.place.node == geometry.place.node &&
        earlier.place.request == geometry.place.request) {
      earlier.geometry = std::move(geometry.geometry);
      earlier.image = std::move(geometry.image);
      return;
    }
  updates().geometries.push_back(std::move(geometry));
}

void LoadResults::add_own(const ResourceUpdates::Place& place, std::shared_ptr<const qnv::Geometry> vectors) {
  if (LoadedWorld* const read = world())
    read->geometries[&place.scene->node(place.node)] = std::move(vectors);
  else
    add(ResourceUpdates::Geometry{place, {}, std::move(vectors)});
}

void LoadResults::add(ResourceUpdates::Image image) {
  changed_ = true;
  LoadedWorld* const read = world();
  if (!read) {
    updates().images.push_back(std::move(image));
  } else if (image.image) {
    for (const ResourceUpdates::Place& texture : image.textures)
      read->images[{&texture.scene->node(texture.node), texture.url}] = image.image;
  }
}

void LoadResults::add(ResourceUpdates::Media media) {
  changed_ = true;
  LoadedWorld* const read = world();
  if (!read) {
    updates().media.push_back(std::move(media));
    return;
  }
  for (const ResourceUpdates::Place& player : media.players) {
    const vrml::Node* node = &player.scene->node(player.node);
    if (media.media) read->media[node] = media.media;
    if (media.image) read->images[node] = media.image;
    read->durations.push_back({player.scene, player.node, media.media ? media.media->info.duration : -1});
  }
}

void LoadResults::add(ResourceUpdates::Text text) {
  if (LoadedWorld* const read = world())
    read->programs.push_back({text.place.scene, text.place.node, std::move(text.text), std::move(text.url)});
  else
    updates().texts.push_back(std::move(text));
}

void LoadResults::add(ResourceUpdates::Outlines outlines) {
  changed_ = true;
  if (LoadedWorld* const read = world())
    set_outlines(*read, outlines);
  else
    updates().outlines.push_back(std::move(outlines));
}

void LoadResults::add(ResourceUpdates::Content content) { updates().contents.push_back(std::move(content)); }

void LoadResults::add(ResourceUpdates::Prototypes prototypes) { updates().prototypes.push_back(std::move(prototypes)); }

void LoadResults::add(const UrlProgress& progress) {
  std::vector<UrlProgress>& all = world() ? world()->progress : updates().progress;
  for (UrlProgress& earlier : all)
    if (earlier.scene == progress.scene && earlier.node == progress.node) {
      earlier.fraction = progress.fraction;
      return;
    }
  all.push_back(progress);
}

bool LoadResults::refuse_folder(const std::string& folder, const std::string& reference) {
  constexpr std::size_t kMaxFolders = 64;
  const auto same = [&](const OutsideFolder& one) { return one.folder == folder; };
  if (std::any_of(outside_.begin(), outside_.end(), same)) return false;
  if (outside_.size() < kMaxFolders) outside_.push_back({folder, reference});
  return true;
}

LoadedWorld LoadResults::hand_over(std::unique_ptr<vrml::SceneGraph> scene) {
  LoadedWorld handed = std::move(std::get<LoadedWorld>(results_));
  results_.emplace<ResourceUpdates>();
  handed.path = path_;
  handed.title = title_;
  handed.feeds = std::exchange(feeds_, {});
  handed.outside = std::exchange(outside_, {});
  handed.diagnostics = std::exchange(diagnostics_, Diagnostics());
  handed.scene = std::move(scene);
  if (!handed.scene) return handed;
  if (std::string title = title_of(*handed.scene); !title.empty()) handed.title = std::move(title);
  handed.color_key = color_key_of(*handed.scene);
  handed.live = live_data_of(*handed.scene);
  live_ = !handed.live.empty();
  if (live_) handed.diagnostics = without_gone(handed.diagnostics);
  if (!handed.authored && !handed.steps) handed.steps = time_steps_of(*handed.scene);
  return handed;
}

ResourceUpdates LoadResults::take_updates(const std::function<bool(const vrml::SceneGraph*)>& is_withheld) {
  ResourceUpdates taken = std::exchange(updates(), {});
  ResourceUpdates& kept = updates();
  const auto keep = [&](auto& from, auto& to, const auto& scene_of) {
    const auto first =
        std::stable_partition(from.begin(), from.end(), [&](const auto& one) { return !is_withheld(scene_of(one)); });
    to.insert(to.end(), std::make_move_iterator(first), std::make_move_iterator(from.end()));
    from.erase(first, from.end());
  };
  const auto of_place = [](const auto& one) { return one.place.scene; };
  const auto of_scene = [](const auto& one) { return one.scene; };
  keep(taken.outlines, kept.outlines, of_place);
  keep(taken.geometries, kept.geometries, of_place);
  keep(taken.texts, kept.texts, of_place);
  keep(taken.progress, kept.progress, of_scene);
  for (ResourceUpdates::Image& one : taken.images) {
    ResourceUpdates::Image later{{}, one.image};
    keep(one.textures, later.textures, of_scene);
    if (!later.textures.empty()) kept.images.push_back(std::move(later));
  }
  for (ResourceUpdates::Media& one : taken.media) {
    ResourceUpdates::Media later{{}, one.media, one.image};
    keep(one.players, later.players, of_scene);
    if (!later.players.empty()) kept.media.push_back(std::move(later));
  }
  taken.feeds = std::exchange(feeds_, {});
  taken.outside = std::exchange(outside_, {});
  taken.diagnostics = std::exchange(diagnostics_, Diagnostics());
  if (live_) taken.diagnostics = without_gone(taken.diagnostics);
  return taken;
}

}  // namespace gs::app
