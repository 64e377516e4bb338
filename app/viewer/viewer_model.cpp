#include "app/view/ground_grid.h"
#include "app/view/values/color_bar.h"
#include "app/viewer/viewer_controller.h"
#include "app/viewer/viewer_data.h"
#include "app/viewer/viewer_splats.h"
#include "base/text.h"
#include "net/base/schemes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

// Collection of the state that the interface shows, from the session of a ViewerController.
namespace gs::app {
namespace {

constexpr double kWeightSteps = 64;  // integer steps for a weight of 1

}  // namespace

std::vector<std::size_t> budgets_of(const Frame& frame, const Panes& panes, std::size_t budget) {
  std::vector<std::size_t> weights;
  for (const Frame::Picture& picture : frame.pictures) {
    const bool has_vectors = picture.view && picture.view->document->has_vectors();
    const double weight = std::round(panes.at(picture.pane).weight * kWeightSteps);
    weights.push_back(has_vectors ? picture.place.pixels() * static_cast<std::size_t>(weight) : 0);
  }
  return shares_of(budget, weights);
}

// Returns the name of a file with its progress, such as "city.wrl: 3.1 of 12.0 MB, 4 files left".
std::string ViewerController::progress_of(const std::string& path) {
  std::string text = file_label(path);
  for (const LoadingState& state : session_.readers().progress_of(path)) {
    if (state.received == 0) continue;
    text += ": " + (state.total ? readable_part(state.received, *state.total) : readable_size(state.received));
    if (state.waiting > 1) text += ", " + std::to_string(state.waiting) + " files left";
  }
  return text;
}

// Returns why the Scripts or the events of a world have ended; empty while they go on.
static std::string reason_of_stop(WorldRuntime& runtime) {
  if (runtime.execution().budget().is_halted()) return "Its events have ended: they took long and were stopped.";
  const ScriptRunner* const runner = runtime.programs().runner();
  return runner && !runner->stopped().empty() ? "Its Scripts have ended: " + runner->stopped() + "." : std::string();
}

bool ViewerController::shows_rates() const {
  return std::any_of(readings_.begin(), readings_.end(), [](const RateHistory& one) { return one.rate() > 0; });
}

// Reports whether a viewport shows a step of a running simulation and loads the next one, which needs no notice.
static bool shows_live_step(const Pane& pane) {
  const View* const view = pane.shown == pane.wanted ? pane.view() : nullptr;
  return view && !view->document->world.live.empty();
}

void ViewerController::describe_viewports(UiModel& model, const Frame& frame, std::size_t budget) {
  const Panes& panes = session_.panes();
  const std::vector<std::size_t> budgets = budgets_of(frame, panes, budget);
  const double drawn = static_cast<double>(std::accumulate(budgets.begin(), budgets.end(), std::size_t{0}));
  for (std::size_t i = 0; i < readings_.size(); ++i)
    if (std::none_of(frame.pictures.begin(), frame.pictures.end(), [i](const auto& one) { return one.pane == i; }))
      readings_[i] = {};
  for (const Frame::Picture& picture : frame.pictures) {
    const Pane& pane = panes.at(picture.pane);
    UiViewport viewport;
    viewport.pane = picture.pane;
    viewport.place = picture.place;
    if (const View* seen = pane.view()) {
      viewport.label = file_label(pane.shown);
      viewport.axes = seen->style.axes && !seen->document->world.authored;
      viewport.pose = seen->navigation.pose;
      if (const auto& runtime = seen->document->runtime) viewport.stopped = reason_of_stop(*runtime);
    }
    if (panes.loading(picture.pane) && !shows_live_step(pane)) {
      viewport.loading = progress_of(pane.wanted);
      viewport.loaded = received_part(session_.readers().progress_of(pane.wanted));
    }
    viewport.active = picture.pane == panes.active();
    viewport.weight = pane.weight;
    viewport.budget = budgets[model.viewports.size()];
    if (drawn > 0) viewport.vectors = static_cast<double>(viewport.budget) / drawn;
    viewport.reading = session_.streams().reading_share(picture.pane);
    viewport.rate = session_.streams().rate_of(picture.pane);
    RateHistory& history = readings_[picture.pane];
    (void)history.note(session_.streams().received(picture.pane), world_time());
    viewport.arriving = history.rate();
    if (pane.failure) {
      viewport.failed = file_label(pane.failure->path);
      viewport.reason = pane.failure->error;
    }
    model.viewports.push_back(std::move(viewport));
  }
  for (const std::size_t pane : panes_of(panes.split()))
    model.pane_labels.emplace_back(pane, panes.at(pane).view() ? file_label(panes.at(pane).shown) : std::string());
  model.panes = model.pane_labels.size();
  model.maximised = panes.split().maximised.has_value();
  model.layout = layout_of(panes.split());
  model.dividers = session_.viewports().dividers();
  model.linked = session_.viewports().linked();
}

UiModel ViewerController::model(const Frame& frame, const PictureMeasures& measures) {
  UiModel model;
  const Panes& panes = session_.panes();
  for (const DocumentList::Entry& entry : panes.documents().entries()) {
    model.files.push_back(file_label(entry.path));
    model.paths.push_back(entry.path);
  }
  model.file = panes.selected();
  describe_viewports(model, frame, measures.budget);
  if (auto question = saver_.question())
    model.question = std::move(question);
  else if (const FolderQuestions::Question* folder = session_.questions().folder())
    model.question = {UiQuestion::Kind::folder, file_label(folder->worlds.front()), folder->folder, folder->reference};
  else if (const auto network = session_.questions().network())
    model.question = {UiQuestion::Kind::network, file_label(network->world), network->question.url,
                      net::url_for_messages(network->question.file)};
  const Pane& pane = panes.at(panes.active());
  describe_user(model, pane);
  model.statistics = pane.statistics;
  model.frame_ms = measures.frame_ms;
  model.frames_a_second = measures.frames_a_second;
  model.gl_renderer = measures.gl_renderer;
  model.log = &session_.log();
  model.inspection = &inspection_;
  model.travel_anchor = pane.input.travel_anchor();
  model.pointer = pane.input.pointer();
  const View* seen = pane.view();
  if (const SeriesList::Series* series = session_.series().current()) {
    model.tools.files = series->files.size();
    model.tools.file = series->shown;
    if (series->shown < series->times.size()) model.tools.file_time = series->times[series->shown];
    model.tools.playing = series->playing;
    model.tools.rate = series->rate;
  }
  window_.describe_tools(model.tools);
  model.data = describe_data(session_);
  const auto active = std::ranges::find(model.viewports, true, &UiViewport::active);
  model.splats =
      describe_splats(session_, active == model.viewports.end() ? std::nullopt : std::optional(active->place));
  if (!seen) return model;
  model.has_world = true;
  model.first_steps = store_.settings().first_steps && !record_.not_kept().empty() && pane.shown == record_.not_kept();
  const auto& viewpoints = seen->list->viewpoints;
  for (const std::size_t index : listed_viewpoints(viewpoints, seen->navigation.pose.position)) {
    if (seen->viewpoint == index) model.viewpoint = model.viewpoints.size();
    model.viewpoints.push_back(viewpoint_label(viewpoints[index], index));
  }
  const Pointing::Pointed pointed = session_.pointing().pointed();
  model.over_sensor = pointed.sensor;
  model.link = pointed.description;
  model.mode = seen->navigation.mode;
  model.rules = seen->rules;
  model.speed = seen->navigation.speed;
  model.headlight = seen->headlight;
  model.style = seen->style;
  model.pose = seen->navigation.pose;
  model.upright = upright_of(*seen);
  if (const double spacing = seen->style.grid ? grid_spacing(seen->list->bounds, model.upright) : 0; spacing > 0)
    model.grid_text = "Grid: " + readable_value(spacing, seen->document->world.authored ? "m" : "");
  const auto has_edit = [&](int direction) {
    return seen->document->edits.time_of(direction) || seen->document->splats.time_of(direction);
  };
  model.can_undo = session_.camera().can_undo_move(-1) || has_edit(-1);
  model.can_redo = session_.camera().can_undo_move(1) || has_edit(1);
  model.has_sounds = !seen->list->sounds.empty();
  model.muted = session_.sound().stage().muted();
  model.look = seen->look;
  model.has_surface_vectors = seen->document->has_surface_vectors;
  model.has_volumes = seen->document->has_volumes;
  model.bounds = seen->list->bounds;
  model.looking = seen->navigation.pose.forward();
  for (const render::SplatItem& item : seen->list->splats)
    if (auto volume = qnv::shared_as<qnv::Volume>(item.geometry)) model.volumes.push_back(std::move(volume));
  if (model.tools.vectors && !model.volumes.empty()) model.volumes.front() = model.tools.vectors;
  return model;
}

void ViewerController::describe_user(UiModel& model, const Pane& pane) {
  model.settings = store_.settings();
  model.recent = store_.state().recent;
  model.bookmarks = store_.bookmarks();
  model.to_restore = record_.to_restore();
  model.address = pane.wanted.empty() ? pane.shown : pane.wanted;
  model.bookmark = bookmarks_.find();
  model.can_go_back = session_.travel().can_go(-1);
  model.can_go_forward = session_.travel().can_go(1);
  const Panes& panes = session_.panes();
  model.loading = panes.loading(panes.active()) && !shows_live_step(panes.at(panes.active()));
}

}  // namespace gs::app
