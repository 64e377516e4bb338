#include "app/viewer/viewer_window.h"

#include <algorithm>

namespace gs::app {
namespace {

// Discs of streams that may be decoded for one frame of all viewports: some 20 ms of one core.
constexpr std::size_t kMostDecoded = 250'000;
constexpr double kMostUninterrupted = 0.4;  // seconds of drawing before events are looked for
constexpr glm::vec3 kEmptyBackground(0.17f, 0.18f, 0.20f);

}  // namespace

// That of the command line comes before that of the settings.
std::size_t Viewer::budget() const {
  if (options_.budget > 0) return options_.budget;
  return desk_.kept().settings().budget > 0 ? desk_.kept().settings().budget : kWindowBudget;
}

void Viewer::draw_viewports() {
  std::vector<std::size_t> cloud_pixels, cloud_viewports;
  for (const Frame::Picture& picture : frame_.pictures) {
    const bool clouds = picture.view && picture.view->document->has_clouds();
    cloud_pixels.push_back(clouds ? picture.place.pixels() : 0);
    cloud_viewports.push_back(clouds ? 1 : 0);
  }
  const std::vector<std::size_t> budgets = shares_of(budget(), cloud_pixels);
  const std::vector<std::size_t> decoded = shares_of(kMostDecoded, cloud_viewports);
  bool pending = false;
  std::size_t discs = 0;
  for (std::size_t i = 0; i < frame_.pictures.size(); ++i) {
    const Viewport& place = frame_.pictures[i].place;
    render::DrawOptions draw;
    draw.x = place.left;
    draw.y = window_->framebuffer_size().y - place.top - place.height;
    draw.width = place.width;
    draw.height = place.height;
    draw.budget = budgets[i];
    draw.most_decoded = decoded[i];
    draw_viewport(frame_.pictures[i], draw);
    const render::FrameStatistics& statistics = session_.panes().at(frame_.pictures[i].pane).statistics;
    pending |= statistics.pending;
    discs += statistics.vectors;
  }
  refinement_.note(pending, discs, frames_wanted_ > 0 || frame_.moving);
}

void Viewer::draw_viewport(const Frame::Picture& picture, render::DrawOptions draw) {
  static const render::RenderList kNothing;
  Pane& pane = session_.panes().at(picture.pane);
  draw.viewport = static_cast<std::uint32_t>(picture.pane);
  draw.samples = options_.samples;
  draw.background = options_.background;
  draw.splats = options_.splats;
  const View* seen = picture.view;
  if (!seen) {
    if (!draw.background) draw.background = kEmptyBackground;
    pane.statistics = renderer_->draw(kNothing, render::Camera{}, draw);
    return;
  }
  // However long a picture takes, who does something is answered; all pixels come when nobody does.
  PictureDetail& detail = details_[picture.pane];
  const double begin = Window::now();
  draw.coarseness = detail.coarseness(frames_wanted_ > 0 || frame_.moving);
  draw.go_on = [this, begin] {
    if (interface_first_) return false;
    const double now = Window::now();
    if (frame_.loading && !pace_.go_on(begin, now)) return false;
    if (now - begin < kMostUninterrupted) return true;
    window_->poll();
    return !window_->should_close() && !window_->has_events();
  };
  draw.headlight = seen->headlight;
  if (seen->budget > 0) draw.budget = std::min(draw.budget, seen->budget);
  draw.unit = static_cast<float>(seen->scale);
  draw.clouds = seen->look;
  apply_style(*seen, draw);
  draw.guides = tools_.guides(*seen);
  pane.statistics = renderer_->draw(tools_.shown(picture.pane, *seen), camera_of(seen->navigation.pose), draw);
  const double end = Window::now();
  if (frame_.loading) pace_.note(pane.statistics.given_up, begin, end);
  // What was given up for the sake of progress says nothing about who moves.
  const bool given_up = pane.statistics.given_up;
  if (!given_up || frame_.loading) picture_seconds_ = end - begin;
  if (!given_up || !(frame_.loading || interface_first_))
    detail.note(draw.coarseness, pane.statistics.given_up, end - begin);
}

// What is measured, looked at more closely, or kept ------------------------------------------------

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
  if (action != Action::take_picture) return false;
  if (const View* seen = session_.view()) tools_.take_picture(*seen, active_place(), teller());
  return true;
}

void Viewer::note(const SessionInput::Event& event) { tools_.take(event, session_.view(), active_place()); }

void Viewer::describe_tools(UiTools& tools) { tools_.describe(tools, session_.view(), active_place()); }

void Viewer::apply_tools(const UiToolActions& actions) {
  tools_.apply(actions, session_.view(), active_place(), teller());
}

}  // namespace gs::app
