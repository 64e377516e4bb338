#include "app/loading/content/scene_handler.h"

#include "app/formats/foreign_types.h"
#include "app/loading/content/series_step.h"
#include "app/loading/fetch/partial_file.h"
#include "app/loading/listing/folder_choice.h"
#include "app/loading/updates/missing_url.h"
#include "vrml/scene/coordinates/units.h"

#include <algorithm>
#include <chrono>
#include <utility>

// Decoding of files into nodes. scene_references.cpp handles the references of these nodes.
namespace gs::app {

namespace {

// Returns true if a resource is inside itself, or too deep.
bool leads_back(const SceneHandler* outer, const Found& found, std::size_t max_depth) {
  std::size_t depth = 0;
  for (; outer; outer = outer->use().outer, ++depth)
    if (outer->target().found().url.text() == found.url.text() || depth >= max_depth) return true;
  return false;
}

}  // namespace

SceneHandler::SceneHandler(SceneContext& context, SceneUse use)
    : context_(context),
      use_(std::move(use)),
      target_(context.loading, use_.role == Role::root, use_.request.in_x3d,
              [this](bool with_references) {
                length_unit_ = target_.scene()->x3d().unit("length");
                attach();
                if (with_references) references_.look();
              }),
      references_(*this, context),
      prototypes_(*this, context),
      waiting_share_(context.loading.budget, Resource::files) {}

SceneHandler::~SceneHandler() = default;

bool SceneHandler::begin(const Found& found) {
  if (leads_back(use_.outer, found, context_.loading.budget->limits().inline_depth)) {
    context_.loading.results.report(Severity::error, use_.request.file, use_.request.location,
                                    use_.request.type + " refers back to " + found.path + "; left out");
    target_.refuse();
    finished_reading();
    return false;
  }
  errors_before_ = context_.loading.results.diagnostics().errors();
  target_.begin(found);
  return true;
}

bool SceneHandler::whole_file(const net::MappedFile& file, const std::string& path) {
  const auto bytes = file.bytes();
  type_ = &content_type_of(path, first_bytes(bytes));
  target_.set_type(*type_);
  if (type_->content == ContentClass::vrml || is_outline_stream(bytes)) return false;
  if (begin_step(bytes)) return true;
  bytes_ = bytes.size();
  content_ = content_for(target_, *type_, bytes);
  content_->cut = cut;
  (void)content_->whole_file(file, path);
  stage_ = Stage::read_at_once;
  return true;
}

void SceneHandler::receive(std::span<const std::byte> bytes) {
  bytes_ += bytes.size();
  if (target_.refused()) return;
  if (type_ && !is_series_) return read_rest(bytes);
  if (!waiting_share_.grow(bytes.size())) {
    target_.refuse_size();
    waiting_ = {};
    return;
  }
  waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  if ((!type_ && !choose_type(false)) || is_series_) return;
  read_rest(std::exchange(waiting_, {}));
  waiting_share_.shrink_to(0);
}

// Detects the type from the first bytes or the name. Returns false if more bytes are needed.
bool SceneHandler::choose_type(bool last) {
  if (!last && waiting_.size() < kTypeBytes) return false;
  const Found& found = target_.found();
  const auto first = first_bytes(waiting_);
  type_ = content_type_by_mark(first);
  if (!type_) type_ = &content_type_of(found.local ? found.path : found.url.path, first);
  target_.set_type(*type_);
  is_series_ =
      use_.role == Role::root && !is_step_ && (is_file_series(first) || (!found.local && is_bucket_list(first)));
  return true;
}

// Reads a file of the listed folder instead of the list. Reports the reason if the folder has no suitable file.
bool SceneHandler::begin_file_of_list(std::span<const std::byte> list) {
  if (target_.found().local || !is_bucket_list(list)) return false;
  Loading& loading = context_.loading;
  const Found& found = target_.found();
  const auto refuse = [&](const std::string& why) {
    loading.results.report(Severity::error, found.path, {}, why);
    target_.refuse();
    waiting_ = {};
    is_series_ = false;
    return true;
  };
  auto page = read_bucket_page(list, loading.budget);
  if (const auto* const problem = std::get_if<std::string>(&page)) return refuse("the list of a bucket: " + *problem);
  const auto folder = std::make_shared<const ListedFolder>(
      loading.fetcher.listed_folder(found.url, std::get<BucketPage>(std::move(page)), found.origin));
  if (!folder->trouble.empty()) loading.results.report(Severity::warning, found.path, {}, folder->trouble);
  auto& wanted = loading.options.component.step;
  auto chosen = choose_in_folder(folder->names, series_of_url(loading.results.path()), wanted);
  if (const auto* const problem = std::get_if<std::string>(&chosen)) return refuse(*problem);
  FolderChoice& choice = std::get<FolderChoice>(chosen);
  if (is_valid(choice.steps)) {
    wanted.reset();  // the step itself may have steps
    if (LoadedWorld* const world = loading.results.world()) world->steps = std::move(choice.steps);
  }
  if (choice.is_scan) {
    loading.options.component.folder = net::url_for_messages(found.url.text());
    loading.listed = folder;
  }
  std::vector<net::Url> candidates;
  for (const std::string& name : choice.files) candidates.push_back(folder->url_of(name));
  read_instead(std::move(candidates));
  return true;
}

// Prepares the fetch of another file, which replaces this one.
void SceneHandler::read_instead(std::vector<net::Url> candidates) {
  step_ = std::make_unique<Fetch>();
  step_->candidates = std::move(candidates);
  step_->from = target_.found().origin;
  step_->max_bytes = context_.loading.options.max_bytes;
  is_step_ = true;
  is_series_ = false;
  type_ = nullptr;
  waiting_ = {};
  waiting_share_.shrink_to(0);
}

// Reads the wanted step instead of this file if it is a series in JSON without VTK files, or the list of a bucket.
bool SceneHandler::begin_step(std::span<const std::byte> series) {
  if (use_.role != Role::root || is_step_ || cut) return false;
  if (begin_file_of_list(series)) return true;
  auto& wanted = context_.loading.options.component.step;
  auto step = step_of_series(series, wanted);
  if (!step) return false;
  wanted.reset();  // the step itself may have steps
  if (LoadedWorld* const world = context_.loading.results.world(); world && is_valid(step->steps))
    world->steps = std::move(step->steps);
  read_instead({net::resolve(target_.found().url, net::parse_url(net::tidy_url(step->file)))});
  return true;
}

void SceneHandler::read_rest(std::span<const std::byte> bytes) {
  if (!content_) content_ = content_for(target_, *type_, bytes);
  content_->cut = cut;
  content_->receive(bytes);
}

void SceneHandler::end(const std::optional<std::string>& problem) {
  LoadResults& results = context_.loading.results;
  if (problem) {
    results.report(Severity::error, target_.found().path, {}, *problem);
    target_.cut_short();
  }
  if (!type_ && !step_ && !target_.refused()) choose_type(true);
  if (is_series_ && !problem) (void)begin_step(waiting_);
  if (step_) {
    step_->handler = shared_from_this();
    return context_.loading.fetcher.fetch(std::move(step_), Urgency::world);
  }
  if (stage_ != Stage::read_at_once && !target_.refused()) {
    if (!content_) read_rest(std::exchange(waiting_, {}));
    content_->cut = cut;
    if (!target_.refused()) content_->end(problem.has_value());
    // A short file is parsed at its end.
    if (!target_.refused()) length_unit_ = target_.scene()->x3d().unit("length");
    // Converts other units than those of the outer text (ISO/IEC 19775-1 4.3.6).
    if (use_.role == Role::inlined && !target_.refused())
      vrml::scale_content(*target_.scene(), length_unit_ / use_.outer->length_unit());
  }
  if (!has_more()) content_.reset();
  if (target_.refused() && results.diagnostics().errors() == errors_before_)
    results.report(Severity::error, target_.found().path, {}, "has nothing to show");
  results.set_changed(true);
  finished_reading();
}

bool SceneHandler::take_parts(const PartsOffer& offer) {
  if (!content_ || !content_->take_parts(offer)) return false;
  parts_ = offer.received;
  return true;
}

void SceneHandler::receive_piece(const net::CellEvent& event) {
  bytes_ += event.bytes.size();
  if (content_) content_->receive_piece(event);
}

void SceneHandler::read_more() {
  content_->read_more();
  context_.loading.results.set_changed(true);
  if (!has_more()) content_.reset();
}

void SceneHandler::missing(const std::string& why) {
  LoadResults& results = context_.loading.results;
  target_.refuse();
  if (!use_.outer)
    results.report(Severity::error, results.file(), {},
                   refusal_of_folder(results.path()).value_or(why.empty() ? "cannot be found" : why));
  else if (use_.role == Role::library)
    use_.outer->prototypes().miss(*this, told ? std::nullopt : std::optional<std::string>(why));
  else if (!told)
    results.report(Severity::warning, use_.request.file, use_.request.location,
                   use_.request.type + ": " + why_missing(use_.request.urls, why));
  finished_reading();
}

void SceneHandler::stopped() {
  content_.reset();
  if (use_.role == Role::root) target_.cut_short();
}

std::vector<vrml::NodeId> SceneHandler::open_nodes() const {
  return content_ ? content_->open_nodes() : std::vector<vrml::NodeId>();
}

// Handles the end of the file itself. Its references may still be loading.
void SceneHandler::finished_reading() {
  stage_ = std::max(stage_, Stage::ended);
  seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - context_.loading.started).count();
  if (!target_.refused()) {
    attach();
    prototypes_.resolve();
    references_.look();
  }
  settle();
}

