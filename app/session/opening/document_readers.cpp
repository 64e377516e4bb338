#include "app/session/opening/document_readers.h"

#include "app/formats/common/dataset_list.h"
#include "net/base/url.h"
#include "net/base/url_signature.h"
#include "render/scene/late_meshes.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMaxReaders = 2;  // max number of concurrent readings
constexpr std::size_t kMaxFailed = 16;  // max stored load ledgers of failed worlds

// Formats a diagnostic for a viewport. Omits the file name, because the viewport itself shows it.
std::string problem_text(const Diagnostic& diagnostic, const std::string& path) {
  if (diagnostic.file != path && diagnostic.file != net::without_signature(path)) return diagnostic.text();
  if (diagnostic.location.line == 0) return diagnostic.message;
  return "line " + std::to_string(diagnostic.location.line) + ", column " + std::to_string(diagnostic.location.column) +
         ": " + diagnostic.message;
}

}  // namespace

std::shared_ptr<EarlyReader> read_early(const std::string& path, const LoadOptions& load, std::function<void()> wake) {
  const net::Url url = net::parse_url(path);
  if (load.follow || url.scheme.empty() || url.scheme == "file" || url.has_fragment || file_of_view(path) != path)
    return nullptr;
  LoadOptions options = load;
  options.component.found = std::make_shared<DatasetList>();
  auto early = std::make_shared<EarlyReader>(EarlyReader{path, options.component, options.limits.memory, nullptr});
  early->reader = std::make_shared<WorldReader>(path, std::move(options), std::move(wake));
  return early;
}

DocumentReaders::DocumentReaders(StepContext& step, SessionViewports& viewports, const LoadOptions& load,
                                 ReaderPeers peers, std::function<void()> wake,
                                 std::shared_ptr<render::MeshWorker> meshes)
    : step_(step),
      viewports_(viewports),
      load_(load),
      peers_(peers),
      wake_(std::move(wake)),
      meshes_(std::move(meshes)) {}

DocumentReaders::~DocumentReaders() {
  // Cancel all readers before the first wait, so that they end at the same time.
  for (const Reader& one : readers_) one.reader->cancel();
  viewports_.loading().cancel_all();
}

bool DocumentReaders::loading() const {
  const Panes& panes = viewports_.panes();
  const std::vector<std::size_t> sight = panes.visible();
  return std::any_of(sight.begin(), sight.end(), [&](std::size_t i) { return panes.loading(i); });
}

void DocumentReaders::begin() {
  while (readers_.size() < kMaxReaders) {
    std::optional<DocumentList::Reading> reading = viewports_.loading().begin();
    if (!reading) return;
    step_.frame.news = true;
    std::erase_if(failed_loads_, [&](const Loads& one) { return one.path == reading->path; });
    LoadOptions load = load_;
    load.component = peers_.data.of(reading->path);
    load.component.found = std::make_shared<DatasetList>();
    load.component.growing = peers_.follower.follows(reading->path);
    if (peers_.follower.shows_newest(reading->path))
      load.component.step = qnv::ShownStep{0, kNewestStep};
    else if (const auto step = peers_.series.step_of(file_of_view(reading->path)))
      load.component.step = qnv::ShownStep{static_cast<std::uint32_t>(*step), std::nullopt};
    if (use_early(*reading, load)) continue;
    auto reader = std::make_shared<WorldReader>(peers_.series.file_of(file_of_view(reading->path)), load, wake_);
    readers_.push_back({std::move(*reading), std::move(reader), load.component, {}});
  }
}

