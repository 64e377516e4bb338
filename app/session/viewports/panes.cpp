#include "app/session/viewports/panes.h"

#include <algorithm>
#include <utility>

namespace gs::app {

View* Pane::view() {
  const auto place = views.find(shown);
  return place == views.end() ? nullptr : &place->second;
}

const View* Pane::view() const {
  const auto place = views.find(shown);
  return place == views.end() ? nullptr : &place->second;
}

void Panes::start(std::span<const std::string> paths, const std::optional<SplitTree>& split) {
  const std::size_t most = split ? kMaxViewports : kMaxViewportsAtStart;
  std::size_t count = 0;
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    documents_.add(path);
    if (count < most) panes_[count].wanted = path;
    ++count;
  }
  split_ = split.value_or(split_of(layout_for(count), 0));
  if (!split) return;
  active_ = visible().front();
  for (const std::size_t i : panes_of(split_))
    if (panes_[i].wanted.empty() && count > 0) panes_[i].wanted = documents_.entries().front().path;
}

void Panes::open(std::span<const std::string> paths) {
  bool first = true;
  for (const std::string& path : paths) {
    if (path.empty()) continue;
    documents_.add(path);
    if (std::exchange(first, false)) {
      want(active_, path);
      continue;
    }
    for (const std::size_t i : visible())
      if (panes_[i].wanted.empty() && !wanted_by_any(path)) want(i, path);
  }
}

void Panes::select(std::size_t file) {
  if (file < documents_.entries().size()) want(active_, documents_.entries()[file].path);
}

void Panes::reload(std::size_t pane) {
  panes_[pane].failure.reset();
  documents_.reload(panes_[pane].wanted);
}

void Panes::set_split(SplitTree split) {
  split_ = std::move(split);
  release_input();
  const std::size_t model = active_;
  const std::vector<std::size_t> sight = visible();
  if (std::find(sight.begin(), sight.end(), active_) == sight.end()) active_ = sight.front();
  // Leave viewports empty that report a failed file.
  for (const std::size_t i : sight)
    if (panes_[i].wanted.empty() && !panes_[i].failure) fill(i, model);
}

bool Panes::split_pane(std::size_t pane, SplitAxis axis) {
  const std::optional<std::size_t> added = free_pane();
  if (!added || !has_pane(split_, pane)) return false;
  panes_[*added] = {};
  fill(*added, pane);
  split_ = app::split_pane(std::move(split_), pane, axis, *added);
  release_input();
  active_ = *added;
  cancel_unwanted();
  return true;
}

// Returns the index of an empty hidden viewport; if there is none, that of any hidden viewport; nullopt if all are
// visible.
std::optional<std::size_t> Panes::free_pane() const {
  for (const bool with_file : {false, true})
    for (std::size_t i = 0; i < kMaxViewports; ++i)
      if (!has_pane(split_, i) && (with_file || panes_[i].wanted.empty())) return i;
  return std::nullopt;
}

bool Panes::close(std::size_t pane) {
  if (!has_pane(split_, pane)) return false;
  if (split_.root.parts.empty()) {
    if (panes_[pane].wanted.empty() && panes_[pane].shown.empty()) return false;
    panes_[pane] = {};
    cancel_unwanted();
    return true;
  }
  const std::size_t next = next_pane(split_, pane, -1);
  SplitTree split = without_pane(split_, pane);
  if (active_ == pane) active_ = has_pane(split, next) ? next : panes_of(split).front();
  panes_[pane] = {};
  set_split(std::move(split));
  cancel_unwanted();
  return true;
}

void Panes::show_in(std::size_t pane, const std::string& path) {
  documents_.add(path);
  want(pane, path);
}

void Panes::fill(std::size_t pane, std::size_t from) {
  for (const DocumentList::Entry& entry : documents_.entries())
    if (!wanted_by_any(entry.path)) {
      panes_[pane].wanted = entry.path;
      return;
    }
  const Pane& model = panes_[from];
  panes_[pane].wanted = model.wanted;
  panes_[pane].shown = model.shown;
  if (const View* view = model.view()) panes_[pane].views[model.shown] = *view;
}

void Panes::activate(std::size_t pane) {
  if (pane >= kMaxViewports || pane == active_) return;
  const std::vector<std::size_t> sight = visible();
  if (std::find(sight.begin(), sight.end(), pane) == sight.end()) {
    if (panes_[pane].wanted.empty()) return;
    const std::optional<ViewportLayout> layout = split_.maximised ? std::nullopt : layout_of(split_);
    if (has_pane(split_, pane))
      split_.maximised = pane;
    else if (layout && split_ == split_of(*layout, active_))
      split_ = split_of(*layout, pane);
    else
      split_ = with_replaced(std::move(split_), active_, pane);
  }
  panes_[active_].input.release();
  active_ = pane;
}

void Panes::link(std::size_t leader) {
  const View* from = panes_[leader].view();
  if (!from) return;
  for (const std::size_t i : visible())
    if (View* view = i == leader ? nullptr : panes_[i].view()) link_view(*view, *from);
}

void Panes::release_input() {
  for (Pane& pane : panes_) pane.input.release();
}

std::optional<std::size_t> Panes::selected() const {
  const std::vector<DocumentList::Entry>& entries = documents_.entries();
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (entries[i].path == panes_[active_].wanted) return i;
  return std::nullopt;
}

void Panes::want(std::size_t pane, const std::string& path) {
  panes_[pane].wanted = path;
  panes_[pane].failure.reset();
  cancel_unwanted();
}

std::vector<View*> Panes::views_in_sight() {
  std::vector<View*> views;
  for (const std::size_t i : visible()) {
    View* const view = panes_[i].view();
    if (!view) continue;
    views.push_back(view);
    for (const View::Over& over : view->over)
      if (over.view) views.push_back(over.view.get());
  }
  return views;
}

void Panes::add_over(std::size_t pane, const std::string& path) {
  View* const view = panes_[pane].view();
  if (!view || path == panes_[pane].shown ||
      std::ranges::any_of(view->over, [&](const View::Over& one) { return one.path == path; }))
    return;
  if (!documents_.find(path)) documents_.add(path);
  view->over.push_back({path, nullptr});
}

void Panes::remove_over(std::size_t pane, std::size_t index) {
  View* const view = panes_[pane].view();
  if (!view || index >= view->over.size()) return;
  view->over.erase(view->over.begin() + static_cast<std::ptrdiff_t>(index));
  cancel_unwanted();
}

bool Panes::wanted_by_any(std::string_view path) const {
  return std::any_of(panes_.begin(), panes_.end(), [&](const Pane& pane) {
    const View* const view = pane.view();
    return pane.wanted == path ||
           (view && std::ranges::any_of(view->over, [&](const View::Over& one) { return one.path == path; }));
  });
}

void Panes::cancel_unwanted() {
  for (const DocumentList::Entry& entry : documents_.entries())
    if (entry.reading != 0 && !wanted_by_any(entry.path)) documents_.cancel(entry.path);
}

}  // namespace gs::app
