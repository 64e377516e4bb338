#include "app/base/text.h"
#include "app/viewer/viewer_window.h"

#include <algorithm>

namespace gs::app {
namespace {

// Discs of streams that may be decoded for one frame of all viewports: some 20 ms of one core.
constexpr std::size_t kMostDecoded = 250'000;
constexpr double kMostUninterrupted = 0.4;  // seconds of drawing before events are looked for
constexpr glm::vec3 kEmptyBackground(0.17f, 0.18f, 0.20f);

}  // namespace

void Viewer::draw_viewports() {
  std::vector<std::size_t> cloud_pixels, cloud_viewports;
  for (const Frame::Picture& picture : frame_.pictures) {
    const bool clouds = picture.view && picture.view->document->has_clouds();
    cloud_pixels.push_back(clouds ? picture.place.pixels() : 0);
    cloud_viewports.push_back(clouds ? 1 : 0);
  }
  const std::vector<std::size_t> budgets =
      shares_of(options_.budget > 0 ? options_.budget : kWindowBudget, cloud_pixels);
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
  pane.statistics = renderer_->draw(tools_.shown(picture.pane, *seen), camera_of(seen->navigation.pose), draw);
  const double end = Window::now();
  if (frame_.loading) pace_.note(pane.statistics.given_up, begin, end);
  // What was given up for the sake of progress says nothing about who moves.
  const bool given_up = pane.statistics.given_up;
  if (!given_up || frame_.loading) picture_seconds_ = end - begin;
  if (!given_up || !(frame_.loading || interface_first_))
    detail.note(draw.coarseness, pane.statistics.given_up, end - begin);
}

// The user interface ------------------------------------------------------------------------------

// "city.wrl: 3.1 of 12.0 MB, 4 files to come"
std::string Viewer::progress_of(const std::string& path) const {
  std::string text = file_label(path);
  for (const LoadingState& state : session_.progress_of(path)) {
    if (state.received == 0) continue;
    text += ": " + (state.total ? readable_part(state.received, *state.total) : readable_size(state.received));
    if (state.waiting > 1) text += ", " + std::to_string(state.waiting) + " files to come";
  }
  return text;
}

void Viewer::describe_viewports(UiModel& model) const {
  const Panes& panes = session_.panes();
  for (const Frame::Picture& picture : frame_.pictures) {
    const Pane& pane = panes.at(picture.pane);
    UiViewport viewport;
    viewport.place = picture.place;
    if (pane.view()) viewport.label = file_label(pane.shown);
    if (panes.loading(picture.pane)) viewport.loading = progress_of(pane.wanted);
    viewport.active = picture.pane == panes.active();
    model.viewports.push_back(std::move(viewport));
  }
  model.layout = panes.layout();
  model.linked = session_.linked();
}

Viewport Viewer::active_place() const {
  for (const Frame::Picture& picture : frame_.pictures)
    if (picture.pane == session_.panes().active()) return picture.place;
  return {};
}

ViewerTools::Tell Viewer::teller() {
  return [this](const std::string& text, bool is_problem) { ui_.show_notice(text, is_problem); };
}

UiModel Viewer::model() {
  UiModel model;
  const Panes& panes = session_.panes();
  for (const DocumentList::Entry& entry : panes.documents().entries()) model.files.push_back(file_label(entry.path));
  model.file = panes.selected();
  describe_viewports(model);
  if (const FolderQuestions::Question* question = session_.question())
    model.question = {file_label(question->worlds.front()), question->folder, question->reference};
  const Pane& pane = panes.at(panes.active());
  model.statistics = pane.statistics;
  model.frame_ms = frame_ms_;
  model.frames_a_second = frames_a_second_;
  model.gl_renderer = renderer_->gl_renderer();
  model.log = &session_.log();
  model.travel_anchor = pane.input.travel_anchor();
  model.pointer = pane.input.pointer();
  const View* seen = pane.view();
  if (const SeriesList::Series* series = session_.series()) {
    model.tools.files = series->files.size();
    model.tools.file = series->shown;
    model.tools.playing = series->playing;
    model.tools.rate = series->rate;
  }
  tools_.describe(model.tools, seen, active_place());
  if (!seen) return model;
  model.has_world = true;
  const auto& viewpoints = seen->list->viewpoints;
  for (const std::size_t index : listed_viewpoints(viewpoints)) {
    if (seen->viewpoint == index) model.viewpoint = model.viewpoints.size();
    model.viewpoints.push_back(viewpoint_label(viewpoints[index], index));
  }
  const Session::Pointed pointed = session_.pointed();
  model.over_sensor = pointed.sensor;
  model.link = pointed.description;
  model.mode = seen->navigation.mode;
  model.rules = seen->rules;
  model.speed = seen->navigation.speed;
  model.headlight = seen->headlight;
  model.has_sounds = !seen->list->sounds.empty();
  model.muted = session_.sounds().muted();
  model.look = seen->look;
  model.has_surface_clouds = seen->document->has_surface_clouds;
  model.has_volumes = seen->document->has_volumes;
  model.bounds = seen->list->bounds;
  model.looking = seen->navigation.pose.forward();
  for (const render::SplatItem& item : seen->list->splats)
    if (item.cloud && item.cloud->description.kind == qnv::Kind::volume) model.volumes.push_back(item.cloud);
  return model;
}

}  // namespace gs::app
