#include "app/viewer.h"

#include "app/documents.h"
#include "app/input_tracker.h"
#include "app/picking.h"
#include "app/ui_overlay.h"
#include "app/window.h"
#include "app/worker.h"
#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

constexpr int kSettlingFrames = 3;     // the interface needs a second look after a change
constexpr double kIdleWait = 30;       // seconds; any event ends it
constexpr double kLoadingWait = 0.04;  // between pictures of the progress line
constexpr float kLeastSpeed = 1e-4f, kMostSpeed = 1e6f;

/// Window, world, renderer and user interface, tied together once a frame. Main thread only.
class Viewer {
 public:
  Viewer(const ViewerOptions& options, const OpenFunction& open, std::unique_ptr<Window> window,
         std::unique_ptr<render::Renderer> renderer)
      : options_(options),
        open_(open),
        window_(std::move(window)),
        renderer_(std::move(renderer)),
        ui_(window_->handle(), window_->content_scale()),
        worker_(&Window::wake) {
    documents_.open(options_.files);
  }

  void run();

 private:
  void wait_idle();
  void frame(double now);
  void load_next();
  void show_loaded(const std::string& path, std::unique_ptr<Document> document);
  void show_failed(const std::string& path, vrml::Diagnostics diagnostics);
  void show_selected();

  void handle(const WindowEvent& event);
  bool handle_command(const WindowEvent& event);
  bool handle_view_key(Key key);
  void point_at(const InputTracker::Gesture& gesture);
  [[nodiscard]] std::optional<float> distance_under(const glm::vec2& pointer) const;

  void choose_mode(NavigationMode mode);
  void bind_viewpoint(std::size_t index);
  void step_viewpoint(int direction);
  void fit();
  void reset();
  void change_speed(float factor);
  void open_files(const std::vector<std::string>& paths);
  void select_file(std::size_t index);

  [[nodiscard]] Viewport viewport() const;
  [[nodiscard]] bool moving() const;
  [[nodiscard]] UiModel model();
  void apply(const UiActions& actions);
  void draw_world();
  void measure(double started, double now, bool continuous);

  const ViewerOptions& options_;
  const OpenFunction& open_;
  std::unique_ptr<Window> window_;
  std::unique_ptr<render::Renderer> renderer_;
  UiOverlay ui_;
  InputTracker input_;
  DocumentList documents_;
  Document* document_ = nullptr;  // what is shown, owned by documents_
  vrml::Diagnostics log_;
  render::FrameStatistics statistics_;
  double last_frame_ = 0, frame_ms_ = 0, frames_a_second_ = 0;
  int frames_wanted_ = kSettlingFrames;
  bool was_continuous_ = false;
  Worker worker_;  // last: ends before what its delivery speaks of
};

void Viewer::run() {
  window_->set_title("GhostSpace");
  while (!window_->should_close()) {
    load_next();
    const bool minimised = window_->framebuffer_size().x <= 0 || window_->framebuffer_size().y <= 0;
    if (minimised)
      window_->wait(kIdleWait);
    else if (frames_wanted_ > 0 || moving())
      window_->poll();
    else if (worker_.busy())
      window_->wait(kLoadingWait);
    else
      wait_idle();
    if (worker_.poll()) frames_wanted_ = kSettlingFrames;
    if (!minimised) frame(Window::now());
  }
  window_->hide();
}

void Viewer::wait_idle() {
  const std::optional<double> change = ui_.next_change();
  window_->wait(change.value_or(kIdleWait));
  if (change) frames_wanted_ = std::max(frames_wanted_, 2);  // what appears is measured first, then shown
}

