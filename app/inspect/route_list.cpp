#include "app/inspect/route_list.h"

#include "base/text.h"

#include <algorithm>

namespace gs::app {

std::string label_of(const NodeAt& node) {
  constexpr std::size_t kMax = 80;
  if (!node || !node.scene->contains(node.id)) return "(gone)";
  const vrml::Node& of = node.scene->node(node.id);
  return shortened(of.name.empty() ? std::string_view(of.type->name) : of.name, kMax);
}

void RouteList::refresh(const vrml::Execution* world, const NodeAt& selected) {
  const NodeAt only = only_selected_ ? selected : NodeAt{};
  const std::uint64_t revision = world ? world->routes().revision() : 0;
  if (world == world_ && only == only_ && revision == revision_) return;
  world_ = world;
  only_ = only;
  revision_ = revision;
  ++made_;
  rows_.clear();
  all_ = 0;
  if (!world) return;
  for (const vrml::PlacedRoute& one : world->routes().all()) {
    ++all_;
    const Row row{{one.scene, one.route.from}, {one.to_scene, one.route.to}, one.route.event_out, one.route.event_in};
    if (!only || row.from == only || row.to == only) rows_.push_back(row);
  }
}

float RouteList::light_of(const Row& row, const EventWatch& watch, double now) {
  constexpr double kSeconds = 0.5;
  const EventWatch::Seen* const seen = watch.find(row.from, *row.event_out);
  return seen ? static_cast<float>(std::clamp(1 - (now - seen->time) / kSeconds, 0.0, 1.0)) : 0.0f;
}

}  // namespace gs::app
