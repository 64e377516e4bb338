#include "app/view/viewports.h"

#include <algorithm>

namespace gs::app {

std::optional<std::size_t> viewport_at(std::span<const Viewport> viewports, const glm::vec2& pointer) {
  for (std::size_t i = 0; i < viewports.size(); ++i)
    if (viewports[i].contains(pointer)) return i;
  return std::nullopt;
}

std::optional<std::size_t> PointerRouter::route(const WindowEvent& event, std::span<const Viewport> viewports) {
  using Kind = WindowEvent::Kind;
  const bool button = event.kind == Kind::button_down || event.kind == Kind::button_up;
  if (!button && event.kind != Kind::pointer && event.kind != Kind::wheel && event.kind != Kind::drop)
    return std::nullopt;
  const unsigned bit = button ? 1u << static_cast<unsigned>(event.button) : 0u;
  const bool dragging = held_ != 0 && owner_ < viewports.size();
  const std::optional<std::size_t> under = viewport_at(viewports, event.pointer);
  // Wheel and drop events belong to the viewport under the pointer, even during a drag.
  const bool place_counts = event.kind == Kind::wheel || event.kind == Kind::drop;
  const std::optional<std::size_t> target = dragging && !place_counts ? std::optional(owner_) : under;
  if (event.kind == Kind::button_down && target) {
    owner_ = *target;
    held_ |= bit;
  }
  if (event.kind == Kind::button_up) held_ &= ~bit;
  return target;
}

std::vector<std::size_t> shares_of(std::size_t total, std::span<const std::size_t> weights) {
  double sum = 0;
  for (const std::size_t weight : weights) sum += static_cast<double>(weight);
  std::vector<std::size_t> shares;
  for (const std::size_t weight : weights) {
    const double share = sum > 0 ? static_cast<double>(total) * (static_cast<double>(weight) / sum) : 0;
    shares.push_back(
        weight == 0 ? 0 : std::clamp<std::size_t>(static_cast<std::size_t>(share), 1, std::max<std::size_t>(total, 1)));
  }
  return shares;
}

void Refinement::note(bool pending, std::size_t discs, bool changed) {
  frames_ = !changed && pending == pending_ && discs == discs_ ? std::min(frames_ + 1, kMaxFramesAlike) : 0;
  pending_ = pending;
  discs_ = discs;
}

}  // namespace gs::app
