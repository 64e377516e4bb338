#include "app/session/session.h"

#include "app/base/world_work.h"
#include "app/session/navigation/script_effects.h"
#include "render/scene/late_meshes.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

constexpr double kLifeStep = 1.0 / 60;  // min seconds between two steps of worlds
constexpr double kLongLife = 0.05;

// Returns the worker that makes large meshes in the background. Returns null in simulated time, where all meshes are
// made at once.
std::shared_ptr<render::MeshWorker> mesh_worker(bool simulated, const std::function<void()>& wake, Picker& picker) {
  if (simulated) return nullptr;
  return std::make_shared<render::MeshWorker>(
      wake, [trees = picker.items().trees()](const auto& mesh) { trees->prepare(mesh); });
}

}  // namespace

// Step --------------------------------------------------------------------------------------------

Session::Session(const SessionOptions& options, LoadOptions load, const std::function<void()>& wake)
    : load_(std::move(load)),
      step_{options.simulated},
      viewports_(step_),
      sound_(step_, options.audible, options.muted),
      series_(step_, viewports_.panes()),
      questions_(load_, viewports_.panes()),
      camera_(step_, viewports_, picker_, options.speed),
      motion_(step_, viewports_, picker_),
      opening_(step_, viewports_, load_, log_),
      travel_(viewports_, opening_),
      links_(step_, viewports_, camera_, opening_, travel_, load_, log_),
      pointing_(step_, viewports_, picker_, links_),
      first_views_(step_, viewports_, camera_, opening_, links_, picker_,
                   {options.viewpoint, options.headlight, options.camera}),
      data_(step_, viewports_, load_),
      follower_(step_, viewports_, series_.list(), load_, wake),
      live_(step_, viewports_, load_, wake),
      readers_(step_, viewports_, load_, {log_, questions_, series_.list(), links_, data_, follower_}, wake,
               mesh_worker(options.simulated, wake, picker_)),
      streams_(step_, viewports_, readers_, load_),
      input_(step_, {viewports_, opening_, links_, travel_, camera_, pointing_, sound_}) {
  viewports_.observe([this] { pointing_.leave(); }, [this](std::size_t pane) { travel_.forget(pane); });
  viewports_.loading().set_style(options.style);
  readers_.use(options.early);
  opening_.start(options.files, options.split);
}

Frame Session::step(double now, const SessionInput& input) {
  const double before = std::exchange(step_.now, now);
  follower_.check();
  live_.check();
  readers_.begin();
  streams_.limit_rates();
  if (readers_.take_news()) step_.frame.news = true;
  if (readers_.take_meshes()) step_.frame.changed = true;
  if (streams_.feed()) step_.frame.changed = true;
  streams_.prioritize();
  if (advance_worlds(input.look)) step_.frame.changed = true;
  if (run_extensions(input.look)) step_.frame.changed = true;
  if (input.area) handle_input(input, was_moving_ ? static_cast<float>(now - before) : 0.0f);
  was_moving_ = motion_.moving();
  for (SessionExtension* const extension : extensions_) extension->step_is_over();
  Frame frame = std::exchange(step_.frame, {});
  const std::vector<std::size_t> sight = panes().visible();
  const std::vector<Viewport> rectangles = viewports_.places();
  for (std::size_t i = 0; i < sight.size(); ++i)
    frame.pictures.push_back({sight[i], rectangles[i], panes().at(sight[i]).view()});
  frame.moving = was_moving_;
  frame.loading = readers_.loading();
  frame.next_life = next_event();
  return frame;
}

// Handles the events of a step, and moves the viewers by `seconds`.
void Session::handle_input(const SessionInput& input, float seconds) {
  viewports_.set_area(*input.area);
  first_views_.show();
  if (!step_.simulated) travel_.note_visits();
  for (const SessionInput::Event& event : input.events) input_.handle(event);
  for (const std::size_t pane : motion_.advance(seconds, input.look)) pointing_.note_viewer_moved(pane);
  pointing_.update();
}

// Time --------------------------------------------------------------------------------------------

// Returns the running worlds in visible viewports, each once.
std::vector<Document*> Session::running() {
  std::vector<Document*> result;
  for (View* const seen : panes().views_in_sight()) {
    if (seen->document->runtime && std::find(result.begin(), result.end(), seen->document.get()) == result.end())
      result.push_back(seen->document.get());
  }
  return result;
}

