#include "app/viewer/viewer.h"

#include "app/streams/stream_feed.h"
#include "app/viewer/viewer_session.h"
#include "app/world/importance.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr int kSettlingFrames = 3;       // the interface needs a second look after a change
constexpr double kIdleWait = 30;         // seconds; any event ends it
constexpr double kLoadingWait = 0.25;    // between pictures of the progress line
constexpr std::size_t kMostReaders = 2;  // files that are read at a time
constexpr double kLifeStep = 1.0 / 60;   // seconds: how often time goes on in worlds
constexpr double kLongLife = 0.05;
constexpr double kBetweenPriorities = 0.5;

}  // namespace

Viewer::Viewer(const ViewerOptions& options, const LoadOptions& load, std::unique_ptr<Window> window,
               std::unique_ptr<render::Renderer> renderer)
    : options_(options),
      load_(load),
      window_(std::move(window)),
      renderer_(std::move(renderer)),
      ui_(window_->handle(), window_->content_scale()),
      frames_wanted_(kSettlingFrames) {
  panes_.start(options_.files);
}

Viewer::~Viewer() {
  // All at once, so that none is waited for while another has not been told.
  for (const Reader& one : readers_) one.reader->cancel();
  panes_.cancel_all();
}

void Viewer::run() {
  while (!window_->should_close()) {
    load_next();
    wait_for_something();
    if (take_news()) frames_wanted_ = kSettlingFrames;
    if (feed_streams()) frames_wanted_ = kSettlingFrames;
    prioritize();
    if (let_live()) frames_wanted_ = std::max(frames_wanted_, 1);
    const glm::ivec2 size = window_->framebuffer_size();
    if (size.x <= 0 || size.y <= 0) continue;  // minimised
    const std::vector<WindowEvent> events = window_->take_events();
    if (!events.empty()) frames_wanted_ = kSettlingFrames;
    // Nothing has happened: what is on the screen is right.
    if (frames_wanted_ == 0 && !moving() && !refinement_.wanted() && !loading()) continue;
    frame(Window::now(), events);
  }
  window_->hide();
}

void Viewer::wait_for_something() {
  const glm::ivec2 size = window_->framebuffer_size();
  if (size.x <= 0 || size.y <= 0)
    window_->wait(kIdleWait);
  else if (frames_wanted_ > 0 || moving() || refinement_.wanted() || window_->has_events())
    window_->poll();
  else if (loading())
    window_->wait(std::min(kLoadingWait, next_life().value_or(kLoadingWait)));
  else
    wait_idle();
}

void Viewer::wait_idle() {
  const std::optional<double> change = ui_.next_change(), life = next_life();
  window_->wait(std::min(change.value_or(kIdleWait), life.value_or(kIdleWait)));
  if (change && !(life && *life < *change))
    frames_wanted_ = std::max(frames_wanted_, 2);  // what appears is measured first, then shown
}

// Worlds -------------------------------------------------------------------------------------------

// Of the worlds in sight, each once.
std::vector<Document*> Viewer::living() const {
  std::vector<Document*> result;
  for (const std::size_t i : panes_.visible()) {
    const View* seen = panes_.at(i).view();
    if (seen && seen->document->living && std::find(result.begin(), result.end(), seen->document.get()) == result.end())
      result.push_back(seen->document.get());
  }
  return result;
}

// Seconds until time is to go on in a world; nothing: it stands still until somebody does something.
std::optional<double> Viewer::next_life() const {
  std::optional<double> next;
  for (const Document* document : living())
    if (const auto time = document->living->next_time()) next = std::min(next.value_or(*time), *time);
  if (!next) return std::nullopt;
  return std::clamp(*next - world_time(), std::max(0.0, life_due_ - Window::now()), kIdleWait);
}

// Lets time go on in the worlds that are seen. True when there is something else to be seen.
bool Viewer::let_live() {
  const double started = Window::now();
  if (started < life_due_) return false;
  const double time = world_time();
  bool any = false;
  for (Document* document : living()) {
    // The world has one viewer: who is in the active viewport, if he looks at it.
    View* leader = view() && view()->document.get() == document ? view() : nullptr;
    std::vector<View*> views;
    for (const std::size_t i : panes_.visible())
      if (View* seen = panes_.at(i).view(); seen && seen->document.get() == document) views.push_back(seen);
    if (!leader) leader = views.front();
    // Another viewport is another place: nobody has walked there.
    if (std::exchange(document->viewer, leader) != leader) document->living->execution().viewer_jumped();
    document->living->execution().set_viewer(world_from_viewer(leader->navigation.pose));
    const bool moved = document->living->step(time);
    if (document->reader)
      if (std::vector<UrlRequest> urls = document->living->take_url_requests(); !urls.empty())
        document->reader->request(std::move(urls));
    if (moved && leader == view() && pointed_pane_ == panes_.active()) point_again();
    for (View* seen : views) any = follow_world(*seen) || any;
    any = follow_bound_viewpoint(*leader) || any;
    for (View* seen : views) seen->bound = leader->bound;
  }
  // Worlds whose events take long leave the window time for what the user does.
  const double took = Window::now() - started;
  life_due_ = started + std::max(kLifeStep, took > kLongLife ? 3 * took : 0);
  return any;
}

