#include "app/viewer/viewer.h"

#include "app/desktop/end_signals.h"
#include "app/interface/window_backend.h"
#include "app/viewer/headless.h"
#include "app/viewer/viewer_window.h"
#include "app/window/close_watch.h"
#include "render/image/image.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <utility>

namespace gs::app {
namespace {

constexpr int kSettlingFrames = 3;                  // number of frames until the interface has adapted to a change
constexpr double kIdleWait = 30;                    // seconds; max wait without events
constexpr double kLongPicture = 0.3;                // seconds; longer drawing is a delay that users notice
constexpr std::size_t kThumbnailVectors = 250'000;  // max vectors of a thumbnail; more would delay the window
constexpr double kMaxPresenting = 0.01;             // seconds; a longer time includes the wait for the display
constexpr double kLoadingWait = 0.25;               // seconds between pictures of the moving progress line

ViewerControllerOptions controller_options(const ViewerOptions& options, float scale) {
  ViewerControllerOptions result;
  result.session = options.session;
  if (scale > 0) result.session.style.pixels_per_point = render::kUsualPixelsPerPoint * double{scale};
  result.folders = options.folders;
  result.not_kept = options.not_kept;
  result.scale = scale;
  result.dialogs = dialog_programs();
  result.up_given = options.up_given;
  return result;
}

// Returns the size for a new window: that of the last window, unless the options set one.
glm::ivec2 first_size(const ViewerOptions& options) {
  if (!options.size_given && options.folders.any()) {
    const AppState memory = remembered(options.folders);
    if (memory.width > 0 && memory.height > 0) return {memory.width, memory.height};
  }
  return {options.width, options.height};
}

}  // namespace

std::variant<std::vector<std::byte>, std::string> paint(render::Renderer& renderer, const ViewerOptions& options,
                                                        const View& view, const render::RenderList& list,
                                                        const glm::ivec2& size) {
  render::DrawOptions draw;
  draw.width = size.x;
  draw.height = size.y;
  draw.samples = options.samples;
  draw.background = options.background;
  draw.splats = options.splats;
  draw.budget = options.budget > 0 ? options.budget : kWindowBudget;
  draw.viewport = static_cast<std::uint32_t>(kMaxViewports);  // keeps the levels of detail of the window's viewports
  draw.headlight = view.headlight;
  draw.unit = static_cast<float>(view.scale);
  draw.splat_style = view.look;
  apply_style(view, draw);
  auto made = renderer.draw_to_image(list, camera_of(view.navigation.pose), draw);
  if (auto* problem = std::get_if<render::ContextError>(&made)) return std::move(problem->message);
  return render::encode_png(std::get<render::Image>(made));
}

Viewer::Viewer(const ViewerOptions& options, const LoadOptions& load, std::unique_ptr<Window> window,
               std::unique_ptr<render::Renderer> renderer)
    : options_(options),
      window_(std::move(window)),
      renderer_(std::move(renderer)),
      controller_(controller_options(options, window_->content_scale()), load, make_window_backend(window_->handle()),
                  *this, &Window::wake),
      ui_(controller_.ui()),
      session_(controller_.session()),
      hand_over_(HandOver::listen(hand_over_folder(), &Window::wake)),
      tools_(options, *renderer_),
      start_page_(options.folders.state),
      frames_wanted_(kSettlingFrames) {
  measures_.gl_renderer = renderer_->gl_renderer();
}

std::optional<std::string> Viewer::start_control() {
  auto started = ControlService::start(options_.control, &Window::wake);
  if (auto* problem = std::get_if<std::string>(&started)) return std::move(*problem);
  control_ = std::move(std::get<std::unique_ptr<ControlService>>(started));
  control_->control().set_painter([this](const View& view, int width, int height) {
    return paint(*renderer_, options_, view, *view.list, {width, height});
  });
  session_.add_extension(control_->control());
  return std::nullopt;
}

void Viewer::run() {
  while (!ends()) {
    wait_for_something();
    const glm::ivec2 size = window_->framebuffer_size();
    const bool in_sight = size.x > 0 && size.y > 0;
    const double now = Window::now();
    const std::vector<WindowEvent> events = in_sight ? window_->take_events() : std::vector<WindowEvent>{};
    take_handed_over();
    if (controller_.take_chosen_files()) frames_wanted_ = kSettlingFrames;
    SessionInput input;
    input.look = in_sight;
    if (in_sight) input.area = ui_.picture_area(size);
    if (!events.empty()) {
      frames_wanted_ = kSettlingFrames;
      ui_.begin_frame(now, events);  // the interface has precedence over the worlds
      input.events = controller_.take(events);
    }
    interface_open_ = !events.empty();
    step_began_ = Window::now();
    frame_ = session_.step(world_time(), input);
    step_began_.reset();
    for (const UiActions& actions : std::exchange(late_actions_, {})) controller_.apply(actions);
    tell(frame_);
    if (controller_.inspection().busy() || controller_.inspection().take_news(now))
      frames_wanted_ = std::max(frames_wanted_, 1);
    if (!in_sight) continue;
    // If drawing the worlds takes long, draw the interface first after typing and at the end of loading.
    const bool typed = std::any_of(events.begin(), events.end(), [](const WindowEvent& event) {
      return event.kind == WindowEvent::Kind::key_down || event.kind == WindowEvent::Kind::character;
    });
    const bool was_read = std::exchange(was_loading_, frame_.loading) && !frame_.loading;
    interface_first_ = picture_seconds_ > kLongPicture && (was_read || (typed && !frame_.moving));
    // Draw nothing if nothing has changed. Another thread may have finished the detail that the last picture lacks.
    if (frames_wanted_ == 0 && !frame_.moving && !wants_finer() && !awaits_finer() && !frame_.loading) {
      was_in_motion_ = false;
      keep_thumbnail(true);
      continue;
    }
    if (events.empty()) ui_.begin_frame(now, events);
    const bool moves = frame_.moving || frame_.changed;
    const bool in_motion = std::exchange(was_in_motion_, moves) && moves;
    draw_viewports();
    keep_thumbnail(false);
    if (interface_first_) frames_wanted_ = kSettlingFrames;
    session_.streams().request();
    controller_.inspection().prepare(session_, frame_.pictures, now);
    model_ = controller_.model(frame_, measures_);
    start_page_.set_recent(model_.recent, window_->content_scale() * static_cast<float>(model_.settings.text_size));
    controller_.apply(ui_.build(model_));
    if (tools_.go_on(session_.view(), teller())) frames_wanted_ = kSettlingFrames;
    ui_.draw();
    present(now);
    measure(now, Window::now(), in_motion);
    if (frames_wanted_ > 0) --frames_wanted_;
    if (ui_.has_input_left()) frames_wanted_ = kSettlingFrames;
  }
  const glm::ivec2 size = window_->window_size();
  if (size.x > 0 && size.y > 0 && !window_->is_full_screen()) {
    const auto place = window_->place();
    controller_.note_window(size.x, size.y, place ? std::optional(std::array{place->x, place->y}) : std::nullopt);
  }
  window_->hide();
}

// Returns true if the main loop must end. Asks the user first if a request to close the window would lose edits.
bool Viewer::ends() {
  if (EndOnSignals::told() || (control_ && control_->control().wants_to_end())) return true;
  if (!window_->should_close()) return false;
  if (controller_.may_close()) return true;
  window_->keep_open();
  frames_wanted_ = kSettlingFrames;
  return false;
}

// Stores the thumbnail of the active viewport, if it is new. `rests` means that nothing is drawn in this step.
void Viewer::keep_thumbnail(bool rests) {
  const View* const seen = session_.view();
  // A thumbnail has no clock, so it would wait for the thread that prepares more detail.
  if (!seen || frame_.loading || awaits_finer() || !start_page_.wants(*seen, rests, Window::now())) return;
  ViewerOptions options = options_;
  options.budget = std::min(budget(), kThumbnailVectors);
  const auto made =
      paint(*renderer_, options, *seen, tools_.shown(kMaxViewports, *seen), {Thumbnails::kWidth, Thumbnails::kHeight});
  if (const auto* png = std::get_if<std::vector<std::byte>>(&made)) start_page_.keep(*seen, *png);
}

void Viewer::wait_for_something() {
  const glm::ivec2 size = window_->framebuffer_size();
  if (size.x <= 0 || size.y <= 0)
    window_->wait(kIdleWait);
  else if (frames_wanted_ > 0 || session_.motion().moving() || wants_finer() || window_->has_events())
    window_->poll();
  else
    wait_idle();
}

void Viewer::wait_idle() {
  const std::optional<double> change = ui_.next_change();
  double wait = frame_.loading || tools_.reads_values() || awaits_finer() ? kLoadingWait : kIdleWait;
  if (controller_.shows_rates()) {
    wait = std::min(wait, kLoadingWait);
    frames_wanted_ = std::max(frames_wanted_, 2);  // a new item is measured in one frame and shown in the next
  }
  if (frame_.next_life) wait = std::clamp(*frame_.next_life - world_time(), 0.0, wait);
  if (const auto next = controller_.inspection().next_change()) wait = std::min(wait, *next);
  const bool interface_first = change && *change <= wait;
  window_->wait(interface_first ? *change : wait);
  /// A new item is measured in one frame and shown in the next.
  if (interface_first) frames_wanted_ = std::max(frames_wanted_, 2);
}

// Reports the result of a step to the user, and decides how many frames must be drawn.
void Viewer::tell(const Frame& frame) {
  if (frame.news) frames_wanted_ = kSettlingFrames;
  if (frame.changed) frames_wanted_ = std::max(frames_wanted_, 1);
  if (controller_.tell(frame) || tools_.take_values()) frames_wanted_ = kSettlingFrames;
  show_title();
}

// Shows the frame that began at `started`. Records its duration for each picture in it.
void Viewer::present(double started) {
  const double drawn = Window::now();
  window_->present();
  const double seconds = drawn - started + std::min(Window::now() - drawn, kMaxPresenting);
  for (const DrawnPicture& picture : std::exchange(drawn_, {}))
    details_[picture.pane].note(picture.level, picture.given_up, seconds, picture.gaussians,
                                std::max(seconds - picture.seconds, 0.0));
}

void Viewer::measure(double started, double now, bool in_motion) {
  const double ms = (now - started) * 1000;
  double& average = measures_.frame_ms;
  average = average == 0 ? ms : average + 0.1 * (ms - average);
  rate_.drawn(started, in_motion);
  measures_.frames_a_second = rate_.a_second();
}

void Viewer::take_handed_over() {
  if (!hand_over_) return;
  const HandOver::Taken taken = hand_over_->take();
  if (!taken.files.empty()) session_.opening().open_files(taken.files);
  if (!taken.asked) return;
  window_->raise();
  frames_wanted_ = kSettlingFrames;
}

void Viewer::show_title() {
  const std::string title = controller_.title();
  if (title == title_) return;
  title_ = title;
  window_->set_title(title_);
}

int run_viewer(const ViewerOptions& given, const LoadOptions& load, std::string& error) {
  ViewerOptions options = given;
  // The first file of a server is requested while the window opens. Before that, there is no event loop to wake.
  const auto has_window = std::make_shared<std::atomic<bool>>(false);
  if (!options.session.files.empty())
    options.session.early = read_early(options.session.files.front(), load, [has_window] {
      if (*has_window) Window::wake();
    });
  const glm::ivec2 size = first_size(options);
  auto window = Window::open("GhostSpace", size.x, size.y);
  if (const auto* problem = std::get_if<render::ContextError>(&window)) {
    error = "cannot open a window: " + problem->message;
    return 1;
  }
  auto& context = std::get<std::unique_ptr<Window>>(window);
  *has_window = true;
  if (options.folders.any())
    if (const auto place = remembered(options.folders).place) context->move_to({(*place)[0], (*place)[1]});
  auto renderer = render::Renderer::create(*context);
  if (const auto* problem = std::get_if<render::ContextError>(&renderer)) {
    error = "cannot draw in a window: " + problem->message;
    return 1;
  }
  Viewer viewer(options, load, std::move(context), std::move(std::get<std::unique_ptr<render::Renderer>>(renderer)));
  if (options.control.any())
    if (auto problem = viewer.start_control()) {
      error = "cannot be controlled: " + *problem;
      return 1;
    }
  // Close the window in the regular way after a signal, for example at logout, so that there is nothing to restore.
  const EndWatch signals([] { Window::wake(); });
  const CloseWatch closing;
  const WorldStop stop([&] { return EndOnSignals::told() || closing.is_asked_to_stop(); },
                       [&] { viewer.draw_waiting(); });
  viewer.run();
  return 0;
}

}  // namespace gs::app