// Returns the time of the next event in the visible worlds, or the time at which a series shows its next file.
std::optional<double> Session::next_event() {
  std::optional<double> next;
  for (const Document* document : running())
    if (const auto time = document->runtime->next_time()) next = std::min(next.value_or(*time), *time);
  // After an extension has acted, step soon: its actions may cause events and requests.
  if (acted_) next = life_due_;
  if (next) next = std::max(*next, life_due_);
  for (const auto due : {series_.next_due(), follower_.next_due(), live_.next_due()})
    if (due) next = std::min(next.value_or(*due), *due);
  return next;
}

// Sets the viewer's position in a world, for its sensors. A viewer that rests at a bound Viewpoint is not set, because
// it moves with the Viewpoint. For a viewer on its way to a Viewpoint, the destination is set (VRML97 6.53).
void Session::place_viewer(Document& document, const View& leader) const {
  vrml::Execution& execution = document.runtime->execution();
  const Viewport place = viewports_.place_of(leader);
  if (place.height > 0) execution.viewer().set_aspect(static_cast<double>(place.width) / place.height);
  tell_viewport(document, leader, place);
  const std::optional<Transition>& way = leader.navigation.transition;
  const std::optional<glm::dvec3> before =
      std::exchange(document.destination, way ? std::optional(way->to.position) : std::nullopt);
  if (way && before != document.destination) execution.viewer().jump();
  const bool at_viewpoint = at_home(leader) && (leader.viewpoint || step_.simulated);
  if (execution.viewer().is_set() || !at_viewpoint)
    execution.viewer().set(world_from_viewer(way ? way->to : leader.navigation.pose));
  execution.viewer().set_center(leader.navigation.center);
}

// Advances time in the visible worlds. Returns true if a picture changed.
bool Session::advance_worlds(bool look) {
  if (step_.now < life_due_) return false;
  acted_ = false;
  const double started = world_time();
  const WorldWork work;
  bool any = false;
  sound_.begin();
  for (Document* document : running()) any = advance_world(*document, look) || any;
  sound_.end();
  if (step_.simulated) return any;
  // If this took long, wait before the next step of worlds, so that time remains for the user's input.
  const double took = world_time() - started;
  life_due_ = step_.now + std::max(kLifeStep, took > kLongLife ? 3 * took : 0);
  return any;
}

// Advances time in one world and updates its views. Returns true if a picture changed.
bool Session::advance_world(Document& document, bool look) {
  bool any = false;
  std::vector<View*> views;
  for (View* const seen : panes().views_in_sight())
    if (seen->document.get() == &document) views.push_back(seen);
  // A world has only one viewer. Use the view of the active viewport if it shows this world, else the first view.
  View* leader = view() && view()->document.get() == &document ? view() : views.front();
  vrml::Execution& execution = document.runtime->execution();
  // If another view is used now, the viewer jumps instead of moving through the world.
  const void* before = std::exchange(document.viewer, leader);
  if (before && before != leader) execution.viewer().jump();
  place_viewer(document, *leader);
  const bool moved = document.runtime->step(step_.now);
  links_.take_script_news(document);
  if (document.reader)
    if (std::vector<UrlRequest> urls = document.runtime->take_url_requests(); !urls.empty())
      document.reader->request(std::move(urls));
  const bool rebound = leader->bound != document.runtime->bound().viewpoint;
  if (look && document.runtime->movies().show(step_.simulated)) any = true;
  if (look || rebound)
    for (View* seen : views) any = follow_world(*seen) || any;
  if (rebound) any = follow_bound_viewpoint(*leader) || any;
  for (View* seen : views) {
    seen->bound = leader->bound;
    seen->bound_place = leader->bound_place;
  }
  if (apply_script_requests(*leader)) any = true;
  camera_.end_journey(*leader);
  if (execution.browser().settings().sound) sound_.add(document, *leader);
  if (moved && leader == view()) pointing_.repeat_in(panes().active());
  return any;
}

bool Session::run_extensions(bool look) {
  bool any = false;
  for (SessionExtension* const extension : extensions_) any = extension->act(*this) || any;
  if (!any) return false;
  acted_ = true;
  if (look)
    for (View* const seen : panes().views_in_sight())
      if (seen->document->runtime) any = follow_world(*seen) || any;
  return any;
}

}  // namespace gs::app