// Uses the early reader if its file and options match `reading` and `load`, else cancels it. Returns true if it uses
// the reader.
bool DocumentReaders::use_early(DocumentList::Reading& reading, const LoadOptions& load) {
  const auto given = std::exchange(early_, nullptr);
  if (!given || !given->reader) return false;
  EarlyReader early = std::exchange(*given, {});
  VoxelComponent wanted = load.component;
  wanted.found = early.data.found;
  if (early.path != peers_.series.file_of(file_of_view(reading.path)) || !(wanted == early.data) ||
      early.memory != load.limits.memory) {
    early.reader->cancel();
    early.reader->retire();
    retired_.push_back(std::move(early.reader));
    return false;
  }
  readers_.push_back({std::move(reading), std::move(early.reader), std::move(early.data), {}});
  return true;
}

bool DocumentReaders::take_news() {
  bool any = false;
  for (std::size_t i = 0; i < readers_.size();) {
    Reader& one = readers_[i];
    if (*one.reading.cancelled) {
      one.reader->retire();
      retired_.push_back(std::move(one.reader));
    } else if (peers_.series.holds_back(file_of_view(one.reading.path), step_.now)) {
      ++i;
      continue;
    } else {
      WorldReader::News news = one.reader->take();
      any = any || news.document || news.streams_grew || !(news.state == one.state);
      one.state = news.state;
      if (!news.document || !take_document(one, news)) {
        ++i;
        continue;
      }
    }
    readers_.erase(readers_.begin() + static_cast<std::ptrdiff_t>(i));
    any = true;
  }
  std::erase_if(retired_, [](const auto& reader) { return reader->ended(); });
  for (const DocumentList::Entry& entry : viewports_.panes().documents().entries())
    if (entry.document && entry.document->reader)
      any = apply_updates(*entry.document, entry.path, entry.document->reader->take()) || any;
  return any;
}

// Applies news with a document. Returns true if the document is complete or could not be opened; further news then go
// to the document.
bool DocumentReaders::take_document(const Reader& from, WorldReader::News& news) {
  const std::string& path = from.reading.path;
  peers_.log.note(path, news.document->world.diagnostics);
  news.document->data = from.data;
  if (news.document->is_preview) news.document->data.found.reset();  // the reader thread still writes it
  if (news.document->is_preview) {
    step_.frame.arrived.push_back(path);
    viewports_.loading().preview(from.reading.number, news.document);
    return false;
  }
  if (!news.document->world.scene) {
    failed_loads_.push_back({path, nullptr, from.reader->ledger()});
    if (failed_loads_.size() > kMaxFailed) failed_loads_.erase(failed_loads_.begin());
    // A file that is being written may be incomplete. The previous content stays, and the file is read again.
    if (peers_.follower.note_failed(path)) {
      (void)viewports_.panes().documents().fail(from.reading.number);
      if (!viewports_.panes().documents().document(path))
        viewports_.loading().note_failure(path, "it cannot be read yet; it is retried while it is followed");
      return true;
    }
    show_failed(from.reading.number, path, news.document->world.diagnostics);
    return true;
  }
  step_.frame.arrived.push_back(path);
  const std::shared_ptr<Document> document = news.document;
  peers_.data.note_opened(path, *document);
  peers_.links.note_opened(path, *document);
  if (document->runtime && meshes_) document->runtime->set_mesh_worker(meshes_);
  if (document->runtime && !document->runtime->has_started()) begin_world(*document, world_time());
  peers_.log.note(path, document->world.diagnostics);  // now includes objects that were removed because of limits
  peers_.questions.ask(path, document->world.outside);
  document->reader = from.reader;
  viewports_.loading().deliver(from.reading.number, document, viewports_.area().size());
  const std::string series = file_of_view(path);
  if (const auto& steps = document->world.steps) peers_.series.set_steps(series, steps->times, steps->shown);
  if (peers_.series.arrived(series, step_.now)) viewports_.panes().reload(path);
  (void)apply_updates(*document, path, std::move(news));
  return true;
}

bool DocumentReaders::take_meshes() {
  bool any = false;
  for (const DocumentList::Entry& entry : viewports_.panes().documents().entries())
    if (entry.document && entry.document->runtime) any = entry.document->runtime->take_meshes() || any;
  return any;
}

