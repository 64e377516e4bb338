#include "vrml/events/key_device.h"

#include "vrml/events/execution.h"

#include <algorithm>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kMaxHeld = 64;

}  // namespace

void KeyDevice::add(EventNode node) {
  if (std::find(nodes_.begin(), nodes_.end(), node) == nodes_.end()) nodes_.push_back(node);
}

void KeyDevice::remove(EventNode node) { std::erase(nodes_, node); }

bool KeyDevice::is_sensed() const {
  return std::any_of(nodes_.begin(), nodes_.end(),
                     [&](EventNode node) { return execution_.get<SFBool>(node, kKeySensorEnabled); });
}

void KeyDevice::send(const KeyStroke& stroke) {
  KeyStroke sent = stroke;
  switch (stroke.kind) {
    case KeyStroke::Kind::press:
      if (held_.size() >= kMaxHeld) held_.clear();
      held_[last_ = stroke.key] = stroke;
      break;
    case KeyStroke::Kind::character:
      if (const auto key = held_.find(last_); key != held_.end()) key->second.character = stroke.character;
      break;
    case KeyStroke::Kind::release:
      if (const auto key = held_.find(stroke.key); key != held_.end()) {
        sent = key->second;
        sent.kind = KeyStroke::Kind::release;
        held_.erase(key);
      }
      break;
  }
  deliver(sent);
}

void KeyDevice::deliver(const KeyStroke& stroke) {
  if (!is_sensed()) return;
  execution_.cascade().begin_update();
  for (const EventNode node : nodes_)
    if (execution_.get<SFBool>(node, kKeySensorEnabled) && execution_.budget().spend(EventBudget::kDelivery))
      execution_.nodes().behaviour_of(node).on_key(execution_, node, stroke);
  execution_.cascade().drain();
}

void KeyDevice::release_all() {
  std::vector<KeyStroke> strokes;
  for (auto& [key, stroke] : std::exchange(held_, {})) strokes.push_back(stroke);
  std::sort(strokes.begin(), strokes.end(), [](const auto& a, const auto& b) { return a.key < b.key; });
  for (KeyStroke& stroke : strokes) {
    stroke.kind = KeyStroke::Kind::release;
    deliver(stroke);
  }
}

}  // namespace gs::vrml
