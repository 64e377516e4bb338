#include "app/session/session.h"

#include "render/scene/late_meshes.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr double kLifeStep = 1.0 / 60;  // seconds between time steps of the worlds
constexpr double kLongLife = 0.05;
constexpr std::size_t kMostMet = 20'000;                       // triangles around a moving viewer
constexpr std::size_t kMostRemembered = std::size_t{1} << 24;  // triangles

}  // namespace

// A step ------------------------------------------------------------------------------------------

Session::Session(SessionOptions options, LoadOptions load, std::function<void()> wake)
    : options_(std::move(options)), load_(std::move(load)), wake_(std::move(wake)) {
  if (!options_.simulated)
    mesh_worker_ = std::make_shared<render::MeshWorker>(
        wake_, [trees = picker_.items().trees()](const auto& mesh) { trees->prepare(mesh); });
  panes_.set_style(options_.style);
  panes_.start(places_of(options_.files), options_.split);
  sounds_.set_muted(options_.muted);
  if (options_.audible) device_ = std::make_unique<SoundDevice>(sounds_.mixer(), world_time);
}

Session::~Session() {
  // Cancel all readers before waiting for one, so that they end concurrently.
  for (const Reader& one : readers_) one.reader->cancel();
  panes_.cancel_all();
}

Frame Session::step(double now, const SessionInput& input) {
  const double before = std::exchange(now_, now);
  load_next();
  limit_reading();
  if (take_news()) frame_.news = true;
  if (take_meshes()) frame_.changed = true;
  if (feed_streams()) frame_.changed = true;
  prioritize();
  if (advance_worlds(input.look)) frame_.changed = true;
  if (run_extensions(input.look)) frame_.changed = true;
  if (input.area) {
    area_ = *input.area;
    show_loaded();
    if (!options_.simulated) note_visits();
    for (const SessionInput::Event& event : input.events) handle(event);
    move_views(was_moving_ ? static_cast<float>(now - before) : 0.0f, input.look);
    if (std::exchange(pointer_moved_, false)) point_again();
  }
  was_moving_ = moving();
  for (SessionExtension* const guest : extensions_) guest->step_is_over();
  Frame frame = std::exchange(frame_, {});
  const std::vector<std::size_t> sight = panes_.visible();
  const std::vector<Viewport> rectangles = places();
  for (std::size_t i = 0; i < sight.size(); ++i)
    frame.pictures.push_back({sight[i], rectangles[i], panes_.at(sight[i]).view()});
  frame.moving = was_moving_;
  frame.loading = loading();
  frame.next_life = next_life();
  return frame;
}

void Session::show(std::shared_ptr<Document> document) {
  std::string path = document->world.path;
  if (path.empty()) path = "world";
  panes_.open(std::vector<std::string>{path});
  if (const auto reading = panes_.begin_loading()) panes_.deliver(reading->number, std::move(document), area_.size());
}

// Time --------------------------------------------------------------------------------------------

// Returns the visible running worlds, each once.
std::vector<Document*> Session::living() const {
  std::vector<Document*> result;
  for (const std::size_t i : panes_.visible()) {
    const View* seen = panes_.at(i).view();
    if (seen && seen->document->runtime &&
        std::find(result.begin(), result.end(), seen->document.get()) == result.end())
      result.push_back(seen->document.get());
  }
  return result;
}

std::optional<double> Session::next_life() const {
  std::optional<double> next;
  for (const Document* document : living())
    if (const auto time = document->runtime->next_time()) next = std::min(next.value_or(*time), *time);
  // Actions of an extension cause events and requests for files.
  if (acted_) next = life_due_;
  if (next) next = std::max(*next, life_due_);
  if (const auto due = series_.next_due()) next = std::min(next.value_or(*due), *due);
  return next;
}

// Sets the viewer position for the sensors of a world. A viewer at the bound Viewpoint follows it at each timestamp. A
// viewer that jumps to a Viewpoint is at its destination already (VRML97 6.53).
void Session::place_viewer(Document& document, const View& leader) const {
  vrml::Execution& execution = document.runtime->execution();
  if (const Viewport place = place_of(leader); place.height > 0)
    execution.set_aspect(static_cast<double>(place.width) / place.height);
  const std::optional<Transition>& way = leader.navigation.transition;
  const std::optional<glm::dvec3> before =
      std::exchange(document.destination, way ? std::optional(way->to.position) : std::nullopt);
  if (way && before != document.destination) execution.viewer_jumped();
  const bool at_viewpoint = at_home(leader) && (leader.viewpoint || options_.simulated);
  if (execution.is_told_viewer() || !at_viewpoint)
    execution.set_viewer(world_from_viewer(way ? way->to : leader.navigation.pose));
}

