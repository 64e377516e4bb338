#include "app/session/opening/first_views.h"

#include <utility>

namespace gs::app {

FirstViews::FirstViews(StepContext& step, SessionViewports& viewports, CameraControl& camera, Opening& opening,
                       LinkFollower& links, Picker& picker, FirstViewOptions options)
    : step_(step),
      viewports_(viewports),
      camera_(camera),
      opening_(opening),
      links_(links),
      picker_(picker),
      options_(std::move(options)) {}

void FirstViews::show() {
  Panes& panes = viewports_.panes();
  for (const PaneLoading::Change& change : viewports_.loading().settle(viewports_.places(), options_.viewpoint)) {
    step_.frame.news = true;
    if (!change.first) continue;
    const Pane& pane = panes.at(change.pane);
    View& seen = *panes.at(change.pane).view();
    if (change.found && !options_.viewpoint.empty()) opening_.enter_by_default_at(pane.shown, options_.viewpoint);
    if (!change.found) step_.notify("No Viewpoint \"" + options_.viewpoint + "\" in this world", true);
    set_up(seen, pane);
    if (change.pane == panes.active() && seen.document->world.diagnostics.errors() > 0) step_.frame.show_log = true;
    if (viewports_.linked() && change.pane != panes.active()) panes.link(panes.active());
    if (!step_.simulated) picker_.items().prepare(*seen.list);
  }
  if (viewports_.loading().settle_over()) step_.frame.news = step_.frame.changed = true;
  for (const std::size_t i : panes.visible()) links_.enter(panes.at(i));
}

// Applies the options of the session, and the budget of a link, to a new view.
void FirstViews::set_up(View& seen, const Pane& pane) {
  seen.navigation.speed *= static_cast<float>(camera_.speed());
  if (const auto camera = std::exchange(options_.camera, std::nullopt);
      camera && seen.navigation.mode != NavigationMode::none) {
    choose_parallel(seen, seen.style.parallel || camera->height > 0);
    stand_at(seen, *camera, false);
  }
  if (options_.headlight) seen.headlight = *options_.headlight;
  if (const std::size_t budget = opening_.budget_of(pane.shown); budget > 0) seen.budget = budget;
}

}  // namespace gs::app
