#include "app/interface/dock/dock.h"

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

constexpr std::array<float, kDockSides> kFirstSizes = {260, 376, 190};  // by DockSide: width or height at scale 1

}  // namespace

Dock::Dock(const std::vector<DockSide>& sides) {
  for (const DockSide side : sides) panels_.push_back({side});
  for (std::size_t i = 0; i < kDockSides; ++i) areas_[i].size = kFirstSizes[i];
}

bool Dock::is_open(std::size_t panel) const {
  if (panel >= panels_.size()) return false;
  const std::vector<std::size_t>& open = area(panels_[panel].side).open;
  return std::find(open.begin(), open.end(), panel) != open.end();
}

bool Dock::is_front(std::size_t panel) const {
  return panel < panels_.size() && area(panels_[panel].side).front == panel;
}

void Dock::open(std::size_t panel) {
  if (panel >= panels_.size()) return;
  Area& where = area(panels_[panel].side);
  if (!is_open(panel)) where.open.push_back(panel);
  where.front = panel;
}

void Dock::close(std::size_t panel) {
  if (!is_open(panel)) return;
  Area& where = area(panels_[panel].side);
  const auto place = std::find(where.open.begin(), where.open.end(), panel);
  const auto index = static_cast<std::size_t>(place - where.open.begin());
  where.open.erase(place);
  if (where.front != panel) return;
  where.front.reset();
  if (!where.open.empty()) where.front = where.open[std::min(index, where.open.size() - 1)];
}

void Dock::toggle(std::size_t panel) {
  if (is_front(panel))
    close(panel);
  else
    open(panel);
}

void Dock::move(std::size_t panel, DockSide side) {
  if (panel >= panels_.size() || panels_[panel].side == side) return;
  const bool was_open = is_open(panel);
  close(panel);
  panels_[panel].side = side;
  if (was_open) open(panel);
}

void Dock::set_size(DockSide side, float size) {
  if (std::isfinite(size)) area(side).size = std::clamp(size, kMinArea, kMaxArea);
}

DockLayout Dock::lay_out(const DockRectangle& whole, float scale) const {
  DockLayout layout;
  const float divider = std::max(1.0f, std::round(kDivider * scale));
  const auto wanted = [&](DockSide side) {
    return area(side).open.empty() ? 0.0f : std::round(area(side).size * scale) + divider;
  };
  float left = wanted(DockSide::left), right = wanted(DockSide::right), bottom = wanted(DockSide::bottom);
  // If there is too little room, shrink all areas in proportion.
  const float wide = std::max(0.0f, whole.width - std::round(kMinPicture * scale));
  if (left + right > wide) {
    const float part = wide / (left + right);
    left = std::floor(left * part);
    right = std::floor(right * part);
  }
  bottom = std::min(bottom, std::max(0.0f, whole.height - std::round(kMinHeight * scale)));
  DockRectangle picture{whole.left + left, whole.top, std::max(1.0f, whole.width - left - right),
                        std::max(1.0f, whole.height - bottom)};
  const auto put = [&](DockSide side, const DockRectangle& place, const DockRectangle& line) {
    if (!area(side).open.empty()) layout.areas[static_cast<std::size_t>(side)] = DockLayout::Area{place, line};
  };
  put(DockSide::left, {whole.left, whole.top, std::max(0.0f, left - divider), whole.height},
      {whole.left + std::max(0.0f, left - divider), whole.top, std::min(left, divider), whole.height});
  const float edge = whole.left + whole.width - right;
  put(DockSide::right, {edge + std::min(right, divider), whole.top, std::max(0.0f, right - divider), whole.height},
      {edge, whole.top, std::min(right, divider), whole.height});
  const float below = picture.top + picture.height;
  put(DockSide::bottom,
      {picture.left, below + std::min(bottom, divider), picture.width, std::max(0.0f, bottom - divider)},
      {picture.left, below, picture.width, std::min(bottom, divider)});
  layout.picture = picture;
  return layout;
}

float Dock::size_for(DockSide side, float place, const DockRectangle& whole, float scale) {
  const float units = std::max(scale, 0.01f), half = kDivider / 2;
  switch (side) {
    case DockSide::left:
      return (place - whole.left) / units - half;
    case DockSide::right:
      return (whole.left + whole.width - place) / units - half;
    case DockSide::bottom:
      break;
  }
  return (whole.top + whole.height - place) / units - half;
}

}  // namespace gs::app
