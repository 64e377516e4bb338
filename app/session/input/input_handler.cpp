#include "app/session/input/input_handler.h"

#include "app/session/navigation/key_input.h"
#include "app/session/navigation/script_effects.h"

#include <optional>
#include <vector>

namespace gs::app {

void InputHandler::handle(const SessionInput::Event& input) {
  using Kind = WindowEvent::Kind;
  const WindowEvent& event = input.event;
  if (event.kind == Kind::key_down || event.kind == Kind::button_down) to_.links.note_press();
  const bool for_interface = input.over_interface && (event.kind == Kind::button_down || event.kind == Kind::pointer);
  if (View* const seen = for_interface ? nullptr : to_.viewports.view()) {
    if (send_to_key_sensors(*seen, event, step_.now)) return;
    if (send_to_scripts(*seen, to_.viewports.place_of(to_.viewports.panes().active()), event, step_.now)) return;
  }
  switch (event.kind) {
    case Kind::key_down:
      return handle_key(event);
    case Kind::axes:
      return handle_axes(event);
    case Kind::key_up:
    case Kind::focus_lost:
      return release(event);
    case Kind::button_down:
    case Kind::button_up:
    case Kind::pointer:
    case Kind::wheel:
    case Kind::drop:
      return handle_pointer(input);
    case Kind::pointer_left:
    case Kind::character:
    case Kind::refresh:
      return;
  }
}

void InputHandler::handle_key(const WindowEvent& event) {
  // In simulated time, run only actions of the world; others, such as opening files or reloading, have no effect.
  if (const ActionRow* row = action_of(event); row && (row->of_world || !step_.simulated) && run(row->action)) return;
  Pane& pane = to_.viewports.panes().at(to_.viewports.panes().active());
  if (const View* seen = pane.view()) (void)pane.input.take(event, seen->navigation.mode);
}

// Handles axes of a gamepad or 3D mouse. They act like held keys. First stops their motion in all viewports, because
// another viewport may have become active.
void InputHandler::handle_axes(const WindowEvent& event) {
  WindowEvent rest = event;
  rest.move = glm::vec3(0);
  rest.turn = glm::vec2(0);
  for (Pane& pane : to_.viewports.panes().all()) (void)pane.input.take(rest, NavigationMode::none);
  Pane& pane = to_.viewports.panes().at(to_.viewports.panes().active());
  if (const View* seen = pane.view()) (void)pane.input.take(event, seen->navigation.mode);
}

// Handles the release of a key, or of everything when the window loses focus, in all viewports.
void InputHandler::release(const WindowEvent& event) {
  for (Pane& pane : to_.viewports.panes().all()) (void)pane.input.take(event, NavigationMode::none);
  if (event.kind != WindowEvent::Kind::focus_lost) return;
  to_.viewports.release_pointer();
  to_.pointing.leave();
}

void InputHandler::handle_pointer(const SessionInput::Event& input) {
  using Kind = WindowEvent::Kind;
  const WindowEvent& event = input.event;
  if ((event.kind == Kind::button_down || event.kind == Kind::wheel) && input.over_interface) return;
  if (event.kind == Kind::pointer && input.over_interface && !to_.pointing.sensor_has_pointer()) to_.pointing.leave();
  const std::optional<std::size_t> place = to_.viewports.route(event);
  const std::vector<std::size_t> sight = to_.viewports.panes().visible();
  if (place && *place < sight.size()) {
    const std::size_t target = sight[*place];
    if (event.kind == Kind::button_down || event.kind == Kind::drop) to_.viewports.activate(target);
    Pane& pane = to_.viewports.panes().at(target);
    if ((!input.over_interface || to_.pointing.sensor_has_pointer()) && !to_.camera.seeking())
      if (to_.pointing.take(event, target)) return;
    if (const View* seen = pane.view()) to_.camera.point_at(target, pane.input.take(event, seen->navigation.mode));
  }
  if (event.kind == Kind::drop) to_.opening.open_files(event.paths);
}

bool InputHandler::run(Action action) {
  Panes& panes = to_.viewports.panes();
  switch (action) {
    case Action::next_file:
    case Action::previous_file:
      return select_next_file(action);
    case Action::reload:
      panes.reload();
      return true;
    case Action::close:
      return to_.camera.stop_seeking() || to_.viewports.loading().cancel(panes.active());
    case Action::back:
    case Action::forward:
      to_.travel.go(action == Action::back ? -1 : 1);
      return true;
    default: {
      if (to_.sound.run(action) || viewport_commands_.run(action)) return true;
      View* seen = to_.viewports.view();
      return seen && to_.camera.run(*seen, action);
    }
  }
}

void InputHandler::serve(const PaneRequest& request) {
  if (request.kind == PaneRequest::Kind::open_again)
    to_.opening.open_again(request.pane);
  else
    viewport_commands_.serve(request);
}

bool InputHandler::select_next_file(Action action) {
  const Panes& panes = to_.viewports.panes();
  const std::size_t count = panes.documents().entries().size();
  if (count == 0) return false;
  const std::size_t step = action == Action::next_file ? 1 : count - 1;
  to_.opening.select_file((panes.selected().value_or(0) + step) % count);
  return true;
}

}  // namespace gs::app