// Advances the visible worlds. Returns true if the picture changed.
bool Session::advance_worlds(bool look) {
  if (now_ < life_due_) return false;
  acted_ = false;
  const double started = world_time();
  bool any = false;
  sounds_.begin();
  for (Document* document : living()) {
    // The world has one viewer: that of the active viewport, if it shows this world.
    View* leader = view() && view()->document.get() == document ? view() : nullptr;
    std::vector<View*> views;
    for (const std::size_t i : panes_.visible())
      if (View* seen = panes_.at(i).view(); seen && seen->document.get() == document) views.push_back(seen);
    if (!leader) leader = views.front();
    vrml::Execution& execution = document->runtime->execution();
    // Changing the viewport moves the viewer without walking.
    const void* before = std::exchange(document->viewer, leader);
    if (before && before != leader) execution.viewer_jumped();
    place_viewer(*document, *leader);
    const bool moved = document->runtime->step(now_);
    take_script_news(*document);
    if (document->reader)
      if (std::vector<UrlRequest> urls = document->runtime->take_url_requests(); !urls.empty())
        document->reader->request(std::move(urls));
    const bool rebound = leader->bound != document->runtime->bound().viewpoint;
    if (look && document->runtime->show_movies(options_.simulated)) any = true;
    if (look || rebound)
      for (View* seen : views) any = follow_world(*seen) || any;
    if (rebound) any = follow_bound_viewpoint(*leader) || any;
    for (View* seen : views) {
      seen->bound = leader->bound;
      seen->bound_place = leader->bound_place;
    }
    end_journey(*leader);
    listen(*document, *leader);
    if (moved && leader == view() && pointed_pane_ == panes_.active()) point_again();
  }
  sounds_.end(now_);
  if (device_) device_->wake();
  if (options_.simulated) return any;
  // Worlds with slow events leave time for the user's input.
  const double took = world_time() - started;
  life_due_ = now_ + std::max(kLifeStep, took > kLongLife ? 3 * took : 0);
  return any;
}

bool Session::run_extensions(bool look) {
  bool any = false;
  for (SessionExtension* const guest : extensions_) any = guest->act(*this) || any;
  if (!any) return false;
  acted_ = true;
  if (look)
    for (const std::size_t i : panes_.visible())
      if (View* seen = panes_.at(i).view(); seen && seen->document->runtime) any = follow_world(*seen) || any;
  return any;
}

void Session::end_journey(View& seen) const {
  if (!options_.simulated || !seen.navigation.transition) return;
  seen.navigation.pose = seen.navigation.transition->to;
  seen.navigation.transition.reset();
}

// Moves the viewer to `after`, as far as collisions allow.
void Session::move_viewer(View& seen, Navigation after, bool loading, float seconds) {
  const render::RenderList& list = *seen.list;
  Obstacles obstacles;
  obstacles.near = [&](const glm::dvec3& lower, const glm::dvec3& upper) {
    return picker_.items().near(list, lower, upper, kMostMet);
  };
  obstacles.distance = [&](const glm::dvec3& origin, const glm::dvec3& direction) -> std::optional<double> {
    const auto hit = picker_.items().nearest(list, {origin, direction}, kMostRemembered, render::Sought::met);
    return hit ? std::optional(hit->triangle.distance) : std::nullopt;
  };
  Avatar avatar = seen.rules.avatar;
  avatar.radius *= seen.scale;
  avatar.height *= seen.scale;
  avatar.step *= seen.scale;
  avatar.gravity = !loading;  // the ground may not be loaded yet
  const std::optional<std::size_t> before = seen.navigation.body.item;
  seen.navigation = with_body(seen.navigation, std::move(after), avatar, obstacles, seconds);
  const std::optional<std::size_t> met = seen.navigation.body.item;
  if (!met || met == before || !seen.document->runtime) return;
  Hit hit;
  hit.item = *met;
  (void)seen.document->runtime->execution().collide(path_of(list, hit));
}

void Session::move_views(float seconds, bool look) {
  const std::vector<std::size_t> sight = panes_.visible();
  const std::vector<Viewport> rectangles = places();
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < sight.size(); ++i) {
    Pane& pane = panes_.at(sight[i]);
    View* seen = pane.view();
    if (!seen) continue;
    const Pose before = seen->navigation.pose;
    const NavigationInput input = pane.input.input(seen->navigation.mode, rectangles[i]);
    if (input.any()) {
      leader_ = sight[i];
      seen->history.interrupt();
    }
    move_viewer(*seen, app::step(seen->navigation, input, seconds), panes_.loading(sight[i]), seconds);
    const Pose& after = seen->navigation.pose;
    if (before.position == after.position && before.orientation == after.orientation && before.height == after.height)
      continue;
    seen->history.moved(before, after, now_);
    moved.push_back(sight[i]);
    frame_.changed = true;
    // The pointer is over another object now.
    if (pointed_pane_ == sight[i]) pointer_moved_ = true;
  }
  const auto has_moved = [&](std::size_t pane) { return std::find(moved.begin(), moved.end(), pane) != moved.end(); };
  if (linked_ && !moved.empty())
    panes_.link(has_moved(leader_) ? leader_ : has_moved(panes_.active()) ? panes_.active() : moved.front());
  if (!look) return;
  for (const std::size_t i : sight)
    if (View* seen = panes_.at(i).view()) (void)follow_world(*seen);
}

bool Session::moving() const {
  for (const std::size_t i : panes_.visible()) {
    const Pane& pane = panes_.at(i);
    const View* seen = pane.view();
    if (seen && (seen->navigation.moving() || pane.input.holding())) return true;
  }
  return false;
}

Viewport Session::place_of(std::size_t pane) const {
  const std::vector<std::size_t> sight = panes_.visible();
  const std::vector<Viewport> rectangles = places();
  for (std::size_t i = 0; i < sight.size(); ++i)
    if (sight[i] == pane) return rectangles[i];
  return area_;
}

Viewport Session::place_of(const View& view) const {
  for (std::size_t i = 0; i < kMostViewports; ++i)
    if (panes_.at(i).view() == &view) return place_of(i);
  return area_;
}

}  // namespace gs::app
