#include "vrml/events/idle_sensors.h"

#include "base/finite.h"
#include "vrml/events/execution.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kMaxMovers = 64;     // transforming nodes above a sensor; more are not worth the references
constexpr std::size_t kMaxBelow = 10'000;  // nodes below a moved node that are visited to find resting sensors
constexpr std::uint8_t kMaxNapDelay = 63;  // steps
// Relative margins for rounding errors of the exact test, which computes in the space of the sensor.
constexpr double kBoxMargin = 1e-6, kPathMargin = 1e-9;

float rounded_down(double number) {
  return std::nextafter(static_cast<float>(number), -std::numeric_limits<float>::infinity());
}

float rounded_up(double number) {
  return std::nextafter(static_cast<float>(number), std::numeric_limits<float>::infinity());
}

double largest(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

ViewerMoment IdleSensors::moment() {
  WorldViewer& viewer = execution_.viewer();
  return {glm::dvec3(viewer.pose()[3]), execution_.now(), viewer.jumps()};
}

void IdleSensors::begin_step() {
  recorded_ = false;
  if (nodes_.empty()) return;
  follow_hierarchy();
  const ViewerMoment now = moment();
  wake_met(last_.position, now.position);
  last_ = now;
  recorded_ = true;
}

void IdleSensors::follow_hierarchy() {
  Placement& placement = execution_.placement();
  const Placement::Moved moved = placement.take_moved();
  bool all = moved.all;
  for (std::size_t i = 0; i < moved.tops.size() && !all; ++i) {
    if (!moved.tops[i].scene->contains(moved.tops[i].node)) continue;
    all = !placement.each_below(moved.tops[i], kMaxBelow, [&](const NodePlace& place) {
      const SceneState* state = execution_.scenes().find(place.scene);
      if (const EventNode node = state ? state->member_of(place.node) : 0) wake(node);
    });
  }
  if (all) wake_all();
}

void IdleSensors::wake_met(const glm::dvec3& from, const glm::dvec3& to) {
  if (!finite(from) || !finite(to)) return wake_all();
  const double margin = kPathMargin * (largest(from) + largest(to));
  std::array<float, 3> low{}, high{};
  for (int i = 0; i < 3; ++i) {
    low[static_cast<std::size_t>(i)] = rounded_down(std::min(from[i], to[i]) - margin);
    high[static_cast<std::size_t>(i)] = rounded_up(std::max(from[i], to[i]) + margin);
  }
  std::vector<EventNode> met;
  const float *lx = lower_[0].data(), *ly = lower_[1].data(), *lz = lower_[2].data();
  const float *ux = upper_[0].data(), *uy = upper_[1].data(), *uz = upper_[2].data();
  // Tests eight boxes at a time without branches, because few are met.
  constexpr std::size_t kBlock = 8;
  const std::size_t count = nodes_.size();
  for (std::size_t first = 0; first < count; first += kBlock) {
    const std::size_t end = std::min(first + kBlock, count);
    unsigned any = 0;
    for (std::size_t i = first; i < end; ++i)
      any |= static_cast<unsigned>(lx[i] <= high[0]) & static_cast<unsigned>(ux[i] >= low[0]) &
             static_cast<unsigned>(ly[i] <= high[1]) & static_cast<unsigned>(uy[i] >= low[1]) &
             static_cast<unsigned>(lz[i] <= high[2]) & static_cast<unsigned>(uz[i] >= low[2]);
    if (any == 0) continue;
    for (std::size_t i = first; i < end; ++i)
      if (lx[i] <= high[0] && ux[i] >= low[0] && ly[i] <= high[1] && uy[i] >= low[1] && lz[i] <= high[2] &&
          uz[i] >= low[2])
        met.push_back(nodes_[i]);
  }
  for (const EventNode node : met) {
    execution_.nodes()[node].nap_delay = 0;
    wake(node);
  }
}

bool IdleSensors::rests(const Ref& ref) const {
  const std::uint32_t place = execution_.nodes()[ref.node].idle;
  return place != 0 && nodes_[place - 1] == ref.node && serials_[place - 1] == ref.serial;
}

// Draws memory for one more node with `refs` references.
bool IdleSensors::afford(std::size_t refs) {
  constexpr std::size_t kEntry = 64, kRef = 96;  // bytes, with the spare capacity of growing lists
  const std::size_t wanted = (nodes_.size() + 1) * (kEntry + refs * kRef);
  if (wanted <= afforded_) return true;
  full_ = full_ || !execution_.budget().afford(wanted - afforded_);
  if (full_) return false;
  afforded_ = wanted;
  return true;
}

void IdleSensors::refer(EventNode node, std::span<const Placement::Path> paths, std::uint32_t serial) {
  for (const Placement::Path& path : paths)
    for (const NodePlace& mover : path) {
      std::vector<Ref>& refs = below_[&mover.scene->node(mover.node)];
      if (refs.size() == refs.capacity()) std::erase_if(refs, [&](const Ref& ref) { return !rests(ref); });
      refs.push_back({node, serial});
    }
}

bool IdleSensors::take(EventNode node) {
  EventMember& at = execution_.nodes()[node];
  const auto idle_box = at.schema->behaviour->idle_box;
  if (!idle_box || at.looking) return false;
  if (at.nap_wait > 0) {
    --at.nap_wait;
    return false;
  }
  const std::optional<WideBox> box = idle_box(execution_, node);
  if (!box) return false;
  if (nodes_.empty()) (void)execution_.placement().take_moved();
  if (!std::exchange(recorded_, true)) last_ = moment();
  const double margin = box->empty() ? 0 : kBoxMargin * std::max(largest(box->lower), largest(box->upper));
  std::array<float, 3> low{}, high{};
  bool inside = finite(last_.position);
  for (int i = 0; i < 3; ++i) {
    const auto k = static_cast<std::size_t>(i);
    low[k] = rounded_down(box->lower[i] - margin);
    high[k] = rounded_up(box->upper[i] + margin);
    inside = inside && last_.position[i] >= low[k] && last_.position[i] <= high[k];
  }
  const std::span<const Placement::Path> paths = execution_.placement().paths_of(*at.scene, at.id);
  std::size_t refs = 0;
  for (const Placement::Path& path : paths) refs += path.size();
  if (inside || refs > kMaxMovers || !afford(refs)) return false;
  nodes_.push_back(node);
  serials_.push_back(++serial_);
  for (std::size_t k = 0; k < 3; ++k) {
    lower_[k].push_back(low[k]);
    upper_[k].push_back(high[k]);
  }
  at.idle = static_cast<std::uint32_t>(nodes_.size());
  refer(node, paths, serial_);
  return true;
}

// Removes a resting node from the lists.
void IdleSensors::leave(EventNode node) {
  EventNodes& nodes = execution_.nodes();
  const std::uint32_t place = std::exchange(nodes[node].idle, 0) - 1;
  const auto fill = [&](auto& list) {
    list[place] = list.back();
    list.pop_back();
  };
  nodes[nodes_.back()].idle = nodes_.back() == node ? 0 : place + 1;
  fill(nodes_);
  fill(serials_);
  for (std::size_t k = 0; k < 3; ++k) {
    fill(lower_[k]);
    fill(upper_[k]);
  }
}

void IdleSensors::wake(EventNode node) {
  if (execution_.nodes()[node].idle == 0) return;
  leave(node);
  execution_.nodes().behaviour_of(node).after_idle(execution_, node, last_);
  woken_.push_back(node);
}

void IdleSensors::wake_all() {
  while (!nodes_.empty()) wake(nodes_.back());
  below_.clear();
}

void IdleSensors::node_moved(const Node& node) {
  const auto found = below_.find(&node);
  if (found == below_.end()) return;
  const std::vector<Ref> refs = std::move(found->second);
  below_.erase(found);
  for (const Ref& ref : refs) {
    if (!rests(ref)) continue;
    // A sensor that moves often rests rarely, because falling asleep and waking cost more than a call.
    EventMember& at = execution_.nodes()[ref.node];
    at.nap_delay = static_cast<std::uint8_t>(std::min<int>(2 * at.nap_delay + 1, kMaxNapDelay));
    at.nap_wait = at.nap_delay;
    wake(ref.node);
  }
}

void IdleSensors::remove(EventNode node) {
  if (execution_.nodes()[node].idle != 0) leave(node);
}

void IdleSensors::forget_removed() {
  std::erase_if(woken_, [&](EventNode node) { return execution_.nodes().is_removed(node); });
}

}  // namespace gs::vrml
