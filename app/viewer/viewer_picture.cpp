#include "app/streams/stream_feed.h"
#include "app/view/values/slice_scene.h"
#include "app/viewer/viewer_window.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"

#include <algorithm>

namespace gs::app {
namespace {

// Max vectors of streams that are decoded in a frame for all viewports. Takes about 20 ms of one core. Pictures at rest
// may decode more.
constexpr std::size_t kMaxDecoded = 250'000;
constexpr double kMaxUninterrupted = 0.4;  // seconds of drawing after which new events can cancel a picture
constexpr double kMaxAhead = 0.25;         // maximum of the expected drawing time, in seconds
constexpr int kSettlingFramesAfterWait = 3;
constexpr glm::vec3 kEmptyBackground(0.17f, 0.18f, 0.20f);

/// Returns a counter that increases when a stream of Gaussians receives or restores chunks.
std::uint64_t gaussians_revision(const render::RenderList& list) {
  std::uint64_t revision = 0;
  for (const render::SplatItem& item : list.splats)
    if (const auto* gaussians = item.geometry ? item.geometry->as<qnv::Gaussians>() : nullptr;
        gaussians && gaussians->stream)
      revision += gaussians->stream->revision();
  return revision;
}

}  // namespace

// Returns the vector budget: from the command line, else from the settings, else the default.
std::size_t Viewer::budget() const {
  if (options_.budget > 0) return options_.budget;
  return controller_.kept().settings().budget > 0 ? controller_.kept().settings().budget : kWindowBudget;
}

void Viewer::draw_viewports() {
  measures_.budget = budget();
  const std::vector<std::size_t> budgets = budgets_of(frame_, session_.panes(), measures_.budget);
  const std::vector<std::size_t> decoded = shares_of(kMaxDecoded, budgets);
  for (std::size_t i = 0; i < frame_.pictures.size(); ++i) {
    const Viewport& place = frame_.pictures[i].place;
    render::DrawOptions draw;
    draw.viewport = static_cast<std::uint32_t>(frame_.pictures[i].pane);
    draw.x = place.left;
    draw.y = window_->framebuffer_size().y - place.top - place.height;
    draw.width = place.width;
    draw.height = place.height;
    draw.samples = options_.samples;
    draw.background = options_.background;
    draw.splats = options_.splats;
    draw.budget = budgets[i];
    draw.most_decoded = decoded[i];
    if (frame_.pictures[i].view)
      draw_viewport(frame_.pictures[i], std::move(draw));
    else
      draw_nothing(frame_.pictures[i], std::move(draw));
  }
}

void Viewer::draw_waiting() {
  constexpr double kLongStep = 0.3, kBetweenFrames = 0.1;  // seconds
  const double now = Window::now();
  if (!step_began_ || now - *step_began_ < kLongStep || now - waiting_drawn_ < kBetweenFrames) return;
  waiting_drawn_ = now;
  if (!interface_open_) ui_.begin_frame(now, {});
  ui_.show_notice("Waiting for the Scripts of a world. Press Esc to stop them.", false);
  for (const Frame::Picture& picture : frame_.pictures) {
    render::DrawOptions draw;
    draw.viewport = static_cast<std::uint32_t>(picture.pane);
    draw.x = picture.place.left;
    draw.y = window_->framebuffer_size().y - picture.place.top - picture.place.height;
    draw.width = picture.place.width;
    draw.height = picture.place.height;
    (void)renderer_->show_again(draw);
  }
  model_.inspection = nullptr;  // its panels read the worlds
  UiActions actions = ui_.build(model_);
  if (interface_open_) late_actions_.push_back(std::move(actions));
  ui_.draw();
  window_->present();
  if (interface_open_) ui_.begin_frame(now, {});
  frames_wanted_ = kSettlingFramesAfterWait;
}

// Returns true if another thread prepares detail of a visible picture.
bool Viewer::awaits_finer() const {
  return std::any_of(frame_.pictures.begin(), frame_.pictures.end(), [this](const Frame::Picture& picture) {
    return session_.panes().at(picture.pane).statistics.working;
  });
}

// Returns true if drawing again would add detail to a visible picture.
bool Viewer::wants_finer() const {
  return std::any_of(frame_.pictures.begin(), frame_.pictures.end(),
                     [this](const Frame::Picture& picture) { return pictures_.wants_more(picture.pane); });
}

void Viewer::draw_nothing(const Frame::Picture& picture, render::DrawOptions draw) {
  if (!draw.background) draw.background = kEmptyBackground;
  render::FrameStatistics& statistics = session_.panes().at(picture.pane).statistics;
  statistics = start_page_.draw(*renderer_, picture.place, draw);
  pictures_.note(picture.pane, {}, statistics, 0);
}

void Viewer::draw_viewport(const Frame::Picture& picture, render::DrawOptions draw) {
  Pane& pane = session_.panes().at(picture.pane);
  const View& seen = *picture.view;
  draw.headlight = seen.headlight;
  if (seen.budget > 0) draw.budget = std::min(draw.budget, seen.budget);
  draw.unit = static_cast<float>(seen.scale);
  draw.splat_style = seen.look;
  draw.splat_style.reading = tools_.reading_of(seen);
  apply_style(seen, draw);
  draw.guides = tools_.guides(seen);
  const render::RenderList& list = tools_.shown(picture.pane, seen);
  PictureSource source{seen.list, &list, list.changes, 0, camera_of(seen.navigation.pose), draw};
  source.draw.x = source.draw.y = 0;
  source.draw.most_decoded = 0;
  for (const auto& feed : seen.document->world.feeds) source.grown += feed->applied();
  source.grown += detail_revision(*seen.list) + gaussians_revision(*seen.list);
  for (const View::Over& over : seen.over)
    if (over.view) source.grown += detail_revision(*over.view->list) + gaussians_revision(*over.view->list);
  if (seen.document->runtime) source.grown += seen.document->runtime->movies().pictures();
  const bool busy = frames_wanted_ > 0 || frame_.moving, same = pictures_.is_same(picture.pane, source);
  if (same && pictures_.stands(picture.pane, busy) && renderer_->show_again(draw)) return;
  // User input can cancel a picture that takes longer than kMaxUninterrupted. Without input, the picture is completed.
  PictureDetail& detail = details_[picture.pane];
  const double begin = Window::now();
  const std::size_t level = detail.level(busy && !same);
  draw.coarseness = PictureDetail::kQualities[level].coarseness;
  draw.splat_error = PictureDetail::splat_error(level);
  draw.most_gaussians = detail.most_gaussians(level);
  draw.fade = detail.fades(level);
  unsigned& rests = rests_[picture.pane];
  rests = same && level == 0 ? rests + 1 : 0;
  draw.most_decoded *= detail.decoded_amounts(rests);
  if (PictureDetail::kQualities[level].one_sample) draw.samples = 1;
  // Uses the fades of the time at which the picture will be visible.
  draw.time = begin + std::min(picture_seconds_, kMaxAhead);
  draw.go_on = [this, begin] {
    if (interface_first_) return false;
    const double now = Window::now();
    if (frame_.loading && !pace_.go_on(begin, now)) return false;
    if (now - begin < kMaxUninterrupted) return true;
    window_->poll();
    return !window_->should_close() && !window_->has_events();
  };
  const render::Camera camera = source.camera;
  pane.statistics = renderer_->draw(list, camera, draw);
  pane.statistics.pending = pane.statistics.pending || level > 0;
  const double end = Window::now();
  if (frame_.loading) pace_.note(pane.statistics.given_up, begin, end);
  // If drawing was cancelled only to show progress or the interface, its time is no measure for the detail during
  // motion.
  const bool given_up = pane.statistics.given_up;
  if (given_up)
    pictures_.note_given_up(picture.pane, pane.statistics);
  else
    pictures_.note(picture.pane, std::move(source), pane.statistics, end - begin);
  if (!given_up || frame_.loading) picture_seconds_ = end - begin;
  if (!given_up || !(frame_.loading || interface_first_))
    drawn_.push_back({picture.pane, level, given_up, pane.statistics.gaussians, end - begin});
}

// Tools: measuring, values and slices, saving ------------------------------------------------------

Viewport Viewer::active_place() const {
  for (const Frame::Picture& picture : frame_.pictures)
    if (picture.pane == session_.panes().active()) return picture.place;
  return {};
}

ViewerTools::Tell Viewer::teller() {
  return [this](const std::string& text, bool is_problem) { ui_.show_notice(text, is_problem); };
}

bool Viewer::run_tool(Action action) {
  if (action == Action::close) return tools_.close();
  if (action == Action::ruler) {
    tools_.toggle_ruler();
    return true;
  }
  if (action != Action::take_picture && action != Action::copy_picture && action != Action::tour_view) return false;
  const View* const seen = session_.view();
  if (!seen) return true;
  if (action == Action::tour_view)
    tools_.add_to_tour(*seen, teller());
  else if (action == Action::copy_picture)
    tools_.copy_picture(*seen, active_place(), teller());
  else
    tools_.take_picture(*seen, active_place(), teller());
  return true;
}

bool Viewer::take(const SessionInput::Event& event) { return tools_.take(event, session_.view(), active_place()); }

void Viewer::describe_tools(UiTools& tools) { tools_.describe(tools, session_.view(), active_place()); }

void Viewer::apply_tools(const UiToolActions& actions) {
  tools_.apply(actions, session_.view(), active_place(), teller());
}

}  // namespace gs::app
