#include "app/session/documents/documents.h"

#include "app/loading/updates/limit_report.h"
#include "app/loading/world_loading.h"
#include "app/view/navigation.h"
#include "net/base/url_signature.h"

#include <algorithm>
#include <charconv>
#include <utility>

namespace gs::app {
namespace {

constexpr std::string_view kViewMark = "#view=";

/// Sets viewer_dependent if a node of a scene needs it, from node index `first` on. Checks all nodes of the scene's
/// Inlines.
void inspect(Document& document, const vrml::SceneGraph& from, std::uint32_t first) {
  std::vector<const vrml::SceneGraph*> scenes{&from};
  while (!scenes.empty()) {
    const vrml::SceneGraph& scene = *scenes.back();
    scenes.pop_back();
    for (std::uint32_t index = std::exchange(first, 1); index <= scene.nodes().count(); ++index) {
      const vrml::Node& node = scene.nodes().at(index);
      if (node.in_prototype_body || node.type->kind != vrml::NodeType::Kind::built_in) continue;
      document.viewer_dependent |= vrml::has(node.type->role, vrml::Role::viewer_dependent);
    }
    for (const auto& [node, content] : scene.inlines().all())
      if (content) scenes.push_back(content.get());
  }
}

glm::vec3 size_of_all(const render::RenderList& list) {
  return list.bounds.empty() ? glm::vec3(0) : list.bounds.size();
}

void inspect_geometries(Document& document) {
  for (const render::SplatItem& item : document.list->splats) {
    if (!item.geometry) continue;
    const bool surface = item.geometry->kind() == qnv::Kind::surface;
    (surface ? document.has_surface_vectors : document.has_volumes) = true;
  }
}

}  // namespace

std::shared_ptr<Document> preview_document(const std::string& path, const WorldLoading& loading,
                                           render::RenderList list) {
  auto document = std::make_shared<Document>();
  document->is_preview = true;
  document->world.path = path;
  document->world.title = loading.title();
  document->world.feeds = loading.feeds();
  document->world.authored = loading.authored();
  document->world.diagnostics = loading.diagnostics();
  document->has_navigation_info = list.has_navigation;
  document->upright = loading.upright(size_of_all(list));
  document->list = std::make_shared<const render::RenderList>(std::move(list));
  inspect_geometries(*document);
  return document;
}

std::shared_ptr<Document> hold_world(LoadedWorld world, render::MeshCache meshes) {
  auto document = std::make_shared<Document>();
  document->world = std::move(world);
  document->meshes = std::move(meshes);
  document->list = std::make_shared<const render::RenderList>();
  if (!document->world.scene) return document;
  inspect(*document, *document->world.scene, 1);
  document->runtime = std::make_unique<WorldRuntime>(document->world, document->meshes);
  return document;
}

void begin_world(Document& document, double now) {
  if (!document.runtime) return;
  document.runtime->start(now);
  document.has_navigation_info = document.runtime->bound().navigation_info != nullptr;
  document.first_scene = document.runtime->look({0, 0, 10}, document.viewer_dependent);
  document.list = document.first_scene->scene.shared_list();
  document.upright = document.world.upright(size_of_all(*document.list));
  if (document.viewer_dependent) {
    const auto& viewpoints = document.list->viewpoints;
    const glm::dvec3 viewer = viewpoints.empty()
                                  ? first_pose(document.list->bounds, {4, 3}, document.upright).position
                                  : pose_of(viewpoints[0].world_from_camera, viewpoints[0].field_of_view).position;
    (void)document.runtime->show(*document.first_scene, viewer);
  }
  report_limits(*document.list, document.world.diagnostics);
  inspect_geometries(document);
}

bool arrive(Document& document, ResourceUpdates&& updates) {
  std::vector<std::pair<const vrml::SceneGraph*, std::uint32_t>> grown;
  for (const ResourceUpdates::Content& one : updates.contents)
    if (one.content) grown.emplace_back(one.content.get(), 1);
  for (const ResourceUpdates::Prototypes& one : updates.prototypes)
    if (document.runtime->execution().scenes().has(one.scene))
      grown.emplace_back(one.scene, static_cast<std::uint32_t>(one.scene->nodes().count()) + 1);
  document.runtime->arrive(std::move(updates));
  for (const auto& [scene, first] : grown)
    if (document.runtime->execution().scenes().has(scene)) inspect(document, *scene, first);
  document.has_navigation_info = document.runtime->bound().navigation_info != nullptr;
  return !grown.empty();
}

std::shared_ptr<Document> make_document(LoadedWorld world, render::MeshCache meshes) {
  auto document = hold_world(std::move(world), std::move(meshes));
  if (document->runtime && document->runtime->execution().scripts().has_scripts())
    (void)document->runtime->look({0, 0, 10}, true);
  else
    begin_world(*document, world_time());
  return document;
}

void DocumentList::add(std::string_view path) {
  if (path.empty()) return;
  if (entry(path))
    reload_unedited(path);
  else
    entries_.push_back({std::string(path), true, 0, nullptr, nullptr});
}

void DocumentList::reload_unedited(std::string_view path) {
  const Entry* known = find(path);
  if (!known || !known->document || !known->document->unsaved()) reload(path);
}

void DocumentList::reload(std::string_view path) {
  if (Entry* known = entry(path)) known->stale = true;
}

std::optional<DocumentList::Reading> DocumentList::begin(std::string_view path) {
  Entry* known = entry(path);
  if (!known || !known->stale || known->reading != 0) return std::nullopt;
  known->stale = false;
  known->reading = ++readings_;
  known->cancelled = std::make_shared<std::atomic<bool>>(false);
  return Reading{known->reading, known->path, known->cancelled};
}

std::optional<std::string> DocumentList::deliver(std::uint64_t reading, std::shared_ptr<Document> document) {
  Entry* known = entry_of(reading);
  if (!known) return std::nullopt;
  known->reading = 0;
  known->cancelled.reset();
  known->document = std::move(document);
  return known->path;
}

std::optional<std::string> DocumentList::preview(std::uint64_t reading, std::shared_ptr<Document> document) {
  Entry* known = entry_of(reading);
  if (!known || (known->document && !known->document->is_preview)) return std::nullopt;
  known->document = std::move(document);
  return known->path;
}

std::optional<std::string> DocumentList::fail(std::uint64_t reading) {
  Entry* known = entry_of(reading);
  if (!known) return std::nullopt;
  known->reading = 0;
  known->cancelled.reset();
  const std::string path = known->path;
  if (known->document && known->document->is_preview) known->document.reset();
  if (!known->document && !known->stale) give_up(path);
  return path;
}

void DocumentList::cancel(std::string_view path) {
  Entry* known = entry(path);
  if (!known || known->reading == 0) return;
  *known->cancelled = true;
  known->cancelled.reset();
  known->reading = 0;
  known->stale = true;
}

void DocumentList::cancel_all() {
  for (const Entry& entry : entries_) cancel(entry.path);
}

void DocumentList::give_up(std::string_view path) {
  const std::string name(path);  // a copy, because `path` may refer to the entry that is erased here
  cancel(name);
  std::erase_if(entries_, [&](const Entry& entry) { return entry.path == name && !entry.document; });
  if (Entry* known = entry(name)) known->stale = false;
}

const DocumentList::Entry* DocumentList::find(std::string_view path) const {
  const auto place = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.path == path; });
  return place == entries_.end() ? nullptr : &*place;
}

