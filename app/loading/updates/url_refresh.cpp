#include "app/loading/updates/url_refresh.h"

#include <algorithm>

namespace gs::app {
namespace {

constexpr double kShortest = 1;  // seconds between two loads, so that a world cannot flood a server

// Returns the value of an SFTime field; 0 if the node has none.
double time_in(const vrml::Node& node, std::string_view name) {
  const vrml::InterfaceDeclaration* const field = node.type->find_field(name);
  const auto* const value = field ? std::get_if<vrml::SFTime>(&node.values[field->slot]) : nullptr;
  return value ? *value : 0;
}

}  // namespace

void UrlRefresh::note(vrml::SceneGraph& scene, vrml::NodeId id) {
  const vrml::Node& node = scene.node(id);
  const bool has_content = node.type->kind == vrml::NodeType::Kind::built_in &&
                           node.type->url_content != vrml::UrlContent::none && !node.in_prototype_body;
  const double given = has_content ? time_in(node, "autoRefresh") : 0;
  if (!(given > 0)) return forget(node);
  const double interval = std::max(given, kShortest), limit = time_in(node, "autoRefreshTimeLimit");
  const auto known = entries_.find(&node);
  if (known != entries_.end() && known->second.interval == interval && known->second.limit == limit) return;
  const double now = execution_.now();
  entries_[&node] = {&scene, id, interval, limit, now + interval, now + limit};
}

void UrlRefresh::note_scene(vrml::SceneGraph& scene) {
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i)
    if (scene.nodes().at(i).type->url_content != vrml::UrlContent::none) note(scene, scene.nodes().id_at(i));
}

std::vector<vrml::NodeChange> UrlRefresh::take_due() {
  std::vector<vrml::NodeChange> due;
  const double now = execution_.now();
  for (auto at = entries_.begin(); at != entries_.end();) {
    const vrml::Node& node = *at->first;
    Entry& entry = at->second;
    const vrml::UrlLoad state = execution_.loads().state_of(node);
    if (now >= entry.next && (entry.next > entry.end || state == vrml::UrlLoad::failed)) {
      at = entries_.erase(at);
      continue;
    }
    if (now >= entry.next) {
      entry.next = std::max(entry.next + entry.interval, now);
      if (state != vrml::UrlLoad::pending && vrml::may_load(node)) due.push_back({entry.scene, entry.node, 0});
    }
    ++at;
  }
  return due;
}

std::optional<double> UrlRefresh::next_time() const {
  std::optional<double> next;
  for (const auto& [node, entry] : entries_) next = std::min(next.value_or(entry.next), entry.next);
  return next;
}

}  // namespace gs::app