// Attaches the content of an Inline as soon as the content has nodes.
void SceneHandler::attach() {
  if (use_.role != Role::inlined || use_.is_withheld || target_.refused() || !target_.read_scene().has_own_nodes())
    return;
  target_.read_scene().attach(*use_.outer->target_.scene(), use_.request.place.node);
}

void SceneHandler::settle() {
  if (stage_ == Stage::settled || !nothing_more_comes() || prototypes_.wait_for_libraries()) return;
  stage_ = Stage::settled;
  if (use_.role == Role::library) use_.outer->prototypes().take_library(*this);
}

bool SceneHandler::is_inside(const SceneHandler& top) const {
  const SceneHandler* one = this;
  while (one && one != &top) one = one->use_.outer;
  return one != nullptr;
}

namespace {

// Gives the references of a scene that was given: all complete Inlines; the others follow.
void give_references(SceneHandler& handler, SceneContext& context) {
  vrml::SceneGraph* const scene = handler.target().scene();
  if (!scene || handler.target().refused()) return;
  for (const auto& library : handler.prototypes().libraries()) {
    if (!library->is_settled() || library->target().read_scene().is_given()) continue;
    library->target().read_scene().give_with_library();
    give_references(*library, context);
  }
  for (const auto& inner : handler.references().inlines()) {
    ReadScene& content = inner->target().read_scene();
    const vrml::NodeId at = inner->use().request.place.node;
    const bool is_attached = content.is_attached(*scene, at);
    if (inner->nothing_more_comes()) {
      if (!is_attached) continue;
      content.give_with(*scene, at);
      give_references(*inner, context);
      continue;
    }
    if (is_attached) content.take_back(*scene, at);
    inner->withhold();
    context.withheld.push_back(inner);
  }
}

}  // namespace