void Viewer::frame(double now) {
  const std::vector<WindowEvent> events = window_->take_events();
  if (!events.empty()) frames_wanted_ = kSettlingFrames;
  const bool continuous = was_continuous_;
  const float seconds = continuous ? static_cast<float>(now - last_frame_) : 0.0f;
  ui_.begin_frame(now, events);
  for (const WindowEvent& event : events) handle(event);
  if (document_) {
    const NavigationInput input = input_.input(document_->navigation.mode, viewport());
    document_->navigation = step(document_->navigation, input, seconds);
    follow_viewer(*document_);
  }
  draw_world();
  apply(ui_.build(model()));
  ui_.draw();
  window_->present();
  measure(now, Window::now(), continuous);
  was_continuous_ = moving();
  if (frames_wanted_ > 0) --frames_wanted_;
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

// Files -------------------------------------------------------------------------------------------

void Viewer::load_next() {
  if (worker_.busy()) return;
  const std::optional<std::string> path = documents_.begin_loading();
  if (!path) return;
  frames_wanted_ = kSettlingFrames;
  auto job = [this, path = *path]() -> Worker::Delivery {
    auto document = std::make_shared<std::unique_ptr<Document>>(make_document(open_(path)));
    return [this, path, document] { show_loaded(path, std::move(*document)); };
  };
  auto failed = [this, path = *path] {
    vrml::Diagnostics diagnostics;
    diagnostics.add({vrml::Severity::error, path, {}, "there is not enough memory to open it"});
    show_failed(path, std::move(diagnostics));
  };
  worker_.start(std::move(job), std::move(failed));
}

void Viewer::show_loaded(const std::string& path, std::unique_ptr<Document> document) {
  if (!document->world.scene) {
    show_failed(path, std::move(document->world.diagnostics));
    return;
  }
  // Who reads a file again has changed something and wants to see it, from where he is.
  const DocumentList::Entry& selected = documents_.entries()[documents_.selected()];
  const bool again = document_ && selected.path == path && selected.document.get() == document_;
  const Navigation before = again ? document_->navigation : Navigation{};
  documents_.deliver(std::move(document));
  show_selected();
  if (!again || !document_->rules.allows(before.mode)) return;
  document_->navigation.pose = before.pose;
  document_->navigation.mode = before.mode;
}

void Viewer::show_failed(const std::string& path, vrml::Diagnostics diagnostics) {
  documents_.fail();
  std::string reason = "it could not be read";
  for (const vrml::Diagnostic& diagnostic : diagnostics.entries()) {
    if (diagnostic.severity != vrml::Severity::error) continue;
    reason = diagnostic.message;
    break;
  }
  show_selected();
  ui_.show_notice("Could not open " + file_label(path) + ": " + reason, true);
  log_ = std::move(diagnostics);
  ui_.show_log();
}

void Viewer::show_selected() {
  Document* shown = documents_.shown();
  if (shown == document_ && shown && shown->entered) return;
  document_ = shown;
  input_.release();
  ui_.clear_notice();
  frames_wanted_ = kSettlingFrames;
  if (!document_) return;
  if (!document_->entered) {
    if (!enter(*document_, viewport().size(), options_.viewpoint))
      ui_.show_notice("There is no Viewpoint \"" + options_.viewpoint + "\" in this world", true);
    if (options_.headlight) document_->headlight = *options_.headlight;
    if (document_->world.diagnostics.errors() > 0) ui_.show_log();
  }
  log_ = document_->world.diagnostics;
  const std::string& title = document_->world.title;
  window_->set_title((title.empty() ? file_label(document_->world.path) : title) + " - GhostSpace");
}

void Viewer::open_files(const std::vector<std::string>& paths) {
  documents_.open(paths);
  show_selected();
}

void Viewer::select_file(std::size_t index) {
  documents_.select(index);
  show_selected();
}

// Input -------------------------------------------------------------------------------------------

void Viewer::handle(const WindowEvent& event) {
  using Kind = WindowEvent::Kind;
  if (event.kind == Kind::drop) return open_files(event.paths);
  if (event.kind == Kind::key_down && (handle_command(event) || ui_.wants_keys())) return;
  if (event.kind == Kind::key_down && !event.control && !event.alt && handle_view_key(event.key)) return;
  if ((event.kind == Kind::button_down || event.kind == Kind::wheel) && ui_.wants_pointer()) return;
  if (document_) point_at(input_.take(event, document_->navigation.mode));
}

bool Viewer::handle_command(const WindowEvent& event) {
  switch (event.key) {
    case Key::f1:
      ui_.toggle_help();
      return true;
    case Key::f2:
      ui_.toggle_statistics();
      return true;
    case Key::f3:
      ui_.toggle_log();
      return true;
    case Key::f5:
      documents_.reload();
      return true;
    case Key::f11:
      window_->toggle_full_screen();
      return true;
    case Key::escape:
      ui_.close_one();
      return true;
    case Key::tab: {
      const std::size_t count = documents_.entries().size();
      if (!event.control || count == 0) return false;
      select_file((documents_.selected() + (event.shift ? count - 1 : 1)) % count);
      return true;
    }
    default:
      break;
  }
  if (!event.control || event.alt) return false;
  if (event.key == letter_key('Q')) return window_->close(), true;
  if (event.key == letter_key('O')) return ui_.show_open_panel(), true;
  return false;
}

bool Viewer::handle_view_key(Key key) {
  if (!document_) return false;
  switch (key) {
    case Key::page_down:
      step_viewpoint(1);
      return true;
    case Key::page_up:
      step_viewpoint(-1);
      return true;
    case Key::home:
      reset();
      return true;
    case Key::plus:
      change_speed(std::sqrt(2.0f));
      return true;
    case Key::minus:
      change_speed(std::sqrt(0.5f));
      return true;
    default:
      break;
  }
  if (key == letter_key('F')) return fit(), true;
  if (key == letter_key('H')) return document_->headlight = !document_->headlight, true;
  const int digit = static_cast<int>(key) - '0';
  if (digit < 1 || digit >= kNavigationModeCount) return false;
  choose_mode(static_cast<NavigationMode>(digit));
  return true;
}

void Viewer::point_at(const InputTracker::Gesture& gesture) {
  if (!gesture.needs_target && !gesture.double_click) return;
  const glm::vec2 pointer = viewport().inside(input_.pointer());
  const std::optional<float> hit = distance_under(pointer);
  Navigation& navigation = document_->navigation;
  const Ray ray = ray_through(navigation.pose, pointer, viewport().size());
  if (gesture.needs_target) input_.set_target(target_of(navigation, ray, hit));
  const bool turns = navigation.mode == NavigationMode::examine || navigation.mode == NavigationMode::pan;
  if (gesture.double_click && turns && hit) navigation = look_at_point(navigation, ray.at(*hit));
}

std::optional<float> Viewer::distance_under(const glm::vec2& pointer) const {
  const Ray ray = ray_through(document_->navigation.pose, pointer, viewport().size());
  const std::optional<Hit> hit = pick(document_->list, ray);
  return hit ? std::optional(hit->distance) : std::nullopt;
}

// What the user can ask for -------------------------------------------------------------------------

void Viewer::choose_mode(NavigationMode mode) {
  if (!document_) return;
  if (!document_->rules.allows(mode)) {
    ui_.show_notice("This world does not allow " + std::string(row_of(mode).label), false);
    return;
  }
  document_->navigation = with_mode(document_->navigation, mode);
  input_.release();
}

void Viewer::bind_viewpoint(std::size_t index) {
  if (!document_ || index >= document_->list.viewpoints.size()) return;
  const render::ViewpointState& viewpoint = document_->list.viewpoints[index];
  document_->viewpoint = index;
  document_->home = pose_of(viewpoint.world_from_camera, viewpoint.field_of_view);
  document_->navigation = travel_to(document_->navigation, document_->home);
}

void Viewer::step_viewpoint(int direction) {
  const std::vector<std::size_t> listed = listed_viewpoints(document_->list.viewpoints);
  if (listed.empty()) return;
  const auto place = std::find(listed.begin(), listed.end(), document_->viewpoint.value_or(listed.front()));
  const std::size_t index = place == listed.end() ? 0 : static_cast<std::size_t>(place - listed.begin());
  const std::size_t count = listed.size();
  const std::size_t next = listed[(index + (direction > 0 ? 1 : count - 1)) % count];
  bind_viewpoint(next);
  ui_.show_notice(model().viewpoints[(index + (direction > 0 ? 1 : count - 1)) % count], false);
}

void Viewer::fit() {
  if (!document_ || document_->list.bounds.empty() || document_->navigation.mode == NavigationMode::none) return;
  Navigation& navigation = document_->navigation;
  navigation = travel_to(navigation, pose_that_fits(navigation.pose, document_->list.bounds, viewport().size()));
  navigation.center = document_->list.bounds.center();
}

void Viewer::reset() {
  if (!document_) return;
  document_->navigation = travel_to(document_->navigation, document_->home);
  if (!document_->list.bounds.empty()) document_->navigation.center = document_->list.bounds.center();
}

void Viewer::change_speed(float factor) {
  Navigation& navigation = document_->navigation;
  if (navigation.speed <= 0) return;
  navigation.speed = std::clamp(navigation.speed * factor, kLeastSpeed, kMostSpeed);
  std::string number = std::to_string(navigation.speed);
  number.resize(std::min<std::size_t>(number.size(), 6));
  ui_.show_notice("Speed " + number + " m/s", false);
}

// Frame -------------------------------------------------------------------------------------------

Viewport Viewer::viewport() const {
  const glm::ivec2 size = window_->framebuffer_size();
  Viewport result;
  result.top = std::min(ui_.top_height(), std::max(0, size.y - 1));
  result.width = std::max(1, size.x);
  result.height = std::max(1, size.y - result.top - ui_.bottom_height());
  return result;
}

bool Viewer::moving() const { return document_ && (document_->navigation.moving() || input_.holding()); }

UiModel Viewer::model() {
  UiModel model;
  for (const DocumentList::Entry& entry : documents_.entries()) model.files.push_back(file_label(entry.path));
  model.file = documents_.selected();
  if (!documents_.loading().empty()) model.loading = file_label(documents_.loading());
  model.statistics = statistics_;
  model.frame_ms = frame_ms_;
  model.frames_a_second = frames_a_second_;
  model.gl_renderer = renderer_->gl_renderer();
  model.log = &log_;
  model.travel_anchor = input_.travel_anchor();
  model.pointer = input_.pointer();
  if (!document_) return model;
  model.has_world = true;
  for (const std::size_t index : listed_viewpoints(document_->list.viewpoints)) {
    if (document_->viewpoint == index) model.viewpoint = model.viewpoints.size();
    model.viewpoints.push_back(viewpoint_label(document_->list.viewpoints[index], index));
  }
  model.mode = document_->navigation.mode;
  model.rules = document_->rules;
  model.speed = document_->navigation.speed;
  model.headlight = document_->headlight;
  return model;
}

void Viewer::apply(const UiActions& actions) {
  if (actions.open) open_files({*actions.open});
  if (actions.file) select_file(*actions.file);
  if (!document_) return;
  if (actions.viewpoint) {
    const std::vector<std::size_t> listed = listed_viewpoints(document_->list.viewpoints);
    if (*actions.viewpoint < listed.size()) bind_viewpoint(listed[*actions.viewpoint]);
  }
  if (actions.previous_viewpoint) step_viewpoint(-1);
  if (actions.next_viewpoint) step_viewpoint(1);
  if (actions.mode) choose_mode(*actions.mode);
  if (actions.reset) reset();
  if (actions.fit) fit();
  if (actions.toggle_headlight) document_->headlight = !document_->headlight;
}

void Viewer::draw_world() {
  static const render::RenderList kNothing;
  const Viewport place = viewport();
  render::DrawOptions draw;
  draw.x = place.left;
  draw.y = window_->framebuffer_size().y - place.top - place.height;
  draw.width = place.width;
  draw.height = place.height;
  draw.samples = options_.samples;
  draw.background = options_.background;
  if (!document_) {
    if (!draw.background) draw.background = glm::vec3(0.17f, 0.18f, 0.20f);
    statistics_ = renderer_->draw(kNothing, render::Camera{}, draw);
    return;
  }
  draw.headlight = document_->headlight;
  statistics_ = renderer_->draw(document_->list, camera_of(document_->navigation.pose), draw);
}

}  // namespace

int run_viewer(const ViewerOptions& options, const OpenFunction& open, std::string& error) {
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
  Viewer viewer(options, open, std::move(context), std::move(std::get<std::unique_ptr<render::Renderer>>(renderer)));
  viewer.run();
  return 0;
}

}  // namespace gs::app
