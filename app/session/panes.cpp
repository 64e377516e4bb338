#include "app/session/panes.h"

#include "app/session/documents/world_reader.h"

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
  const std::size_t most = split ? kMostViewports : kMostViewportsAtStart;
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

void Panes::reload() {
  panes_[active_].failure.reset();
  documents_.reload(panes_[active_].wanted);
}

bool Panes::cancel(std::size_t pane) {
  if (pane >= kMostViewports || !loading(pane)) return false;
  const std::string path = panes_[pane].wanted;
  if (documents_.arriving(path) && !documents_.awaited(path)) {
    documents_.document(path)->reader->cancel();  // keeps the parts received so far
    return true;
  }
  documents_.give_up(path);
  if (documents_.find(path)) return true;
  for (Pane& each : panes_)
    if (each.wanted == path) each.wanted = each.shown;
  return true;
}

void Panes::set_layout(ViewportLayout layout) { set_split(split_of(layout, active_)); }

void Panes::set_split(SplitTree split) {
  split_ = std::move(split);
  release_input();
  const std::size_t model = active_;
  const std::vector<std::size_t> sight = visible();
  if (std::find(sight.begin(), sight.end(), active_) == sight.end()) active_ = sight.front();
  // Skips viewports that report a failed file.
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

// Returns an empty hidden viewport, else any hidden viewport; the files of the latter stay listed.
std::optional<std::size_t> Panes::free_pane() const {
  for (const bool with_file : {false, true})
    for (std::size_t i = 0; i < kMostViewports; ++i)
      if (!has_pane(split_, i) && (with_file || panes_[i].wanted.empty())) return i;
  return std::nullopt;
}

bool Panes::close(std::size_t pane) {
  if (!has_pane(split_, pane) || split_.root.parts.empty()) return false;
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
  if (pane >= kMostViewports || pane == active_) return;
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

std::optional<DocumentList::Reading> Panes::begin_loading() {
  if (auto reading = documents_.begin(panes_[active_].wanted)) return reading;
  for (const std::size_t i : visible())
    if (auto reading = documents_.begin(panes_[i].wanted)) return reading;
  return std::nullopt;
}

void Panes::preview(std::uint64_t reading, std::shared_ptr<Document> document) {
  const std::optional<std::string> path = documents_.preview(reading, document);
  if (!path) return;
  for (Pane& pane : panes_) {
    const auto place = pane.views.find(*path);
    if (place == pane.views.end()) continue;
    place->second = grown(place->second, document, place->second.home_size);
  }
}

void Panes::deliver(std::uint64_t reading, std::shared_ptr<Document> document, const glm::vec2& viewport) {
  const std::shared_ptr<Document> before = documents_.document_of(reading);
  const bool grows = before && before->is_preview;
  const std::optional<std::string> path = documents_.deliver(reading, document);
  if (!path) return;
  for (Pane& pane : panes_) {
    if (pane.failure && pane.failure->path == *path) pane.failure.reset();
    const auto place = pane.views.find(*path);
    if (place == pane.views.end()) continue;
    place->second =
        grows ? grown(place->second, document, place->second.home_size) : renewed(place->second, document, viewport);
  }
}

void Panes::grow(const Document& document) {
  for (Pane& pane : panes_)
    for (auto& [path, view] : pane.views)
      if (view.document.get() == &document) {
        // The LOD distances now depend on this viewer, so a shared list must be replaced by an own one.
        constexpr long kOwnUsers = 2;  // this view, and the document's reference for later views
        if (document.viewer_dependent && view.scene.use_count() > kOwnUsers) {
          view.scene = document.runtime->look(view.navigation.pose.position, true);
          view.list = view.scene->scene.shared_list();
        }
        const bool stays = at_home(view);
        (void)follow_world(view);
        if (!stays) continue;
        // New parts are visible at once. They do not start the animation that re-frames moving objects.
        if (std::exchange(view.navigation.transition, std::nullopt)) view.navigation.pose = view.home;
        view = grown(view, view.document, view.home_size);
      }
}

std::vector<std::size_t> Panes::fail(std::uint64_t reading, const std::string& error) {
  std::vector<std::size_t> waited;
  const std::optional<std::string> path = documents_.fail(reading);
  if (!path) return waited;
  for (std::size_t i = 0; i < kMostViewports; ++i)
    if (panes_[i].wanted == *path) waited.push_back(i);
  for (const std::size_t i : waited) panes_[i].failure = {*path, error};
  if (documents_.find(*path)) return waited;
  for (const std::size_t i : waited) panes_[i].wanted = panes_[i].shown;
  for (const std::size_t i : waited) {
    if (!panes_[i].wanted.empty()) continue;
    for (const DocumentList::Entry& entry : documents_.entries())
      if (!wanted_by_any(entry.path)) {
        panes_[i].wanted = entry.path;
        break;
      }
  }
  return waited;
}

void Panes::note_failure(const std::string& path, const std::string& error) {
  for (Pane& pane : panes_)
    if (pane.wanted == path) pane.failure = {path, error};
}

std::vector<Panes::Change> Panes::settle(std::span<const Viewport> places, std::string_view viewpoint) {
  std::vector<Change> changes;
  const std::vector<std::size_t> sight = visible();
  for (std::size_t i = 0; i < sight.size() && i < places.size(); ++i) {
    Pane& pane = panes_[sight[i]];
    if (View* view = pane.view()) fit_home(*view, places[i].size());
    std::shared_ptr<Document> document = documents_.document(pane.wanted);
    if (!document || (pane.shown == pane.wanted && pane.view())) continue;
    Change change{sight[i], false, true};
    pane.shown = pane.wanted;
    pane.input.release();
    if (!pane.view()) {
      change.first = true;
      pane.views[pane.shown] = view_of(std::move(document), places[i].size(), viewpoint, &change.found, style_);
    }
    changes.push_back(change);
  }
  return changes;
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

bool Panes::wanted_by_any(std::string_view path) const {
  return std::any_of(panes_.begin(), panes_.end(), [&](const Pane& pane) { return pane.wanted == path; });
}

void Panes::cancel_unwanted() {
  for (const DocumentList::Entry& entry : documents_.entries())
    if (entry.reading != 0 && !wanted_by_any(entry.path)) documents_.cancel(entry.path);
}

}  // namespace gs::app
