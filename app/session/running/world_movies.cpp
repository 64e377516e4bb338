#include "app/session/running/world_movies.h"

#include "app/media/media_file.h"
#include "vrml/behaviours/browser_events.h"

#include <string>
#include <utility>

namespace gs::app {

void WorldMovies::open(const MediaDuration& of) {
  const vrml::Node* node = &of.scene->node(of.node);
  forget(*node);
  const auto file = world_.media.find(node);
  const auto image = world_.images.find(node);
  if (file == world_.media.end() || image == world_.images.end() || !image->second || !file->second->info.pictures)
    return;
  auto player = players_.open(file->second, *image->second, world_.scene->budget());
  if (!player) {
    world_.diagnostics.add({Severity::warning, node->text->file_name(), node->location,
                            node->type->name + ": " + world_.scene->budget()->refusal(Resource::pixels) +
                                "; only its first picture is shown"});
    return;
  }
  image->second = player->image();
  movies_.push_back({of.scene, of.node, node, std::move(player)});
}

bool WorldMovies::show(bool wait) {
  bool any = false;
  running_ = false;
  for (const Played& one : movies_) {
    if (!one.player->shown()) continue;
    const auto play = vrml::media_play(execution_, *one.scene, one.id);
    if (!play) continue;
    if (players_.show(one.player, play->position, wait)) any = ++pictures_ > 0;
    if (const std::string problem = players_.take_problem(*one.player); !problem.empty())
      world_.diagnostics.add({Severity::warning, one.node->text->file_name(), one.node->location,
                              one.node->type->name + ": " + problem + "; its last picture stays"});
    running_ = running_ || (play->active && play->rate != 0) || (!wait && players_.waits(*one.player));
  }
  return any;
}

void WorldMovies::forget(const vrml::Node& node) {
  std::erase_if(movies_, [&](const Played& movie) { return movie.node == &node; });
}

}  // namespace gs::app
