#include "app/session/viewports/session_viewports.h"

#include "app/streams/stream_feed.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace gs::app {

Viewport SessionViewports::place_of(std::size_t pane) const {
  const std::vector<std::size_t> sight = panes_.visible();
  const std::vector<Viewport> rectangles = places();
  for (std::size_t i = 0; i < sight.size(); ++i)
    if (sight[i] == pane) return rectangles[i];
  return area_;
}

Viewport SessionViewports::place_of(const View& view) const {
  for (std::size_t i = 0; i < kMaxViewports; ++i)
    if (panes_.at(i).view() == &view) return place_of(i);
  return area_;
}

void SessionViewports::observe(std::function<void()> before_change, std::function<void(std::size_t pane)> forgotten) {
  before_change_ = std::move(before_change);
  forgotten_ = std::move(forgotten);
}

void SessionViewports::change_split(SplitTree split) {
  release_pointer();
  announce_change();
  panes_.set_split(std::move(split));
  if (linked_) panes_.link(panes_.active());
  step_.frame.news = true;
}

void SessionViewports::move_divider(const SplitDivider& divider, int place, int least, bool ended) {
  panes_.set_shape(with_divider_at(panes_.split(), divider, area_, place, least));
  step_.frame.changed = true;
  step_.frame.news = step_.frame.news || ended;
}

void SessionViewports::forget(std::size_t pane) {
  forgotten_(pane);
  for (const DocumentList::Entry& entry : panes_.documents().entries())
    if (entry.document)
      for (const auto& feed : entry.document->world.feeds) feed->forget(static_cast<std::uint32_t>(pane));
  if (leader_ == pane) lead_active();
}

void SessionViewports::activate(std::size_t pane) {
  const std::vector<std::size_t> sight = panes_.visible();
  panes_.activate(pane);
  if (panes_.visible() != sight) release_pointer();
}

void SessionViewports::set_linked(bool linked) {
  linked_ = linked;
  if (linked_) panes_.link(panes_.active());
}

void SessionViewports::set_style(const ViewStyle& style) {
  loading_.set_style(style);
  for (std::size_t i = 0; i < kMaxViewports; ++i)
    for (auto& [path, seen] : panes_.at(i).views) {
      seen.style.backdrop = style.backdrop;
      seen.style.axes = style.axes;
    }
}

}  // namespace gs::app