std::shared_ptr<Document> DocumentList::document(std::string_view path) const {
  const Entry* known = find(path);
  return known ? known->document : nullptr;
}

std::shared_ptr<Document> DocumentList::document_of(std::uint64_t reading) const {
  for (const Entry& one : entries_)
    if (reading != 0 && one.reading == reading) return one.document;
  return nullptr;
}

bool DocumentList::awaited(std::string_view path) const {
  const Entry* known = find(path);
  return known && (known->stale || known->reading != 0);
}

bool DocumentList::arriving(std::string_view path) const {
  const Entry* known = find(path);
  return known && known->document && known->document->arriving.waiting > 0;
}

DocumentList::Entry* DocumentList::entry(std::string_view path) {
  const auto place = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.path == path; });
  return place == entries_.end() ? nullptr : &*place;
}

DocumentList::Entry* DocumentList::entry_of(std::uint64_t reading) {
  const auto place = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const Entry& e) { return reading != 0 && e.reading == reading; });
  return place == entries_.end() ? nullptr : &*place;
}

std::string further_view(std::string_view path, std::size_t number) {
  return file_of_view(path) + std::string(kViewMark) + std::to_string(number);
}

std::size_t view_number(std::string_view path) {
  const std::size_t mark = path.rfind(kViewMark);
  if (mark == std::string_view::npos) return 1;
  const std::string_view digits = path.substr(mark + kViewMark.size());
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return error == std::errc() && end == digits.data() + digits.size() && number >= 2 ? number : 1;
}

std::string file_of_view(std::string_view path) {
  return std::string(view_number(path) == 1 ? path : path.substr(0, path.rfind(kViewMark)));
}

std::string file_label(std::string_view path) {
  if (const std::size_t number = view_number(path); number > 1)
    return file_label(file_of_view(path)) + " (" + std::to_string(number) + ")";
  const std::string name = net::without_signature(path);
  path = name;
  while (path.size() > 1 && path.back() == '/') path.remove_suffix(1);
  const std::size_t slash = path.find_last_of('/');
  return std::string(slash == std::string_view::npos || slash + 1 == path.size() ? path : path.substr(slash + 1));
}

}  // namespace gs::app
