#include "vrml/events/url_loads.h"

#include "vrml/events/execution.h"

#include <algorithm>

namespace gs::vrml {
namespace {

bool has_url(const Node& node) {
  const std::vector<const InterfaceDeclaration*> fields = node.type->url_fields();
  return std::any_of(fields.begin(), fields.end(), [&](const InterfaceDeclaration* field) {
    return !std::get<MFString>(node.values[field->slot]).empty();
  });
}

}  // namespace

void UrlLoads::note(const Node& node, UrlLoad state) {
  if (state == UrlLoad::pending) ended_ = false;
  states_[&node] = state;
  wake();
}

void UrlLoads::end() {
  ended_ = true;
  wake();
}

void UrlLoads::wake() {
  for (const EventNode sensor : sensors_) execution_.timers().call_at(sensor, execution_.now());
}

UrlLoads::Counts UrlLoads::count(const SceneGraph& scene, const MFNode& nodes) const {
  Counts counts;
  for (const NodeId each : nodes) {
    const NodeId id = scene.resolve(each);
    if (!id || scene.node(id).type->url_content == UrlContent::none) continue;
    const Node& node = scene.node(id);
    if (!may_load(node) || !has_url(node)) continue;
    const auto found = states_.find(&node);
    UrlLoad state = found == states_.end() ? UrlLoad::pending : found->second;
    if (state == UrlLoad::pending && ended_) state = UrlLoad::failed;
    ++(state == UrlLoad::loaded ? counts.loaded : state == UrlLoad::failed ? counts.failed : counts.pending);
  }
  return counts;
}

}  // namespace gs::vrml
