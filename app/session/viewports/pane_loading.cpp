#include "app/session/viewports/pane_loading.h"

#include "app/session/documents/world_reader.h"

#include <utility>

namespace gs::app {

std::optional<DocumentList::Reading> PaneLoading::begin() {
  DocumentList& documents = panes_.documents();
  if (auto reading = documents.begin(panes_.at(panes_.active()).wanted)) return reading;
  for (const std::size_t i : panes_.visible())
    if (auto reading = documents.begin(panes_.at(i).wanted)) return reading;
  for (const std::size_t i : panes_.visible())
    if (const View* const view = panes_.at(i).view())
      for (const View::Over& over : view->over)
        if (auto reading = documents.begin(over.path)) return reading;
  return std::nullopt;
}

void PaneLoading::preview(std::uint64_t reading, std::shared_ptr<Document> document) {
  const std::optional<std::string> path = panes_.documents().preview(reading, document);
  if (!path) return;
  for (Pane& pane : panes_.all()) {
    const auto place = pane.views.find(*path);
    if (place == pane.views.end()) continue;
    place->second = grown(place->second, document, place->second.home_size);
  }
}

void PaneLoading::deliver(std::uint64_t reading, std::shared_ptr<Document> document, const glm::vec2& viewport) {
  DocumentList& documents = panes_.documents();
  const std::shared_ptr<Document> before = documents.document_of(reading);
  const bool grows = before && before->is_preview;
  const std::optional<std::string> path = documents.deliver(reading, document);
  if (!path) return;
  for (Pane& pane : panes_.all()) {
    if (pane.failure && pane.failure->path == *path) pane.failure.reset();
    for (auto& [shown, view] : pane.views)
      for (View::Over& over : view.over)
        if (over.path == *path && over.view)
          over.view = std::make_shared<View>(renewed(*over.view, document, viewport));
    const auto place = pane.views.find(*path);
    if (place == pane.views.end()) continue;
    place->second =
        grows ? grown(place->second, document, place->second.home_size) : renewed(place->second, document, viewport);
  }
}

bool PaneLoading::settle_over() {
  bool any = false;
  for (const std::size_t i : panes_.visible())
    if (View* const view = panes_.at(i).view())
      for (View::Over& over : view->over) {
        auto document = over.view ? nullptr : panes_.documents().document(over.path);
        if (!document) continue;
        over.view = std::make_shared<View>(view_of(std::move(document), view->size, {}, nullptr, style_));
        any = true;
      }
  return any;
}

void PaneLoading::grow(const Document& document) {
  for (Pane& pane : panes_.all())
    for (auto& [path, view] : pane.views)
      for (const View::Over& over : view.over)
        if (over.view && over.view->document.get() == &document) (void)follow_world(*over.view);
  for (Pane& pane : panes_.all())
    for (auto& [path, view] : pane.views)
      if (view.document.get() == &document) {
        // LOD distances now depend on this viewer. If other views share the render scene, this view needs its own.
        constexpr long kOwnUsers = 2;  // owners of an unshared scene: this view, and the document for later views
        if (document.viewer_dependent && view.scene.use_count() > kOwnUsers) {
          view.scene = document.runtime->look(view.navigation.pose.position, true);
          view.list = view.scene->scene.shared_list();
        }
        const bool stays = at_home(view);
        (void)follow_world(view);
        if (!stays) continue;
        // Show new parts at once, without the animation that re-frames the scene when objects move.
        if (std::exchange(view.navigation.transition, std::nullopt)) view.navigation.pose = view.home;
        view = grown(view, view.document, view.home_size);
      }
}

std::vector<std::size_t> PaneLoading::fail(std::uint64_t reading, const std::string& error) {
  DocumentList& documents = panes_.documents();
  std::vector<std::size_t> waited;
  const std::optional<std::string> path = documents.fail(reading);
  if (!path) return waited;
  for (std::size_t i = 0; i < kMaxViewports; ++i)
    if (panes_.at(i).wanted == *path) waited.push_back(i);
  for (const std::size_t i : waited) panes_.at(i).failure = {*path, error};
  if (documents.find(*path)) return waited;
  for (const std::size_t i : waited) panes_.at(i).wanted = panes_.at(i).shown;
  for (const std::size_t i : waited) {
    if (!panes_.at(i).wanted.empty()) continue;
    for (const DocumentList::Entry& entry : documents.entries())
      if (!panes_.wanted_by_any(entry.path)) {
        panes_.at(i).wanted = entry.path;
        break;
      }
  }
  return waited;
}

void PaneLoading::note_failure(const std::string& path, const std::string& error) {
  for (Pane& pane : panes_.all())
    if (pane.wanted == path) pane.failure = {path, error};
}

bool PaneLoading::cancel(std::size_t pane) {
  if (pane >= kMaxViewports || !panes_.loading(pane)) return false;
  DocumentList& documents = panes_.documents();
  const std::string path = panes_.at(pane).wanted;
  if (documents.arriving(path) && !documents.awaited(path)) {
    documents.document(path)->reader->cancel();  // keep the parts that were received so far
    return true;
  }
  documents.give_up(path);
  if (documents.find(path)) return true;
  for (Pane& each : panes_.all())
    if (each.wanted == path) each.wanted = each.shown;
  return true;
}

std::vector<PaneLoading::Change> PaneLoading::settle(std::span<const Viewport> places, std::string_view viewpoint) {
  std::vector<Change> changes;
  const std::vector<std::size_t> sight = panes_.visible();
  for (std::size_t i = 0; i < sight.size() && i < places.size(); ++i) {
    Pane& pane = panes_.at(sight[i]);
    if (View* view = pane.view()) fit_home(*view, places[i].size());
    std::shared_ptr<Document> document = panes_.documents().document(pane.wanted);
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

}  // namespace gs::app