void Viewer::frame(double now, const std::vector<WindowEvent>& events) {
  const bool continuous = was_continuous_;
  ui_.begin_frame(now, events);
  show_loaded();
  for (const WindowEvent& event : events) handle(event);
  move_views(continuous ? static_cast<float>(now - last_frame_) : 0.0f);
  if (std::exchange(pointer_moved_, false)) point_again();
  draw_viewports();
  ask_for_streams();
  apply(ui_.build(model()));
  ui_.draw();
  window_->present();
  measure(now, Window::now(), continuous);
  was_continuous_ = moving();
  if (frames_wanted_ > 0) --frames_wanted_;
}

void Viewer::move_views(float seconds) {
  const std::vector<std::size_t> sight = panes_.visible();
  const std::vector<Viewport> rectangles = places();
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < sight.size(); ++i) {
    Pane& pane = panes_.at(sight[i]);
    View* seen = pane.view();
    if (!seen) continue;
    const Pose before = seen->navigation.pose;
    const NavigationInput input = pane.input.input(seen->navigation.mode, rectangles[i]);
    if (input.any()) leader_ = sight[i];
    seen->navigation = step(seen->navigation, input, seconds);
    const Pose& after = seen->navigation.pose;
    if (before.position == after.position && before.orientation == after.orientation) continue;
    moved.push_back(sight[i]);
    // The pointer is over something else from now on.
    if (pointed_pane_ == sight[i]) pointer_moved_ = true;
  }
  const auto has_moved = [&](std::size_t pane) { return std::find(moved.begin(), moved.end(), pane) != moved.end(); };
  if (linked_ && !moved.empty())
    panes_.link(has_moved(leader_) ? leader_ : has_moved(panes_.active()) ? panes_.active() : moved.front());
  for (const std::size_t i : sight)
    if (View* seen = panes_.at(i).view()) (void)follow_world(*seen);
}

void Viewer::measure(double started, double now, bool continuous) {
  const double ms = (now - started) * 1000;
  frame_ms_ = frame_ms_ == 0 ? ms : frame_ms_ + 0.1 * (ms - frame_ms_);
  const double interval = started - last_frame_;
  if (continuous && interval > 0)
    frames_a_second_ =
        frames_a_second_ == 0 ? 1 / interval : frames_a_second_ + 0.1 * (1 / interval - frames_a_second_);
  last_frame_ = started;
}

bool Viewer::moving() const {
  for (const std::size_t i : panes_.visible()) {
    const Pane& pane = panes_.at(i);
    const View* seen = pane.view();
    if (seen && (seen->navigation.moving() || pane.input.holding())) return true;
  }
  return false;
}

// Files -------------------------------------------------------------------------------------------

bool Viewer::loading() const {
  const std::vector<std::size_t> sight = panes_.visible();
  return std::any_of(sight.begin(), sight.end(), [&](std::size_t i) { return panes_.loading(i); });
}

void Viewer::load_next() {
  while (readers_.size() < kMostReaders) {
    std::optional<DocumentList::Reading> reading = panes_.begin_loading();
    if (!reading) return;
    frames_wanted_ = kSettlingFrames;
    auto reader = std::make_shared<WorldReader>(reading->path, load_, &Window::wake);
    readers_.push_back({std::move(*reading), std::move(reader), {}});
  }
}

