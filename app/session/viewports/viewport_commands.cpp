#include "app/session/viewports/viewport_commands.h"

#include <algorithm>
#include <string>

namespace gs::app {

void ViewportCommands::serve(const PaneRequest& request) {
  using Kind = PaneRequest::Kind;
  if (request.pane >= kMaxViewports || !has_pane(viewports_.panes().split(), request.pane)) return;
  Pane& pane = viewports_.panes().at(request.pane);
  step_.frame.changed = true;
  step_.frame.news = step_.frame.news || (request.kind != Kind::weigh && request.kind != Kind::limit);
  switch (request.kind) {
    case Kind::split_right:
    case Kind::split_below:
      return split_viewport(request.pane, request.kind == Kind::split_right ? SplitAxis::columns : SplitAxis::rows);
    case Kind::maximise:
      viewports_.activate(request.pane);
      return viewports_.change_split(with_maximised(viewports_.panes().split(), request.pane));
    case Kind::swap:
      return viewports_.change_split(with_swapped(viewports_.panes().split(), request.pane, request.other));
    case Kind::even_out:
      return viewports_.change_split(evened_out(viewports_.panes().split()));
    case Kind::close:
      return close_viewport(request.pane);
    case Kind::weigh:
      pane.weight = std::clamp(request.weight, Pane::kMinWeight, Pane::kMaxWeight);
      return;
    case Kind::limit:
      pane.rate = request.rate;
      return;
    case Kind::dismiss:
      pane.failure.reset();
      return;
    case Kind::open_again:
      return;
  }
}

void ViewportCommands::split_viewport(std::size_t pane, SplitAxis axis) {
  viewports_.panes().set_shape(resolved(viewports_.panes().split(), viewports_.area()));
  if (!viewports_.panes().split_pane(pane, axis))
    return step_.notify("The window can have at most " + std::to_string(kMaxViewports) + " viewports", false);
  viewports_.forget(viewports_.panes().active());
  viewports_.change_split(viewports_.panes().split());
}

void ViewportCommands::close_viewport(std::size_t pane) {
  viewports_.announce_change();
  const bool only = viewports_.panes().visible().size() < 2;
  if (!viewports_.panes().close(pane)) return;
  viewports_.forget(pane);
  if (only) return;  // a new arrangement would fill the viewport again
  viewports_.change_split(viewports_.panes().split());
}

bool ViewportCommands::run(Action action) {
  using Kind = PaneRequest::Kind;
  const std::size_t active = viewports_.panes().active();
  const SplitTree& split = viewports_.panes().split();
  const auto ask = [&](Kind kind, std::size_t other = 0) {
    serve(PaneRequest{kind, active, other, 1});
    return true;
  };
  switch (action) {
    case Action::next_layout:
      viewports_.choose_layout(next_layout(layout_of(split).value_or(ViewportLayout::four)));
      return true;
    case Action::viewport_1:
    case Action::viewport_2:
    case Action::viewport_3:
    case Action::viewport_4:
      viewports_.activate(static_cast<std::size_t>(action) - static_cast<std::size_t>(Action::viewport_1));
      return true;
    case Action::next_pane:
    case Action::previous_pane:
      viewports_.activate(next_pane(split, active, action == Action::next_pane ? 1 : -1));
      return true;
    case Action::split_right:
      return !step_.simulated && ask(Kind::split_right);
    case Action::split_below:
      return !step_.simulated && ask(Kind::split_below);
    case Action::maximise:
      return ask(Kind::maximise);
    case Action::swap_viewports:
      return ask(Kind::swap, next_pane(split, active, 1));
    case Action::even_out:
      return ask(Kind::even_out);
    case Action::close_viewport:
      return ask(Kind::close);
    case Action::link:
      toggle_link();
      return true;
    default:
      return false;
  }
}

void ViewportCommands::toggle_link() {
  viewports_.set_linked(!viewports_.linked());
  step_.notify(viewports_.linked() ? "Viewports linked" : "Viewports not linked", false);
}

}  // namespace gs::app
