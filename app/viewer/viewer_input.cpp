#include "app/viewer/viewer_window.h"

namespace gs::app {
namespace {

bool is_arrow(Key key) { return key == Key::left || key == Key::right || key == Key::up || key == Key::down; }

}  // namespace

std::vector<SessionInput::Event> Viewer::take(const std::vector<WindowEvent>& events) {
  std::vector<SessionInput::Event> result;
  for (const WindowEvent& event : events) {
    if (event.kind == WindowEvent::Kind::key_down) {
      const ActionRow* row = action_of(event);
      const bool typed = ui_.wants_keys();
      if (row && !(row->of_world && typed) && run(row->action)) continue;
      if (typed && !(row && !row->of_world)) continue;
      if (inspection_.takes_arrows() && is_arrow(event.key)) continue;
    }
    if (picks(event)) continue;
    result.push_back({event, ui_.wants_pointer()});
  }
  return result;
}

// True when it was a click that chooses a node of the world (Alt+click, or behind Action::pick).
bool Viewer::picks(const WindowEvent& event) {
  if (event.kind != WindowEvent::Kind::button_down || event.button != MouseButton::left || ui_.wants_pointer() ||
      !(event.alt || inspection_.picking()))
    return false;
  if (inspection_.pick(session_, event.pointer))
    ui_.show_panel(Action::scene_tree);
  else
    ui_.show_notice("There is nothing to choose", false);
  return true;
}

// True where it is the interface's, or the window's, alone.
bool Viewer::run(Action action) {
  switch (action) {
    case Action::full_screen:
      window_->toggle_full_screen();
      return true;
    case Action::pick:
      inspection_.set_picking(!inspection_.picking());
      if (inspection_.picking()) ui_.show_notice("Click what is to be chosen in the scene tree", false);
      return true;
    case Action::close:
      if (!inspection_.picking()) return ui_.run(action);
      inspection_.set_picking(false);
      return true;
    case Action::quit:
      window_->close();
      return true;
    default:
      return ui_.run(action);
  }
}

void Viewer::apply(const UiActions& actions) {
  if (actions.open) {
    opening_ = given_place(*actions.open).target;
    session_.open_files({*actions.open});
  }
  if (actions.file) session_.select_file(*actions.file);
  if (actions.layout) session_.choose_layout(*actions.layout);
  if (actions.run && !run(*actions.run)) (void)session_.run(*actions.run);
  if (actions.allow_folder) session_.answer_question(*actions.allow_folder);
  if (actions.cancel_loading) session_.cancel_loading(*actions.cancel_loading);
  View* seen = session_.view();
  if (!seen) return;
  if (actions.viewpoint) {
    const std::vector<std::size_t> listed = listed_viewpoints(seen->list->viewpoints);
    if (*actions.viewpoint < listed.size()) session_.bind_viewpoint(listed[*actions.viewpoint]);
  }
  if (actions.mode) session_.choose_mode(*actions.mode);
  if (actions.look) seen->look = *actions.look;
}

}  // namespace gs::app