// Applies updates from the reader to a running world. Returns true if the picture or the progress changed.
bool DocumentReaders::apply_updates(Document& document, const std::string& path, WorldReader::News news) {
  const LoadingState state = news.over ? LoadingState{} : news.state;
  if (news.over) note_empty(document, path);
  if (news.over && document.runtime) document.runtime->execution().loads().end();
  // After everything has loaded, ignore changes of the reader's state, so that the session can become idle.
  const bool progress = !document.all_came && !(state == document.arriving);
  const bool any = news.streams_grew || news.over || progress || !news.updates.empty();
  if (!document.all_came) document.arriving = state;
  document.all_came = document.all_came || news.over;
  if (news.updates.empty()) return any;
  if (!news.updates.outside.empty()) peers_.questions.ask(path, news.updates.outside);
  const bool told = !news.updates.diagnostics.entries().empty();
  if (arrive(document, std::move(news.updates))) viewports_.loading().grow(document);
  if (told) peers_.log.note(path, document.world.diagnostics);
  return true;
}

// If a world has errors and nothing visible, shows its first error in its viewports.
void DocumentReaders::note_empty(const Document& document, const std::string& path) {
  if (!document.list || !document.list->items.empty() || !document.list->splats.empty()) return;
  for (const Diagnostic& diagnostic : document.world.diagnostics.entries())
    if (diagnostic.severity == Severity::error)
      return viewports_.loading().note_failure(path, problem_text(diagnostic, path));
}

void DocumentReaders::show_failed(std::uint64_t reading, const std::string& path, const Diagnostics& diagnostics) {
  std::string reason = "it cannot be read", error = reason;
  for (const Diagnostic& diagnostic : diagnostics.entries()) {
    if (diagnostic.severity != Severity::error) continue;
    reason = diagnostic.message;
    error = problem_text(diagnostic, path);
    break;
  }
  const std::vector<std::size_t> waited = viewports_.loading().fail(reading, error);
  if (waited.empty()) return;
  step_.frame.failed.push_back({path, reason});
  // A visible viewport shows the error, until the user dismisses it or a link continues with its next URL. Otherwise a
  // notice is needed.
  const std::vector<std::size_t> sight = viewports_.panes().visible();
  if (peers_.links.has_fallback(path) ||
      std::find_first_of(sight.begin(), sight.end(), waited.begin(), waited.end()) == sight.end())
    step_.notify("Cannot open " + file_label(path) + ": " + reason, true);
  step_.frame.news = true;
  peers_.links.follow_fallback(waited.front(), path);
}

void DocumentReaders::show(std::shared_ptr<Document> document) {
  std::string path = document->world.path;
  if (path.empty()) path = "world";
  document->data = peers_.data.of(path);
  viewports_.panes().open(std::vector<std::string>{path});
  if (const auto reading = viewports_.loading().begin())
    viewports_.loading().deliver(reading->number, std::move(document), viewports_.area().size());
}

std::vector<LoadingState> DocumentReaders::progress_of(const std::string& path) const {
  std::vector<LoadingState> states;
  for (const Reader& one : readers_)
    if (one.reading.path == path) states.push_back(one.state);
  if (const auto document = viewports_.panes().documents().document(path); document && states.empty())
    states.push_back(document->arriving);
  return states;
}

std::vector<DocumentReaders::Loads> DocumentReaders::loads() const {
  std::vector<Loads> result = failed_loads_;
  for (const DocumentList::Entry& entry : viewports_.panes().documents().entries())
    if (entry.document && entry.document->reader)
      result.push_back({entry.path, entry.document, entry.document->reader->ledger()});
  for (const Reader& one : readers_) result.push_back({one.reading.path, nullptr, one.reader->ledger()});
  return result;
}

void DocumentReaders::cancel(std::size_t place) {
  const std::vector<std::size_t> sight = viewports_.panes().visible();
  if (place < sight.size()) (void)viewports_.loading().cancel(sight[place]);
}

}  // namespace gs::app