// True when something that shows has changed.
bool Viewer::take_news() {
  bool any = false;
  for (std::size_t i = 0; i < readers_.size();) {
    Reader& one = readers_[i];
    if (*one.reading.cancelled) {
      one.reader->retire();
      retired_.push_back(std::move(one.reader));
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

// True when what comes from now on is the document's own affair.
bool Viewer::take_document(const Reader& from, WorldReader::News& news) {
  if (news.document->is_preview) {
    panes_.preview(from.reading.number, news.document);
    return false;
  }
  if (!news.document->world.scene) {
    show_failed(from.reading.number, from.reading.path, news.document->world.diagnostics);
    return true;
  }
  const std::shared_ptr<Document> document = news.document;
  questions_.ask(from.reading.path, document->world.outside);
  document->reader = from.reader;
  panes_.deliver(from.reading.number, document, area().size());
  (void)take_arrivals(*document, from.reading.path, std::move(news));
  return true;
}

// Of a world that lives already.
bool Viewer::take_arrivals(Document& document, const std::string& path, WorldReader::News news) {
  const LoadingState state = news.over ? LoadingState{} : news.state;
  const bool any = news.streams_grew || news.over || !(state == document.arriving) || !news.arrivals.empty();
  if (!document.all_came) document.arriving = state;
  document.all_came = document.all_came || news.over;
  if (news.arrivals.empty()) return any;
  if (!news.arrivals.outside.empty()) questions_.ask(path, news.arrivals.outside);
  const bool told = !news.arrivals.diagnostics.entries().empty();
  document.living->arrive(std::move(news.arrivals));
  if (told) panes_.log_changed(document);
  return true;
}

// What is seen largest in the active viewport comes first.
void Viewer::prioritize() {
  const View* seen = view();
  if (!seen || !seen->document->reader || seen->document->arriving.waiting == 0) return;
  const double now = Window::now();
  if (now < next_priorities_) return;
  const auto wanted = seen->document->reader->wanted();
  if (wanted.empty()) return;
  seen->document->reader->prioritize(
      importance_of(*seen->document->world.scene, wanted, seen->navigation.pose.position));
  next_priorities_ = Window::now() + std::max(kBetweenPriorities, 20 * (Window::now() - now));
}

// What has come of streams becomes finer vectors, what views lack is asked for.
bool Viewer::feed_streams() {
  bool any = false;
  for (const std::size_t i : panes_.visible())
    if (const View* seen = panes_.at(i).view())
      for (const auto& feed : seen->document->world.feeds) {
        any = feed->apply() || any;
        if (const std::string problem = feed->take_problem(); !problem.empty()) ui_.show_notice(problem, true);
      }
  return any;
}

void Viewer::ask_for_streams() {
  for (const std::size_t i : panes_.visible())
    if (const View* seen = panes_.at(i).view())
      for (const auto& feed : seen->document->world.feeds) feed->ask();
}

void Viewer::show_failed(std::uint64_t reading, const std::string& path, const vrml::Diagnostics& diagnostics) {
  const std::vector<std::size_t> waited = panes_.fail(reading);
  if (waited.empty()) return;
  std::string reason = "it could not be read";
  for (const vrml::Diagnostic& diagnostic : diagnostics.entries()) {
    if (diagnostic.severity != vrml::Severity::error) continue;
    reason = diagnostic.message;
    break;
  }
  for (const std::size_t i : waited) {
    panes_.at(i).log = diagnostics;
    if (i == panes_.active()) ui_.show_log();
  }
  ui_.show_notice("Could not open " + file_label(path) + ": " + reason, true);
}

void Viewer::show_loaded() {
  for (const Panes::Change& change : panes_.settle(places(), options_.viewpoint)) {
    frames_wanted_ = kSettlingFrames;
    View& seen = *panes_.at(change.pane).view();
    if (!change.first) continue;
    if (change.found && !options_.viewpoint.empty())
      entries_.try_emplace(panes_.at(change.pane).shown, options_.viewpoint);
    if (!change.found) ui_.show_notice("There is no Viewpoint \"" + options_.viewpoint + "\" in this world", true);
    if (options_.headlight) seen.headlight = *options_.headlight;
    if (change.pane == panes_.active() && seen.document->world.diagnostics.errors() > 0) ui_.show_log();
    if (linked_ && change.pane != panes_.active()) panes_.link(panes_.active());
  }
  for (const std::size_t i : panes_.visible()) enter_by_link(panes_.at(i));
  show_title();
}

void Viewer::show_title() {
  std::string title = "GhostSpace";
  if (const View* seen = view()) {
    const OpenedWorld& world = seen->document->world;
    title = (world.title.empty() ? file_label(world.path) : world.title) + " - " + title;
  }
  if (title == title_) return;
  title_ = title;
  window_->set_title(title_);
}

int run_viewer(const ViewerOptions& options, const LoadOptions& load, std::string& error) {
  auto window = Window::open("GhostSpace", options.width, options.height, options.samples);
  if (const auto* problem = std::get_if<render::ContextError>(&window)) {
    error = "cannot open a window: " + problem->message;
    return 1;
  }
  auto& context = std::get<std::unique_ptr<Window>>(window);
  auto renderer = render::Renderer::create(*context);
  if (const auto* problem = std::get_if<render::ContextError>(&renderer)) {
    error = "cannot draw in a window: " + problem->message;
    return 1;
  }
  Viewer viewer(options, load, std::move(context), std::move(std::get<std::unique_ptr<render::Renderer>>(renderer)));
  viewer.run();
  return 0;
}

}  // namespace gs::app
