#include "app/session/session.h"
#include "app/streams/stream_feed.h"
#include "app/world/importance.h"

#include <algorithm>
#include <utility>

// Files of a session, and updates for their worlds.
namespace gs::app {
namespace {

constexpr std::size_t kMostReaders = 2;  // max number of concurrent readings
constexpr double kBetweenPriorities = 0.5;
constexpr std::size_t kMostFailed = 16;  // max number of failed worlds with stored loads

// Formats a diagnostic for a viewport, which shows the file name itself.
std::string problem_text(const vrml::Diagnostic& diagnostic, const std::string& path) {
  if (diagnostic.file != path) return diagnostic.text();
  if (diagnostic.location.line == 0) return diagnostic.message;
  return "line " + std::to_string(diagnostic.location.line) + ", column " + std::to_string(diagnostic.location.column) +
         ": " + diagnostic.message;
}

}  // namespace

bool Session::loading() const {
  const std::vector<std::size_t> sight = panes_.visible();
  return std::any_of(sight.begin(), sight.end(), [&](std::size_t i) { return panes_.loading(i); });
}

void Session::load_next() {
  while (readers_.size() < kMostReaders) {
    std::optional<DocumentList::Reading> reading = panes_.begin_loading();
    if (!reading) return;
    frame_.news = true;
    std::erase_if(failed_loads_, [&](const Loads& one) { return one.path == reading->path; });
    auto reader = std::make_shared<WorldReader>(series_.file_of(reading->path), load_, wake_);
    readers_.push_back({std::move(*reading), std::move(reader), {}});
  }
}

void Session::play_series(bool on) {
  const std::string& name = panes_.at(panes_.active()).wanted;
  if (series_.play(name, on, now_)) panes_.reload(name);
  frame_.news = true;
}

void Session::show_of_series(std::size_t file) {
  const std::string& name = panes_.at(panes_.active()).wanted;
  if (series_.show(name, file, now_)) panes_.reload(name);
  frame_.news = true;
}

void Session::set_series_rate(double rate) { series_.set_rate(panes_.at(panes_.active()).wanted, rate); }

// Applies the news of all readers. Returns true if the picture or the progress changed.
bool Session::take_news() {
  bool any = false;
  for (std::size_t i = 0; i < readers_.size();) {
    Reader& one = readers_[i];
    if (*one.reading.cancelled) {
      one.reader->retire();
      retired_.push_back(std::move(one.reader));
    } else if (series_.holds_back(one.reading.path, now_)) {
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
  for (const DocumentList::Entry& entry : panes_.documents().entries())
    if (entry.document && entry.document->reader)
      any = take_arrivals(*entry.document, entry.path, entry.document->reader->take()) || any;
  return any;
}

// Applies news of a reading. Returns true if the reading is over; later news go to the document.
bool Session::take_document(const Reader& from, WorldReader::News& news) {
  log_.note(from.reading.path, news.document->world.diagnostics);
  if (news.document->is_preview) {
    frame_.arrived.push_back(from.reading.path);
    panes_.preview(from.reading.number, news.document);
    return false;
  }
  if (!news.document->world.scene) {
    failed_loads_.push_back({from.reading.path, nullptr, from.reader->ledger()});
    if (failed_loads_.size() > kMostFailed) failed_loads_.erase(failed_loads_.begin());
    show_failed(from.reading.number, from.reading.path, news.document->world.diagnostics);
    return true;
  }
  frame_.arrived.push_back(from.reading.path);
  const std::shared_ptr<Document> document = news.document;
  if (const auto opener = private_files_.find(from.reading.path); opener != private_files_.end() && document->runtime)
    document->runtime->assume_private(opener->second);
  if (document->runtime && mesh_worker_) document->runtime->set_mesh_worker(mesh_worker_);
  if (document->runtime && !document->runtime->has_started()) begin_world(*document, world_time());
  log_.note(from.reading.path, document->world.diagnostics);  // includes the objects that limits removed
  places_behind_.erase(from.reading.path);
  questions_.ask(from.reading.path, document->world.outside);
  document->reader = from.reader;
  panes_.deliver(from.reading.number, document, area_.size());
  if (series_.arrived(from.reading.path, now_)) panes_.reload(from.reading.path);
  (void)take_arrivals(*document, from.reading.path, std::move(news));
  return true;
}

// Takes the finished meshes of all worlds, so that none wait for a view.
bool Session::take_meshes() {
  bool any = false;
  for (const DocumentList::Entry& entry : panes_.documents().entries())
    if (entry.document && entry.document->runtime) any = entry.document->runtime->take_meshes() || any;
  return any;
}

// Applies updates to a running world.
bool Session::take_arrivals(Document& document, const std::string& path, WorldReader::News news) {
  const LoadingState state = news.over ? LoadingState{} : news.state;
  if (news.over) note_empty(document, path);
  // Ignores the reader's last state when everything is loaded, so that the session can become idle.
  const bool progress = !document.all_came && !(state == document.arriving);
  const bool any = news.streams_grew || news.over || progress || !news.arrivals.empty();
  if (!document.all_came) document.arriving = state;
  document.all_came = document.all_came || news.over;
  if (news.arrivals.empty()) return any;
  if (!news.arrivals.outside.empty()) questions_.ask(path, news.arrivals.outside);
  const bool told = !news.arrivals.diagnostics.entries().empty();
  if (arrive(document, std::move(news.arrivals))) panes_.grow(document);
  if (told) log_.note(path, document.world.diagnostics);
  return true;
}

// Reports a world without visible objects in its viewports, if it has errors.
void Session::note_empty(const Document& document, const std::string& path) {
  if (!document.list || !document.list->items.empty() || !document.list->splats.empty()) return;
  for (const vrml::Diagnostic& diagnostic : document.world.diagnostics.entries())
    if (diagnostic.severity == vrml::Severity::error) return panes_.note_failure(path, problem_text(diagnostic, path));
}

// Gives nodes that look large in the active viewport the highest priority.
void Session::prioritize() {
  const View* seen = view();
  if (!seen || !seen->document->reader || seen->document->arriving.waiting == 0) return;
  if (now_ < next_priorities_) return;
  const double started = world_time();
  const auto wanted = seen->document->reader->wanted();
  if (wanted.empty()) return;
  seen->document->reader->prioritize(
      importance_of(*seen->document->world.scene, wanted, seen->navigation.pose.position));
  next_priorities_ = now_ + std::max(kBetweenPriorities, 20 * (world_time() - started));
}

// Passes received bytes to the streams, and requests the chunks that views lack.
bool Session::feed_streams() {
  bool any = false;
  for (const std::size_t i : panes_.visible())
    if (const View* seen = panes_.at(i).view())
      for (const auto& feed : seen->document->world.feeds) {
        any = feed->apply() || any;
        if (const std::string problem = feed->take_problem(); !problem.empty()) tell(problem, true);
      }
  return any;
}

void Session::ask_for_streams() {
  weigh_streams();
  for (const std::size_t i : panes_.visible())
    if (const View* seen = panes_.at(i).view())
      for (const auto& feed : seen->document->world.feeds) feed->ask();
}

void Session::show_failed(std::uint64_t reading, const std::string& path, const vrml::Diagnostics& diagnostics) {
  std::string reason = "it cannot be read", error = reason;
  for (const vrml::Diagnostic& diagnostic : diagnostics.entries()) {
    if (diagnostic.severity != vrml::Severity::error) continue;
    reason = diagnostic.message;
    error = problem_text(diagnostic, path);
    break;
  }
  const std::vector<std::size_t> waited = panes_.fail(reading, error);
  if (waited.empty()) return;
  frame_.failed.push_back({path, reason});
  // A visible viewport shows the error itself, until the user dismisses it or a link continues with the next URL.
  const std::vector<std::size_t> sight = panes_.visible();
  const auto next = places_behind_.find(path);
  const bool leads_on = next != places_behind_.end() && !next->second.places.empty();
  if (leads_on || std::find_first_of(sight.begin(), sight.end(), waited.begin(), waited.end()) == sight.end())
    tell("Cannot open " + file_label(path) + ": " + reason, true);
  frame_.news = true;
  entries_.erase(path);
  // Tries the next URL of the link (VRML97 6.2).
  if (auto behind = places_behind_.extract(path)) follow_link(waited.front(), behind.mapped());
}

void Session::show_loaded() {
  for (const Panes::Change& change : panes_.settle(places(), options_.viewpoint)) {
    frame_.news = true;
    View& seen = *panes_.at(change.pane).view();
    if (!change.first) continue;
    if (change.found && !options_.viewpoint.empty())
      entries_.try_emplace(panes_.at(change.pane).shown, options_.viewpoint);
    if (!change.found) tell("No Viewpoint \"" + options_.viewpoint + "\" in this world", true);
    seen.navigation.speed *= static_cast<float>(options_.speed);
    if (const auto camera = std::exchange(options_.camera, std::nullopt);
        camera && seen.navigation.mode != NavigationMode::none) {
      choose_parallel(seen, seen.style.parallel || camera->height > 0);
      stand_at(seen, *camera, false);
    }
    if (options_.headlight) seen.headlight = *options_.headlight;
    if (const auto budget = budgets_.find(panes_.at(change.pane).shown); budget != budgets_.end())
      seen.budget = budget->second;
    if (change.pane == panes_.active() && seen.document->world.diagnostics.errors() > 0) frame_.show_log = true;
    if (linked_ && change.pane != panes_.active()) panes_.link(panes_.active());
    if (!options_.simulated) picker_.items().prepare(*seen.list);
  }
  for (const std::size_t i : panes_.visible()) enter_by_link(panes_.at(i));
}

std::vector<LoadingState> Session::progress_of(const std::string& path) const {
  std::vector<LoadingState> states;
  for (const Reader& one : readers_)
    if (one.reading.path == path) states.push_back(one.state);
  if (const auto document = panes_.documents().document(path); document && states.empty())
    states.push_back(document->arriving);
  return states;
}

std::vector<Session::Loads> Session::loads() const {
  std::vector<Loads> result = failed_loads_;
  for (const DocumentList::Entry& entry : panes_.documents().entries())
    if (entry.document && entry.document->reader)
      result.push_back({entry.path, entry.document, entry.document->reader->ledger()});
  for (const Reader& one : readers_) result.push_back({one.reading.path, nullptr, one.reader->ledger()});
  return result;
}

void Session::cancel_loading(std::size_t place) {
  const std::vector<std::size_t> sight = panes_.visible();
  if (place < sight.size()) (void)panes_.cancel(sight[place]);
}

}  // namespace gs::app