std::unique_ptr<vrml::SceneGraph> give_root(SceneHandler& root, SceneContext& context) {
  std::unique_ptr<vrml::SceneGraph> scene = root.target().read_scene().give();
  if (root.target().refused()) scene.reset();
  give_references(root, context);
  return scene;
}

std::shared_ptr<vrml::SceneGraph> give_content(SceneHandler& handler, SceneContext& context) {
  if (handler.target().refused()) return nullptr;
  std::shared_ptr<vrml::SceneGraph> content = handler.target().read_scene().give_content();
  if (content) give_references(handler, context);
  return content;
}

std::unique_ptr<vrml::SceneGraph> give_library(SceneHandler& library, SceneContext& context) {
  std::unique_ptr<vrml::SceneGraph> scene = library.target().read_scene().give();
  give_references(library, context);
  return scene;
}

SceneHandler* handler_of(SceneHandler& handler, const vrml::SceneGraph* wanted) {
  std::vector<SceneHandler*> waiting{&handler};
  while (!waiting.empty()) {
    SceneHandler* const one = waiting.back();
    waiting.pop_back();
    if (one->target().scene() == wanted) return one;
    for (const auto& inner : one->references().inlines()) waiting.push_back(inner.get());
  }
  return nullptr;
}

void forget_open(SceneHandler& handler, render::MeshCache& meshes) {
  if (!handler.target().scene()) return;
  handler.target().forget_meshes(handler.open_nodes(), meshes);
  for (const auto& inner : handler.references().inlines()) forget_open(*inner, meshes);
}

}  // namespace gs::app
